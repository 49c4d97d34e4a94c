"""Functions compiled by numba, with a cache on disk that survives a change of the package.

numba keeps what it compiled beside the source and asks one file whether it changed. That is not
enough: a function in another file that was compiled in, or a constant from there, may have changed
too, and so may a record's fields, which compiled code knows by their places; and a record that
moved to another module makes the old cache unreadable, which numba takes for an error of the
program.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from functools import lru_cache
from hashlib import blake2b
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar, cast

from squeezefilm.core.private_folder import is_shared

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

    class Cache(FunctionCache):
        def __init__(self, function: Callable[..., Any]) -> None:
            super().__init__(function)  # type: ignore[no-untyped-call]
            said = [self._cache_file._source_stamp, *map(_told, _used(function))]
            self.stamp = self._cache_file._source_stamp = blake2b(repr(said).encode()).hexdigest()
            # What is there is run. Whoever can write beside the source can write the source.
            folder = Path(self.cache_path)
            if folder.parent != Path(function.__code__.co_filename).parent and any(
                is_shared(place, "NUMBA_CACHE_DIR") for place in (folder, folder.parent)
            ):
                self.disable()  # type: ignore[no-untyped-call]

        def _index_key(self, sig: Any, codegen: Any) -> Any:
            records = [_fields(argument) for argument in getattr(sig, "args", sig)]
            return *super()._index_key(sig, codegen), repr(records)  # type: ignore[no-untyped-call]

        def load_overload(self, sig: Any, target_context: Any) -> Any:
            try:
                return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
            except Exception as error:
                _log.info("compiled again, since its cache cannot be read: %s", error)
                self.flush()  # type: ignore[no-untyped-call]
                return None

    return Cache


def _used(function: Callable[..., Any]) -> Iterator[Any]:
    """The things that a function finds by name, also in modules that it names (``layout.STEP``)."""
    names = function.__code__.co_names
    for name in names:
        value = function.__globals__.get(name)
        if isinstance(value, ModuleType):
            yield from (vars(value).get(other) for other in names)
        else:
            yield value


def _told(one: Any) -> Any:
    """The part of a thing used that changes the machine code of who uses it; None of what does
    not."""
    from numba.core.dispatcher import Dispatcher
    from numba.core.extending import _Intrinsic

    if isinstance(one, Dispatcher):
        return one._cache.stamp  # type: ignore[attr-defined]
    if isinstance(one, _Intrinsic):
        file = Path(one._defn.__code__.co_filename).stat()
        return file.st_mtime, file.st_size
    if isinstance(one, type):
        return getattr(one, "_fields", None)
    return one if isinstance(one, bool | int | float | str | tuple) else None


def _fields(kind: Any) -> Any:
    """The names of a record's fields, of those in it too, by the numba type of an argument."""
    inner = kind.types if hasattr(kind, "types") else [getattr(kind, "dtype", None)]
    names = getattr(kind, "fields", None) if hasattr(kind, "instance_class") else None
    return names, [_fields(member) for member in inner if hasattr(member, "instance_class")]


@lru_cache(maxsize=16)
def announce(dispatcher: Any, what: str, seconds: int) -> None:
    """Log at INFO that a numba function will be compiled, if no cache of it exists."""
    cache = Path(dispatcher.stats.cache_path or "")
    function = dispatcher.py_func
    name = f"{Path(function.__code__.co_filename).stem}.{function.__name__}-*.nbi"
    if not any(cache.glob(name)):
        _log.info("compiling the %s for this processor: some %d s, once", what, seconds)
