"""Says, once and on the log, that a numba function is about to be compiled for this processor."""

from __future__ import annotations

import logging
from functools import lru_cache
from pathlib import Path
from typing import Any

_log = logging.getLogger(__name__)


@lru_cache(maxsize=16)
def announce(dispatcher: Any, what: str, seconds: int) -> None:
    """Log at INFO that a numba function will be compiled, if no cache of it exists."""
    cache = Path(dispatcher.stats.cache_path or "")
    function = dispatcher.py_func
    name = f"{Path(function.__code__.co_filename).stem}.{function.__name__}-*.nbi"
    if not any(cache.glob(name)):
        _log.info("compiling the %s for this processor: some %d s, once", what, seconds)
