"""Public calls under hostile arguments: one argument of a good call replaced at a time.

Run by itself it attacks the calls whose names begin with the first argument, seeded by the second,
and exits with their faults on standard output: in a process of its own, because a call may crash,
hang or take all memory.
"""

from __future__ import annotations

import faulthandler
import random
import resource
import sys
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from squeezefilm.core.errors import SqueezefilmError, SqueezefilmWarning

from .good_arguments import good_arguments, invoke
from .public_calls import NAMES_NOT_CALLED, PublicCall, public_calls

HOSTILE: dict[str, Any] = {
    "nan": float("nan"),
    "inf": float("inf"),
    "-inf": float("-inf"),
    "0": 0.0,
    "-1": -1.0,
    "1e300": 1e300,
    "-1e300": -1e300,
    "1e-300": 1e-300,
    "the least float": 5e-324,
    "a negative whole number": -1_000_000,
    "a whole number above every float": 10**400,
    "nothing": None,
    "text": "2 um",
    "complex": 1j,
    "an object": object(),
    "an empty array": np.array([]),
    "an array of objects": np.array([object(), None], dtype=object),
    "an array of texts": np.array(["1", "2"]),
    "an array of integers": np.array([1, 2, 3]),
    "an array with nan": np.array([0.5, np.nan, 0.5]),
    "1e308": 1e308,
    "1e-308": 1e-308,
    "another shape": np.full((2, 3, 4), 0.5),
    "no axis": np.array(0.5),
    "two axes": np.full((2, 3), 0.5),
    "another length": np.linspace(0.1, 0.9, 7),
    "one number in a row": np.array([0.5]),
    "rows of unequal length": [[1.0], [1.0, 2.0]],
}

# A call that is still running after this long hangs; on a busy machine the slowest takes seconds.
HANGS_AFTER_S = 300.0
MEMORY = 6 * 2**30


def _not_finite(value: Any) -> bool:
    """Whether numbers are among what a call gave, and one of them is not finite."""
    if isinstance(value, tuple | list):
        return any(_not_finite(part) for part in value)
    if isinstance(value, float | complex | np.ndarray | np.generic):
        array = np.asarray(value)
        return array.dtype.kind in "fc" and not bool(np.all(np.isfinite(array)))
    return False


def fault(call: PublicCall, arguments: dict[str, Any]) -> str | None:
    """What is wrong with how a call met its arguments; None for a typed error or finite numbers."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", SqueezefilmWarning)
            result = invoke(call, arguments)
    except SqueezefilmError:
        return None
    except Exception as error:  # every other one is what is looked for
        return f"{type(error).__name__}: {error}"
    return "a result that is not finite" if _not_finite(result) else None


def random_numbers(generator: random.Random) -> dict[str, float]:
    """Numbers of any size and sign, their names their text."""
    drawn = [
        generator.choice((-1, 1)) * 10 ** generator.uniform(-300, 300),
        10 ** generator.uniform(-12, 12),
    ]
    return {f"{value!r}": value for value in drawn}


def attacks(call: PublicCall, generator: random.Random) -> Iterator[tuple[str, str, Any]]:
    """The arguments of a call that are numbers, each with every hostile value and its name."""
    for argument in call.numbers:
        for name, value in (HOSTILE | random_numbers(generator)).items():
            yield argument, name, value


def main() -> int:
    prefix, seed = sys.argv[1], int(sys.argv[2])
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    count, faults = 0, []
    for name, call in public_calls().items():
        if name in NAMES_NOT_CALLED or not name.startswith(prefix):
            continue
        generator = random.Random(f"{seed} {name}")
        good = good_arguments(call)
        if text := fault(call, good):
            faults.append(f"{name} as it should be called: {text}")
        for argument, what, value in attacks(call, generator):
            # Progress is for the one who looks at a dead process.
            print(f"{name}({argument} = {what})", file=sys.stderr, flush=True)
            faulthandler.dump_traceback_later(HANGS_AFTER_S, exit=True)
            if text := fault(call, {**good, argument: value}):
                faults.append(f"{name}({argument} = {what}): {text}"[:400])
            faulthandler.cancel_dump_traceback_later()
            count += 1
    print(f"{count} calls, seed {seed}")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
