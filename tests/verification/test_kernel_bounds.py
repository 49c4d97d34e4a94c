"""Compiled kernels stay within their arrays: a sample of their tests with bounds checked.

numba leaves bounds unchecked, so an index past an end reads or writes what lies there. With
NUMBA_BOUNDSCHECK it raises instead. The kernels are compiled anew in a cache of their own, because
a cached kernel keeps the checks that it was compiled with.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]

# One file for each family of kernels that compiles within a minute or so.
SAMPLE = {
    "envelope and its inverse": "unit/physics/render/resonator/test_compensation.py",
    "programs of textures": "properties/test_interpreters.py",
    "sliding": "properties/test_sliding.py",
    "load sharing": "properties/test_load_sharing.py",
    "film in time": "verification/test_film_march.py",
}


@pytest.mark.nightly
@pytest.mark.parametrize("family", sorted(SAMPLE))
def test_kernels_stay_within_their_arrays(family: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [
            *(sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"),
            *("-m", "not nightly", str(TESTS / SAMPLE[family])),
        ],
        cwd=TESTS.parent,
        env={**os.environ, "NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
    assert " passed" in done.stdout
    assert any(tmp_path.rglob("*.nbi")), "nothing was compiled, so nothing was checked"
