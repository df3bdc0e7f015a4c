"""Planting a mistake: a piece of one function's text replaced, for everyone who calls it."""

import inspect
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import test_every_joint_kind
import test_step
import test_whole_drives
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import robot_library

FEW = settings(max_examples=10, deadline=None, derandomize=True, database=None, phases=(Phase.generate,))
"""How a law that draws its inputs is tried: until it fails, without looking for the simplest failure."""


@contextmanager
def mutated(function: Any, old: str, new: str) -> Iterator[None]:
    """The function with `new` in place of `old`, which must stand in it exactly once."""
    text = textwrap.dedent(inspect.getsource(function))
    text = text[text.index("def ") :]  # without decorators
    assert text.count(old) == 1, f"{function.__qualname__} has {text.count(old)} times {old!r}; the mutant needs one"
    namespace = dict(function.__globals__)
    exec(text.replace(old, new), namespace)
    original, function.__code__ = function.__code__, namespace[function.__name__].__code__
    try:
        yield
    finally:
        function.__code__ = original


def holds(law: Callable[..., None], arguments: dict[str, Any]) -> bool:
    """Whether a law holds, on robots built and compiled anew."""
    robots = [robot_library.robot, test_every_joint_kind.twin_of]
    robots += [test_whole_drives.bare, test_whole_drives.whole, test_whole_drives.table]
    robots += [test_step.arm, test_step.swing]
    if hasattr(law, "hypothesis"):
        law = FEW(given(data=st.data())(law.hypothesis.inner_test))
    for cached in robots:
        cached.cache_clear()
    try:
        law(**arguments)
    except AssertionError:
        return False
    finally:
        for cached in robots:
            cached.cache_clear()
    return True
