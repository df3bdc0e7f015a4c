"""Reads number, title and correction of an equation from the docstring of the function that transcribes it."""

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

_HEAD = re.compile(r"(?P<numbers>\(\d+\)(?:, \(\d+\))*) (?P<title>.+)")
_CORRECTION = re.compile(r"Corrected(?: (?P<number>\(\d+\)))?: (?P<text>.+)\.")


@dataclass(frozen=True)
class Equation:
    """One numbered equation: `function` evaluates its right-hand side; `correction` says where the print slips."""

    number: str
    title: str
    function: Callable[..., Any]
    correction: str | None


def equations_of(*modules: ModuleType) -> dict[str, Equation]:
    """Every equation transcribed in the modules, in the paper's order."""
    found = [equation for module in modules for equation in _in_module(module)]
    return {equation.number: equation for equation in sorted(found, key=lambda e: int(e.number.strip("()")))}


def _in_module(module: ModuleType) -> list[Equation]:
    functions = [f for _, f in inspect.getmembers(module, inspect.isfunction) if f.__module__ == module.__name__]
    return [equation for function in functions for equation in _of_function(function)]


def _of_function(function: Callable[..., Any]) -> list[Equation]:
    paragraphs = [" ".join(p.split()) for p in (inspect.getdoc(function) or "").split("\n\n")]
    head = _HEAD.fullmatch(paragraphs[0])
    if head is None:
        return []
    title, numbers = head["title"].rstrip("."), head["numbers"].split(", ")
    return [Equation(number, title, function, _correction_of(number, paragraphs)) for number in numbers]


def _correction_of(number: str, paragraphs: list[str]) -> str | None:
    """The corrected reading: the paragraphs that give one for this number or for all of the function's."""
    corrections = filter(None, map(_CORRECTION.fullmatch, paragraphs))
    return ". ".join(m["text"] for m in corrections if m["number"] in (None, number)) or None
