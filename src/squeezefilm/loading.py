"""Many modules loaded at once, without looking for garbage in between.

Loading makes hundreds of thousands of objects that stay. Python's collector of garbage goes through
all of them again each time that there are a quarter more, which is a tenth of the time that an
analysis takes to load, and nearly a third of that of matplotlib; later it would go through them
whenever it looks for what a solve has left.
"""

from __future__ import annotations

import atexit
import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def loading() -> Iterator[None]:
    """Within, nothing is collected; what is there afterwards is taken to stay. For programs of
    their own only: a library has no say in this."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        # When the program ends, a third of a second of garbage would be looked for a last time.
        atexit.register(gc.freeze)
        if was_on:
            gc.enable()
