"""docs/equations.md is correct about where the paper's equations are."""

import pytest

from equations_document import DOCUMENT, LAST, PACKAGE, citations, cited_numbers, document
from paper import DEFINITIONS


@pytest.mark.parametrize(
    ("docstring", "numbers"),
    [
        ("Required velocity.  Xia (2019) eq. (49).", {49}),
        ("Xia (2019) eqs. (29)-(31), (44)-(47)", {29, 30, 31, 44, 45, 46, 47}),
        ("Of the drive.  Xia (2019)\n    eqs. (2), (3) and\n    (54).", {2, 3, 54}),
        ("Xia (2019) eq. (2); Spong (1987) eq. (7)", {2}),
        ("Xia (2019) section IV.A", set()),
        ("Luh (1980) eq. (5)", set()),
    ],
)
def test_citations_are_read_with_their_ranges(docstring, numbers):
    assert cited_numbers(docstring).keys() == numbers


def test_citations_name_file_and_function(tmp_path):
    (tmp_path / "room").mkdir()
    source = 'class Law:\n    def torque(self):\n        """Xia (2019) eq. (2)."""\n'
    (tmp_path / "room" / "law.py").write_text(source)
    assert citations(tmp_path) == {2: ["room/law.py: Law.torque"]}
    source += 'def whole():\n    """Xia (2019) eqs. (1)-(3), (1)."""\n'
    (tmp_path / "room" / "law.py").write_text(source)
    here = ["room/law.py: whole"]
    assert citations(tmp_path) == {1: here, 2: ["room/law.py: Law.torque"], 3: here}


def test_every_equation_is_cited_or_a_definition():
    excused = {int(number.strip("()")) for number in DEFINITIONS}
    missing = set(range(1, LAST + 1)) - citations(PACKAGE).keys() - excused
    assert not missing, f"no function cites Xia (2019) eqs. {sorted(missing)}"


def test_the_package_cites_only_equations_that_exist():
    assert citations(PACKAGE).keys() <= set(range(1, LAST + 1))


def test_the_document_is_up_to_date():
    assert DOCUMENT.read_text(encoding="utf-8") == document(), "run: python tests/equations_document.py"
