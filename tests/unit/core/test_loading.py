"""What is loaded at once stays, and the collector goes on as it was."""

from __future__ import annotations

import gc
import subprocess
import sys

import pytest

_WITHIN = """
import gc
from squeezefilm.core.loading import loading

before = gc.get_freeze_count()
with loading():
    assert not gc.isenabled()
    made = [[] for _ in range(1000)]
assert gc.isenabled()
assert gc.get_freeze_count() >= before + len(made)

gc.disable()
try:
    with loading():
        raise ImportError
except ImportError:
    assert not gc.isenabled(), "whoever had turned it off wants it off"
"""


@pytest.mark.slow
def test_nothing_is_collected_within() -> None:
    """In a process of its own, whose objects may be frozen."""
    assert gc.isenabled()
    subprocess.run([sys.executable, "-c", _WITHIN], check=True)
