"""How many threads BLAS takes while several problems are solved, and afterwards."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from lacore.numerics.threads import one_thread_each

MANY = 2


def threads():
    """Of the library that NumPy brings; what others are loaded depends on the tests before."""
    own = [one for one in threadpool_info() if np.__name__ in one["filepath"]]
    return {one["num_threads"] for one in own}


@pytest.fixture
def many():
    with threadpool_limits(MANY, user_api="blas"):
        if threads() != {MANY}:
            pytest.skip("this BLAS has one thread")
        yield


@pytest.mark.parametrize("first", [0, 1])
def test_the_last_to_leave_gives_the_threads_back(many, first):
    """Of two solves at a time: the first to leave gave back two, and the other one for good."""
    both = [one_thread_each(), one_thread_each()]
    for one in both:
        one.__enter__()
        assert threads() == {1}
    both.pop(first).__exit__(None, None, None)
    assert threads() == {1}
    both.pop().__exit__(None, None, None)
    assert threads() == {MANY}
