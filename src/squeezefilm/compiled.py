"""Functions compiled by numba, with a cache on disk that survives a change of the package.

numba keeps what it compiled beside the source and asks one file whether it changed. That is not
enough: a function in another file that was compiled in, or a constant from there, may have changed
too; and a record that moved to another module makes the old cache unreadable, which numba takes
for an error of the program.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from functools import lru_cache
from hashlib import blake2b
from pathlib import Path
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])

_log = logging.getLogger(__name__)


def compiled(**options: Any) -> Callable[[F], F]:
    """A decorator: compile without the interpreter's lock and keep what was compiled on disk.

    `options` are those of numba's ``njit``, like ``error_model="numpy"``.
    """

    from numba import njit

    def compile_function(function: F) -> F:
        dispatcher: Any = njit(nogil=True, cache=True, **options)(function)
        dispatcher._cache = _cache_type()(function)
        return cast(F, dispatcher)

    return compile_function


@lru_cache(maxsize=1)
def _cache_type() -> Any:
    """numba's cache of one function, also stamped with what it takes from other files.

    Made when something is compiled: whoever only says that it will be does not load numba.
    """
    from numba.core.caching import FunctionCache
    from numba.core.dispatcher import Dispatcher

    class Cache(FunctionCache):
        def __init__(self, function: Callable[..., Any]) -> None:
            super().__init__(function)  # type: ignore[no-untyped-call]
            used = [function.__globals__.get(name) for name in function.__code__.co_names]
            called: list[Any] = [one for one in used if isinstance(one, Dispatcher)]
            said = [self._cache_file._source_stamp, *(one._cache.stamp for one in called)]
            said += [one for one in used if isinstance(one, bool | int | float | str | tuple)]
            self.stamp = self._cache_file._source_stamp = blake2b(repr(said).encode()).hexdigest()

        def load_overload(self, sig: Any, target_context: Any) -> Any:
            try:
                return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
            except (ImportError, AttributeError) as error:
                _log.info("compiled again, since its cache is another version's: %s", error)
                self.flush()  # type: ignore[no-untyped-call]
                return None

    return Cache


@lru_cache(maxsize=16)
def announce(dispatcher: Any, what: str, seconds: int) -> None:
    """Log at INFO that a numba function will be compiled, if no cache of it exists."""
    cache = Path(dispatcher.stats.cache_path or "")
    function = dispatcher.py_func
    name = f"{Path(function.__code__.co_filename).stem}.{function.__name__}-*.nbi"
    if not any(cache.glob(name)):
        _log.info("compiling the %s for this processor: some %d s, once", what, seconds)
