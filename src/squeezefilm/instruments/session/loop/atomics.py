"""Loads and stores of a whole number that order the memory accesses around them.

A number written with `store_release` and seen by `load_acquire`, in any process that maps the same
memory, makes everything visible that the writer wrote before it. Compiled, they are LLVM's atomic
load and store with these orderings: plain instructions on x86-64, `ldar` and `stlr` on ARM64, and
neither compiler nor processor moves rows across them. Interpreted (with NUMBA_DISABLE_JIT, for
debugging) they are plain accesses, which are ordered so on x86-64 only.
"""

from __future__ import annotations

from typing import Any

import numba
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

_INT64_BYTES = 8
_item_pointer: Any = cgutils.get_item_pointer


def _place(context: Any, builder: Any, kind: Any, array: Any, index: Any, index_type: Any) -> Any:
    """The address of one item of an array of 64-bit whole numbers."""
    view = context.make_array(kind)(context, builder, array)
    whole = context.cast(builder, index, index_type, types.intp)
    return _item_pointer(context, builder, kind, view, [whole])


@intrinsic
def _load_acquire(typing_context: Any, array: Any, index: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind, index_type = signature.args
        place = _place(context, builder, kind, values[0], values[1], index_type)
        return builder.load_atomic(place, "acquire", _INT64_BYTES)

    return types.int64(array, index), codegen


@intrinsic
def _store_release(typing_context: Any, array: Any, index: Any, value: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind, index_type, _ = signature.args
        place = _place(context, builder, kind, values[0], values[1], index_type)
        builder.store_atomic(values[2], place, "release", _INT64_BYTES)
        return context.get_dummy_value()

    return types.void(array, index, types.int64), codegen


if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]

    def load_acquire(array: si.Array, index: int) -> int:
        """`array[index]`, interpreted."""
        return int(array[index])

    def store_release(array: si.Array, index: int, value: int) -> None:
        """`array[index] = value`, interpreted."""
        array[index] = value

else:

    @compiled()
    def load_acquire(array: si.Array, index: int) -> int:
        """`array[index]` of an int64 array; no later access is done before it."""
        return _load_acquire(array, index)  # type: ignore[call-arg]

    @compiled()
    def store_release(array: si.Array, index: int, value: int) -> None:
        """`array[index] = value` in an int64 array; no earlier access is done after it."""
        _store_release(array, index, value)  # type: ignore[call-arg]
