"""One thread of each BLAS that NumPy and SciPy load, and as many afterwards as before."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import scipy.linalg
from threadpoolctl import threadpool_info, threadpool_limits

from squeezefilm.core.blas_threads import one_blas_thread


def _threads() -> dict[str, int]:
    pools = threadpool_info()
    return {p["filepath"]: p["num_threads"] for p in pools if p["user_api"] == "blas"}


def test_every_blas_is_held_to_one_thread_and_let_go() -> None:
    beside = {
        path.name
        for package in (np, scipy)
        for path in Path(str(package.__file__)).parent.parent.glob(f"{package.__name__}.libs/*")
        if "openblas" in path.name
    }
    with threadpool_limits(2, user_api="blas"):
        before = _threads()
        assert beside <= {Path(file).name for file in before}
        with one_blas_thread():
            assert _threads() == dict.fromkeys(before, 1)
        assert _threads() == before
