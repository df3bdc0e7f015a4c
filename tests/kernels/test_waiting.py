"""While code is made: a terminal says so, and Ctrl-C is heard."""

import _thread
import io
import signal
import sys
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

from cutpoint.kernels import Loop, Region, Stage, compile, compile_program
from cutpoint.kernels.arrays import packs
from cutpoint.kernels.machine import waiting
from cutpoint.kernels.machine.batch_loop import WORTH_MAKING_PACKS
from cutpoint.kernels.machine.waiting import interruptible, shown
from cutpoint.scalars import sin


@pytest.fixture(autouse=True)
def ctrl_c_is_listened_to() -> Iterator[None]:
    """A shell starts what runs in the background deaf to it, and tests may run there."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def terminal_of(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Standard error as a terminal, on which everything takes long; pytest puts back its own after any fixture."""
    found = Terminal()
    monkeypatch.setattr(sys, "stderr", found)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(waiting, "SHOWN_AFTER", 0.01)
    return found


def slow(x: float) -> float:
    time.sleep(0.3)
    return 2.0 * x


def test_a_long_compilation_is_named_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    kernel = compile(slow, name="[bold]law[/]", x=())
    assert "compiling [bold]law[/]" in terminal.getvalue()
    assert kernel(1.5) == 3.0


def test_a_stepping_loop_is_named_too(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    stage = Stage(lambda x: [slow(x[0])], ("x",), ("x",))
    compile_program(Loop(1, (stage,)), [Region("x", 1)])
    compile_program(Loop(1, (stage,)), [Region("x", 1)], name="[bold]loop[/]")
    assert "compiling a stepping program" in terminal.getvalue()
    assert "compiling [bold]loop[/]" in terminal.getvalue()


def test_a_quick_one_passes_without_a_word(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    monkeypatch.setattr(waiting, "SHOWN_AFTER", 60.0)
    compile(slow, x=())
    assert terminal.getvalue() == ""


@pytest.mark.parametrize(("pause", "told"), [(60.0, True), (0.0, False)])
def test_compilations_that_follow_one_another_are_one_wait(
    pause: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal = terminal_of(monkeypatch)
    monkeypatch.setattr(waiting, "SHOWN_AFTER", 0.7)
    monkeypatch.setattr(waiting, "PAUSE", pause)
    for k in range(4):
        with shown(f"law {k}"):
            time.sleep(0.2)
    assert ("compiling law 3" in terminal.getvalue()) == told


def test_the_terminal_is_left_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    with pytest.raises(ZeroDivisionError), shown("law"):
        time.sleep(0.2)
        raise ZeroDivisionError
    assert terminal.getvalue().endswith("\x1b[2K") and "\x1b[?25h" in terminal.getvalue()


def test_only_the_outermost_speaks(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    with shown("outer"), shown("inner"):
        time.sleep(0.2)
    assert "outer" in terminal.getvalue() and "inner" not in terminal.getvalue()


def test_what_is_no_terminal_stays_empty(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    file = io.StringIO()
    monkeypatch.setattr(sys, "stderr", file)
    compile(slow, x=())
    assert file.getvalue() == terminal.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", None)  # as in programs without a console
    assert compile(slow, x=())(2.0) == 4.0


def test_what_a_traced_function_prints_goes_where_it_belongs(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = terminal_of(monkeypatch)
    output = Terminal()
    monkeypatch.setattr(sys, "stdout", output)
    with shown("law"):
        time.sleep(0.2)
        print("seen")
    assert output.getvalue() == "seen\n" and "seen" not in terminal.getvalue()


def test_interrupts_are_heard_while_work_goes_on() -> None:
    release, ended = threading.Event(), threading.Event()

    def work() -> None:
        release.wait(60)
        ended.set()

    threading.Timer(0.1, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        interruptible(work)
    assert not ended.is_set()
    release.set()
    assert ended.wait(60)  # what was begun comes to its end


def test_an_interrupt_while_packs_are_made_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    kernel, x = compile(sin, x=(), backend="llvm"), np.linspace(-3, 3, 2 * WORTH_MAKING_PACKS)
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(packs, "Compiled", interrupted)
        kernel(x)
        for _ in range(6000):  # what interrupts this thread does not wake it
            time.sleep(0.01)
    assert kernel(x).tobytes() == np.array([kernel(one) for one in x]).tobytes()


def test_work_returns_and_raises_as_if_done_here() -> None:
    assert interruptible(lambda: "code") == "code"
    with pytest.raises(ValueError, match=r"^bad text$"):
        interruptible(lambda: (_ for _ in ()).throw(ValueError("bad text")))
