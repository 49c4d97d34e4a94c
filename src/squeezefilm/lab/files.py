"""Names of files that a page may write or read: below the lab's folder, nothing else; secrets."""

from __future__ import annotations

import base64
import io
import os
import re
import zipfile
from pathlib import Path

from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import OWN_BYTES
from squeezefilm.core.regular_file import read_regular

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


def named(folder: Path, name: str, suffix: str) -> Path:
    """The path of a file of that name and suffix in a folder.

    Raises:
        InputError: a name with anything but letters, digits, '.', '-' and '_', or a link.
    """
    stem = name.removesuffix(suffix)
    if not _NAME.fullmatch(stem) or stem.endswith("."):
        raise InputError(
            f"'{name[:80]}' is no name for a file: letters, digits, '.', '-' and '_', not "
            "beginning with a dot or a dash"
        )
    file = folder / f"{stem}{suffix}"
    if file.is_symlink():
        raise InputError(f"{file.name} is a link, which the lab neither reads nor writes")
    return file


def existing(folder: Path, name: str, suffix: str) -> Path:
    """Path as by `named`, of a file that is there. Raises `InputError` if it is not."""
    file = named(folder, name, suffix)
    if not file.is_file():
        raise InputError(f"there is no file {file.name} in the lab's folder")
    return file


def fresh(folder: Path, name: str, suffix: str, *, replace: bool = False) -> Path:
    """Path as by `named`, of a file that is not there yet. Raises `InputError` if it is."""
    file = named(folder, name, suffix)
    if file.exists() and not replace:
        raise InputError(f"{file.name} exists; choose another name, or allow replacing it")
    return file


def zipped(folder: Path) -> str:
    """A zip of a folder's files in base64, without links and names that begin with a dot.

    Raises `ConfigError` for a file that cannot be read or has more than 64 MB.
    """
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(folder.rglob("*")):
            if path.is_file() and not path.is_symlink() and not path.name.startswith("."):
                data = read_regular(path, OWN_BYTES, "an export's file")
                archive.writestr(path.relative_to(folder).as_posix(), data)
    return base64.b64encode(out.getvalue()).decode()


def write_secret(file: Path, content: bytes) -> None:
    """Write a file that only its owner can read, whole or not at all. Raises `OSError`.

    What a killed lab left half written goes with it.
    """
    beside = file.with_suffix(".new")
    beside.unlink(missing_ok=True)
    handle = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    try:
        with os.fdopen(handle, "wb") as out:
            out.write(content)
        beside.replace(file)
    except OSError:
        beside.unlink(missing_ok=True)
        raise
