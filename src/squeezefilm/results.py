"""Results to JSON and back to disk: keys carry units, files are written whole or not at all."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import json
import math
import os
import tempfile
import typing
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm import __version__
from squeezefilm.errors import InputError
from squeezefilm.quantities import unit_of


def to_json(value: Any) -> Any:
    """A result (any frozen dataclass, nested) as plain JSON values.

    A field annotated with a unit gets it in its key: ``frequency: Hertz`` becomes
    ``frequency_Hz``. Arrays become lists, complex numbers [real, imaginary] pairs, NaN and
    infinities None, since JSON has none.
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        hints = typing.get_type_hints(type(value), include_extras=True)
        out: dict[str, Any] = {}
        for field in dataclasses.fields(value):
            unit = unit_of(hints[field.name])
            key = field.name + (unit.suffix if unit is not None else "")
            out[key] = to_json(getattr(value, field.name))
        return out
    if isinstance(value, typing.Mapping):
        return {str(key): to_json(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return to_json(value.tolist())
    if isinstance(value, list | tuple):
        return [to_json(item) for item in value]
    if isinstance(value, complex | np.complexfloating):
        return [to_json(float(value.real)), to_json(float(value.imag))]
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"{type(value).__name__} has no JSON form")


def config_hash(config: Any) -> str:
    """The SHA-256 of a configuration's values: the same for the same physics, whatever the file
    looked like."""
    text = json.dumps(to_json(config), sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def stamp(config: Any, seed: int | None = None) -> dict[str, Any]:
    """What a saved result says of its origin: version, config hash, seed and UTC time."""
    return {
        "squeezefilm_version": __version__,
        "config_sha256": config_hash(config),
        "seed": seed,
        "created_utc": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file so that a reader sees the old one or the new one, never half of it.

    Raises `InputError` where the folder cannot be written to.
    """
    data = content.encode() if isinstance(content, str) else content
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise InputError(
            f"cannot write to {path.parent}: {error.strerror}; choose another folder"
        ) from error
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        # mkstemp makes files private; a report is meant to be read like any other file.
        os.chmod(temporary, 0o666 & ~_umask())  # noqa: PTH101
        os.replace(temporary, path)  # noqa: PTH105
    except OSError as error:
        with contextlib.suppress(OSError):
            Path(temporary).unlink(missing_ok=True)
        raise InputError(
            f"cannot write {path}: {error.strerror}; nothing was left behind"
        ) from error
    try:
        sync_folder(path.parent)
    except OSError as error:
        raise InputError(
            f"{path} is written, but the disk did not confirm it: {error.strerror}; write it again"
        ) from error


def sync_folder(folder: Path) -> None:
    """Force a folder's names onto the disk: only then does a new file survive a power cut.

    Raises `OSError`. Windows syncs them by itself, and opens no folder.
    """
    if os.name == "nt":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
