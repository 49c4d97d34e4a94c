"""The loop's clock: CLOCK_MONOTONIC, read and slept on without Python.

On 64-bit Linux a compiled loop calls `clock_gettime` and `clock_nanosleep` (to a point in time,
TIMER_ABSTIME) of the C library themselves, by name, so that numba can cache it. Elsewhere, and
where numba's compiler is off, `COMPILED_CLOCK` is False: the loop is then paced by Python
(`pacing.portable_loop`), whose lateness is that of `time.sleep`, which under load of the same
process means that it cannot keep 1 kHz. Both clocks are what `time.monotonic_ns` reads on Linux.
"""

from __future__ import annotations

import ctypes
import sys
from typing import Any

import numba
import numpy as np
from numba import types

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

_MONOTONIC, _THREAD_CPU_TIME, _ABSOLUTE = 1, 3, 1
_SECOND_NS = 1_000_000_000


def _has_symbols(*names: str) -> bool:
    # Where numba's compiler will look for them: among what this process has loaded.
    library = ctypes.CDLL(None)
    return all(hasattr(library, name) for name in names)


COMPILED_CLOCK: bool = (
    sys.platform == "linux"
    and sys.maxsize > 2**32
    and not numba.config.DISABLE_JIT  # type: ignore[attr-defined]
    and _has_symbols("clock_gettime", "clock_nanosleep", "getppid")
)
"""True where compiled code can read the clock and sleep here."""

_clock_gettime: Any = types.ExternalFunction("clock_gettime", types.intc(types.intc, types.uintp))
_clock_nanosleep: Any = types.ExternalFunction(
    "clock_nanosleep", types.intc(types.intc, types.intc, types.uintp, types.uintp)
)
_getppid: Any = types.ExternalFunction("getppid", types.intc())


def new_timespec() -> si.Array:
    """Room for one `struct timespec`, which the functions here work in: int64, shape (2,)."""
    return np.zeros(2, dtype=np.int64)


@compiled()
def monotonic_ns(timespec: si.Array) -> int:
    """CLOCK_MONOTONIC (ns). Needs `COMPILED_CLOCK`."""
    _clock_gettime(_MONOTONIC, timespec.ctypes.data)
    return int(timespec[0] * _SECOND_NS + timespec[1])


@compiled()
def thread_cpu_ns(timespec: si.Array) -> int:
    """Processor time of the calling thread (ns). Needs `COMPILED_CLOCK`."""
    _clock_gettime(_THREAD_CPU_TIME, timespec.ctypes.data)
    return int(timespec[0] * _SECOND_NS + timespec[1])


@compiled()
def sleep_until_ns(timespec: si.Array, when: int) -> None:
    """Sleep until CLOCK_MONOTONIC is `when` (ns); a signal ends it. Needs `COMPILED_CLOCK`."""
    timespec[0] = when // _SECOND_NS
    timespec[1] = when % _SECOND_NS
    _clock_nanosleep(_MONOTONIC, _ABSOLUTE, timespec.ctypes.data, 0)


@compiled()
def parent_id() -> int:
    """The process that started this one, or who took it over. Needs `COMPILED_CLOCK`."""
    return int(_getppid())
