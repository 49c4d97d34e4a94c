"""What the processor is told: the rings' order of accesses, on this one and on ARM64."""

from __future__ import annotations

import re
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np
import pytest

from squeezefilm.instruments.session.loop.shared import (
    COUNTERS_SIZE,
    load_acquire,
    ring_put,
    ring_take,
    store_release,
)


def test_words_come_back() -> None:
    words = np.arange(8)
    store_release(words, 3, 2**62 + 1)
    assert load_acquire(words, 3) == 2**62 + 1
    assert [load_acquire(words, k) for k in (0, 1, 2, 4)] == [0, 1, 2, 4]


@pytest.mark.slow
@pytest.mark.parametrize("move", [ring_put, ring_take])
def test_a_ring_acquires_and_releases_on_arm64_too(move: Any) -> None:
    # Compiled anew, since numba shows nothing of what it took from its cache.
    compiled = numba.njit(move.py_func)
    counters, rows = np.zeros(COUNTERS_SIZE, dtype=np.int64), np.zeros((8, 3))
    compiled(counters, rows, rows[0] if move is ring_put else rows[:1])
    code = compiled.inspect_llvm(compiled.signatures[0])
    assert re.search(r"load atomic i64, .* acquire", code)
    assert re.search(r"store atomic i64 .* release", code)
    # The rest names the processor it was made for; what counts arrays is no matter here.
    code = re.sub(r"target (triple|datalayout) = .*", "", code).replace(" immarg", "")
    code = code.replace("llvm.x86.atomic.sub.cc.i64", "count_down")
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple("aarch64-unknown-linux-gnu").create_target_machine(opt=2)
    assembly = target.emit_assembly(llvm.parse_assembly(code))
    assert re.search(r"\bldap?r\b", assembly)
    assert re.search(r"\bstlr\b", assembly)
