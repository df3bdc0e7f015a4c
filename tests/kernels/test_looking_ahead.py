"""A stage's computations on rows that nobody writes are done for several rows at once: no bit may change."""

import ctypes
import mmap
from typing import Any

import numpy as np
import pytest

from cutpoint.kernels import Loop, Program, Region, Stage, compile_program
from cutpoint.kernels import compile as compile_kernel
from cutpoint.scalars import cos, sin, tanh, where

ROW, MEMORY = 3, 2
PAGE = mmap.PAGESIZE


def planned(row: Any, constant: Any) -> Any:
    """Much of a row and a constant, with conditions on both."""
    x, y, z = row
    for _ in range(3):
        x, y, z = sin(x + constant[0]) * y, where(z < x, cos(z), y / (2 + x * x)), tanh(x - y) + z
    return [x, y, where(y < constant[1], z, -z)]


def step(state: Any, row: Any, constant: Any, own: Any) -> Any:
    x, y, z = planned(row, constant)
    turned = where(row[0] < constant[0], state[1], -state[1])  # a condition that is read beside the state
    return [0.5 * state[0] + x * own[0] + where(z < state[1], y, z), 0.3 * turned + z / own[0]]


def program(lanes: int = 1) -> Program:
    """lanes: of the state and of one constant; rows and the other constant are for all."""
    stage = Stage(step, ("state", "row", "constant", "own"), ("state",), lanes)
    keep = Stage(lambda state: state, ("state",), ("log",), lanes)
    wide = {"state": MEMORY, "own": 1, "log": MEMORY}
    regions = [Region(name, size * lanes, lanes) for name, size in wide.items()]
    loop = Loop("ticks", [stage, keep], streams=("row", "log"))
    return compile_program(loop, [*regions, Region("row", ROW), Region("constant", 2)])


def numbers(ticks: int, lanes: int = 1) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(ticks)
    state, own = rng.uniform(-1, 1, MEMORY * lanes), rng.uniform(0.5, 1, lanes)
    rows, constant = rng.uniform(-2, 2, (ticks, ROW)), np.array([0.3, 0.1])
    return {"state": state, "own": own, "row": rows, "constant": constant, "log": np.empty((ticks, MEMORY * lanes))}


def one_by_one(given: dict[str, np.ndarray], lanes: int) -> np.ndarray:
    kernel = compile_kernel(step, state=MEMORY, row=ROW, constant=2, own=1)
    states, log = given["state"].reshape(MEMORY, lanes).T, np.empty_like(given["log"])
    for k, row in enumerate(given["row"]):
        states = kernel(states, row, given["constant"], given["own"][:, None])
        log[k] = states.T.ravel()
    return log


@pytest.mark.parametrize("lanes", [1, 4, 8])
@pytest.mark.parametrize("ticks", [0, 1, 7, 8, 9, 33])
def test_rows_at_once_are_rows_one_by_one_to_the_last_bit(ticks: int, lanes: int) -> None:
    given = numbers(ticks, lanes)
    expected = one_by_one(given, lanes)
    assert program(lanes).run({"ticks": ticks}, **given) == ticks
    np.testing.assert_array_equal(given["log"], expected)


def test_a_run_in_pieces_is_the_whole_run() -> None:
    whole, pieces, ours = numbers(30), numbers(30), program()
    ours.run({"ticks": 30}, **whole)
    for first, last in ((0, 1), (1, 12), (12, 30)):
        ours.run({"ticks": last - first}, **pieces | {name: pieces[name][first:last] for name in ("row", "log")})
    np.testing.assert_array_equal(pieces["log"], whole["log"])


def test_rows_that_a_stage_writes_are_read_when_their_turn_comes() -> None:
    """Each row makes the next: a program that looked ahead would see those from before."""

    def follow(row: Any, state: Any, constant: Any) -> tuple[Any, Any]:
        made = planned([row[0] + state[0], row[1], row[2]], constant)
        return made, [made[0]]

    stage = Stage(follow, ("row", "state", "constant"), ("row", "state"))
    regions = [Region("row", ROW), Region("state", 1), Region("constant", 2)]
    given = {**numbers(20), "state": np.zeros(1)}
    rows, ours = given["row"].copy(), {name: given[name] for name in ("row", "state", "constant")}
    compile_program(Loop(20, [stage], streams=("row",)), regions).run({}, **ours)
    kernel, last = compile_kernel(planned, row=ROW, constant=2), 0.0
    for row, found in zip(rows, ours["row"], strict=True):
        expected = kernel([row[0] + last, row[1], row[2]], given["constant"])
        np.testing.assert_array_equal(found, expected)
        last = expected[0]


@pytest.mark.parametrize("ticks", [1, 9, 15])
def test_no_row_after_the_last_is_read(ticks: int) -> None:
    """The rows end where memory ends that may be read at all."""
    libc, size = ctypes.CDLL(None), -(-ticks * ROW * 8 // PAGE) * PAGE
    pages = mmap.mmap(-1, size + PAGE)
    start = ctypes.addressof(ctypes.c_char.from_buffer(pages))
    assert libc.mprotect(ctypes.c_void_p(start + size), PAGE, 0) == 0
    try:
        given = numbers(ticks)
        rows = np.frombuffer(pages, np.float64, ticks * ROW, size - ticks * ROW * 8).reshape(ticks, ROW)
        rows[:] = given["row"]
        expected = one_by_one(given, 1)
        program().run({"ticks": ticks}, **given | {"row": rows})
        np.testing.assert_array_equal(given["log"], expected)
    finally:
        libc.mprotect(ctypes.c_void_p(start + size), PAGE, mmap.PROT_READ | mmap.PROT_WRITE)
