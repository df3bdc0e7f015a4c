# Three commands, each with all the set-up it needs:
#
#   make demo   the paper's comparison and control simulation, as a report in paper/
#   make test   style, types and all tests
#   make bench  beside Pinocchio, MuJoCo, CasADi and, where it is installed, Orocos KDL, into docs/benchmarks.md
#
# They need make and Python 3.11 or newer with its modules venv and pip.  PYTHON=... chooses one.

VENV := .venv
BIN := $(VENV)/bin
PYTHONS := $(or $(PYTHON),python3 python3.13 python3.12 python3.11 python)
SUITS := import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable
# pip compiles what it installs, but not what is editable
COMPILE := $(BIN)/python -m compileall -q src

.PHONY: demo test bench

demo: $(VENV)/installed
	$(BIN)/cutpoint paper --output paper

test: $(VENV)/installed-for-tests
	$(BIN)/ruff check .
	$(BIN)/pyright --pythonpath $(BIN)/python
	$(BIN)/pytest --numprocesses auto

bench: $(VENV)/installed-for-bench
	$(BIN)/python benchmarks/run.py

# the environment is made once, and installed into again only when the list of dependencies changes
$(VENV)/made:
	@for python in $(PYTHONS); do \
	    if $$python -c "$(SUITS)" 2>/dev/null; then \
	        echo "making $(VENV) with $$($$python --version)"; \
	        $$python -m venv $(VENV) && touch $@; exit; \
	    fi; \
	done; \
	echo "cutpoint needs Python 3.11 or newer with its modules venv and pip; tried: $(PYTHONS)." >&2; \
	echo "Install one (on Debian or Ubuntu: apt install python3 python3-venv) or say: make PYTHON=/path/to/python" >&2; \
	exit 1

$(VENV)/installed: $(VENV)/made pyproject.toml
	@echo "installing cutpoint and what it needs into $(VENV)"
	@$(INSTALL) .
	@$(COMPILE)
	@touch $@

$(VENV)/installed-for-tests: $(VENV)/made pyproject.toml
	@echo "installing cutpoint and what its tests need into $(VENV)"
	@$(INSTALL) ".[test]"
	@$(COMPILE)
	@touch $(VENV)/installed $@

$(VENV)/installed-for-bench: $(VENV)/made pyproject.toml
	@echo "installing cutpoint and its peers into $(VENV)"
	@$(INSTALL) ".[bench]"
	@$(COMPILE)
	@touch $(VENV)/installed $@
