"""What several files of tests read and nobody changes, computed once for all processes and runs."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from squeezefilm.core.kept.computed_by import computed_by

T = TypeVar("T")


def shared(name: str, make: Callable[[], T]) -> T:
    """What `make` returns, kept under this name beside solved plates for as long as the package's
    source is the same; computed anew where nothing is kept."""
    folder = os.environ.get("SQUEEZEFILM_CACHE", "off")
    if folder == "off":
        return make()
    file = Path(folder) / "of-tests" / f"{name}.pickle"
    try:
        source, found = pickle.loads(file.read_bytes())
        if source == computed_by():
            return found  # type: ignore[no-any-return]
    except (OSError, EOFError, pickle.UnpicklingError, AttributeError, ImportError, TypeError):
        pass  # Not there, or of a source whose classes were others.
    found = make()
    file.parent.mkdir(parents=True, exist_ok=True)
    written = file.with_suffix(f".{os.getpid()}")
    written.write_bytes(pickle.dumps((computed_by(), found)))
    written.replace(file)
    return found
