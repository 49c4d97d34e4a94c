"""One thread of each OpenBLAS that comes with NumPy and SciPy, and as many afterwards as before."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import scipy

from squeezefilm.core.blas_threads import _controls, one_blas_thread


def test_every_openblas_is_held_to_one_thread_and_let_go() -> None:
    beside = [
        path
        for package in (np, scipy)
        for path in Path(str(package.__file__)).parent.parent.glob(f"{package.__name__}.libs/*")
        if "openblas" in path.name
    ]
    assert len(_controls()) >= len(beside)
    for _, put in _controls():
        put(2)
    before = [get() for get, _ in _controls()]
    with one_blas_thread():
        assert [get() for get, _ in _controls()] == [1] * len(before)
    assert [get() for get, _ in _controls()] == before
