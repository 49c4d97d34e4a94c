"""Limit of one BLAS thread while many small dense blocks are worked on.

OpenBLAS spreads even small products over all cores and lets them wait for each other; measured
here, the plate solver then runs up to a hundred times slower. NumPy and SciPy each bring their own
OpenBLAS; both offer a function to set the number of threads.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import scipy

_PREFIXES = ("scipy_openblas", "openblas")
_SUFFIXES = ("64_", "")


@functools.cache
def _controls() -> tuple[tuple[Callable[[], int], Callable[[int], None]], ...]:
    """(get, set) of every OpenBLAS that comes with NumPy and SciPy; empty for another BLAS."""
    controls = []
    for package in (np, scipy):
        root = Path(str(package.__file__)).parent
        folders = (root.parent / f"{root.name}.libs", root / ".dylibs")
        for library in (p for folder in folders if folder.is_dir() for p in folder.iterdir()):
            if "openblas" not in library.name:
                continue
            with contextlib.suppress(OSError):
                handle = ctypes.CDLL(str(library))
                for prefix in _PREFIXES:
                    for suffix in _SUFFIXES:
                        get = getattr(handle, f"{prefix}_get_num_threads{suffix}", None)
                        put = getattr(handle, f"{prefix}_set_num_threads{suffix}", None)
                        if get is not None and put is not None:
                            controls.append((get, put))
    return tuple(controls)


@contextlib.contextmanager
def one_blas_thread() -> Iterator[None]:
    """Run the body with one BLAS thread and restore the number afterwards; does nothing for a
    BLAS other than OpenBLAS."""
    controls = _controls()
    before = [get() for get, _ in controls]
    try:
        for _, put in controls:
            put(1)
        yield
    finally:
        for (_, put), number in zip(controls, before, strict=True):
            put(number)
