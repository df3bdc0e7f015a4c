"""Linear algebra of an identification goes by one thread, and what it went by before comes back."""

from collections.abc import Iterator

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from cutpoint.errors import InputError
from cutpoint.identification import identify
from cutpoint.identification.one_thread import by_one_thread


def blas_threads() -> set[int]:
    """Of all libraries that are loaded: some have one for good."""
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


@pytest.fixture(autouse=True)
def _two_threads() -> Iterator[None]:
    with threadpool_limits(2, "blas"):
        yield


def test_a_function_has_one_thread_and_its_caller_all() -> None:
    before = blas_threads()
    assert 2 in before and by_one_thread(blas_threads)() == {1}
    assert blas_threads() == before


def test_threads_come_back_after_an_error() -> None:
    before = blas_threads()
    with pytest.raises(InputError, match=r"^hold_out 2 must be"):
        identify("no.urdf", "no.csv", hold_out=2)
    assert blas_threads() == before
