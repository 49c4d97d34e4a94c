"""Limit of one BLAS thread while many small dense blocks are worked on.

A BLAS spreads even small products over all cores and lets them wait for each other; measured with
OpenBLAS, the plate solver then runs up to a hundred times slower.
"""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Iterator

# NumPy and SciPy bring a BLAS each; only those that are loaded are found.
import scipy.linalg  # noqa: F401
from threadpoolctl import ThreadpoolController


@functools.cache
def _controller() -> ThreadpoolController:
    return ThreadpoolController().select(user_api="blas")


@contextlib.contextmanager
def one_blas_thread() -> Iterator[None]:
    """Run the body with one thread of each BLAS, and restore their numbers afterwards."""
    with _controller().limit(limits=1):
        yield
