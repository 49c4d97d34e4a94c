"""The folder of what is kept: where it is, how large, and its deletion.

Each result is a file, in a folder of its kind, named by a hash of all that it comes from. The whole
folder may be deleted at any time. ``SQUEEZEFILM_CACHE=off`` keeps nothing; any other value is the
folder to keep it in.
"""

from __future__ import annotations

import os
import re
import sys
from contextlib import suppress
from pathlib import Path

from squeezefilm.core.private_folder import is_shared

CACHE_VARIABLE = "SQUEEZEFILM_CACHE"
DIGEST_BYTES = 16
_NAME = re.compile(rf"[0-9a-f]{{{2 * DIGEST_BYTES}}}")


def cache_folder() -> Path | None:
    """The folder of what is kept; None where nothing is."""
    said = os.environ.get(CACHE_VARIABLE, "")
    if said:
        return None if said == "off" else Path(said)
    try:
        home = Path.home()
    except RuntimeError:
        return None
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local") / "squeezefilm"
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "squeezefilm"
    return Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache") / "squeezefilm"


def folder_of(kind: str) -> Path | None:
    """The folder of a kind of result, which may not be there yet; None where nothing is kept, or
    somebody else could write there, which is said once (`is_shared`)."""
    folder = cache_folder()
    if folder is None:
        return None
    both = folder, folder / kind
    return None if any(is_shared(place, CACHE_VARIABLE) for place in both) else both[1]


def make_private(folder: Path) -> None:
    """Make a kind's folder, and what it lies in, for this user alone. Raises `OSError`."""
    folder.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    folder.mkdir(mode=0o700, exist_ok=True)


def kept_sizes() -> dict[str, tuple[int, int]]:
    """How many files are kept, and their bytes, by kind."""
    sizes: dict[str, tuple[int, int]] = {}
    for kind in _kinds():
        files = []
        for file in _ours(kind):
            # Another process may be tidying up.
            with suppress(OSError):
                files.append(file.stat().st_size)
        if files:
            sizes[kind.name] = len(files), sum(files)
    return sizes


def clear_kept() -> int:
    """Delete all that is kept; returns how many files. What is needed again is computed again."""
    count = 0
    for kind in _kinds():
        for file in _ours(kind):
            with suppress(OSError):
                file.unlink()
                count += 1
    return count


def tidy(folder: Path, most: int) -> None:
    """Delete the older half of the files of a kind where there are more than `most`; another
    process may be doing so too."""
    with os.scandir(folder) as entries:
        files = [entry for entry in entries if entry.is_file()]
    if len(files) <= most:
        return
    aged = []
    for entry in files:
        with suppress(OSError):
            aged.append((entry.stat().st_mtime, entry.path))
    for _, path in sorted(aged)[: len(aged) - most // 2]:
        with suppress(OSError):
            Path(path).unlink()


def _kinds() -> list[Path]:
    folder = cache_folder()
    if folder is None or not folder.is_dir():
        return []
    return sorted(kind for kind in folder.iterdir() if kind.is_dir())


def _ours(folder: Path) -> list[Path]:
    """Files that are named as only this program names them: a folder may have others in it."""
    return [file for file in folder.iterdir() if _NAME.fullmatch(file.name) and file.is_file()]
