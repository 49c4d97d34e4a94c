"""Results to JSON and back to disk: keys carry units, files are written whole or not at all."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import hashlib
import html
import inspect
import json
import math
import os
import re
import secrets
import typing
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from squeezefilm import __version__
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

_BINARY = getattr(os, "O_BINARY", 0)  # Windows would turn line ends into its own


def to_json(value: Any) -> Any:
    """A result (any frozen dataclass, nested) as plain JSON values.

    A field annotated with a unit gets it in its key: ``frequency: Hertz`` becomes
    ``frequency_Hz``. Arrays become lists, complex numbers [real, imaginary] pairs, NaN and
    infinities None, since JSON has none.
    """
    kind = type(value)
    if kind is float:  # most of what there is
        return value if math.isfinite(value) else None
    if kind is str or value is None:
        return value
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        hints = si.hints_of(type(value))
        out: dict[str, Any] = {}
        for field in dataclasses.fields(value):
            unit = si.unit_of(hints[field.name])
            key = field.name + (unit.suffix if unit is not None else "")
            out[key] = to_json(getattr(value, field.name))
        return out
    if isinstance(value, typing.Mapping):
        return {str(key): to_json(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        plain = value.dtype.kind in "fiub" and bool(np.isfinite(value).all())
        return value.tolist() if plain else to_json(value.tolist())
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
    if isinstance(value, str):
        return value
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"{type(value).__name__} has no JSON form")


def values_of(owner: Any, names: str) -> dict[str, Any]:
    """Attributes (named between blanks) as plain JSON values, with keys as `to_json` makes them.

    ``mode.quality_factor`` is an attribute of another, ``quality_factor`` its key.
    """
    values: dict[str, Any] = {}
    for path in names.split():
        *owners, name = path.split(".")
        holder = functools.reduce(getattr, owners, owner)
        unit = _unit_of_attribute(type(holder), name)
        values[name + (unit.suffix if unit is not None else "")] = to_json(getattr(holder, name))
    return values


class Interval(NamedTuple):
    """Ends of an interval, in the unit of the value that it is of."""

    low: float
    high: float


class Result:
    """Common abilities of results: a short `repr`, a table for notebooks, and ways out of Python.

    `_shown` names, between blanks, what a person looks for first (dotted: inside of it), and
    `summary` is the result as plain JSON values.
    """

    __slots__ = ()
    _shown: ClassVar[str] = ""

    def summary(self) -> dict[str, Any]:
        """The numbers as plain JSON values, with units in the keys."""
        values: dict[str, Any] = to_json(self)
        return values

    def to_dict(self) -> dict[str, Any]:
        """Numbers as plain JSON values, with units in the keys."""
        values: dict[str, Any] = to_json(self.summary())
        return values

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame`, units in the names of its columns: the result's own table, or one
        row with the single numbers of `to_dict`.

        Raises `InputError` where pandas is not installed.
        """
        try:
            import pandas
        except ImportError as error:
            raise InputError(
                "a data frame needs pandas, which is not installed; install it, or take to_dict()"
            ) from error
        return pandas.DataFrame(self._table())

    def _table(self) -> Any:
        """Rows or columns, as a data frame is made of them."""
        single = (str, int, float, bool, type(None))
        return [{k: v for k, v in self.to_dict().items() if isinstance(v, single)}]

    def __repr__(self) -> str:
        told = ", ".join(f"{name}={text}" for name, text in self._told())
        return f"<{type(self).__name__} {told}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{html.escape(text)}</td></tr>"
            for name, text in self._told()
        )
        return f"<table><caption>{type(self).__name__}</caption>{rows}</table>"

    def _told(self) -> Iterator[tuple[str, str]]:
        for path in self._shown.split():
            *owners, name = path.split(".")
            owner: Any = self
            for part in owners:
                owner = getattr(owner, part, None)
            value = getattr(owner, name, None)
            if value is not None and not (isinstance(value, str | tuple) and not value):
                yield path, _in_words(value, _unit_of_attribute(type(owner), name))


def _unit_of_attribute(owner: type, name: str) -> si.Unit | None:
    """The unit in the annotation of a field, or of what a property returns."""
    member = inspect.getattr_static(owner, name, None)
    function = member.fget if isinstance(member, property) else getattr(member, "func", None)
    if function is not None:
        return si.unit_of(typing.get_type_hints(function, include_extras=True).get("return"))
    return si.unit_of(si.hints_of(owner).get(name))


def _in_words(value: Any, unit: si.Unit | None) -> str:
    if isinstance(value, list | tuple):
        texts = all(isinstance(item, str) for item in value)
        return ("; " if texts else " to ").join(_in_words(item, unit) for item in value)
    if isinstance(value, typing.Mapping):
        return ", ".join(f"{key} {_in_words(entry, unit)}" for key, entry in value.items())
    if isinstance(value, float | np.floating):
        return si.format_quantity(float(value), unit or si.Unit("1"))
    return str(value)


def config_hash(config: Any) -> str:
    """The SHA-256 of a configuration's values: the same for the same physics, whatever the file
    looked like."""
    text = json.dumps(to_json(config), sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def stamp(config: Any, seed: int | None = None) -> dict[str, Any]:
    """The origin that a saved result states: version, config hash, seed and UTC time."""
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
        temporary = path.parent / f".{path.name}.{secrets.token_hex(4)}"
        handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _BINARY, 0o666)
    except OSError as error:
        raise InputError(
            f"cannot write to {path.parent}: {error.strerror}; choose another folder"
        ) from error
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise InputError(
            f"cannot write {path}: {error.strerror}; nothing was left behind. Free space or choose "
            "another folder, and ask again"
        ) from error
    try:
        sync_folder(path.parent)
    except OSError as error:
        raise InputError(
            f"{path} is written, but the disk did not confirm it: {error.strerror}; write it again"
        ) from error


def write_named(file: Path, text: str, *, replace: bool = False) -> None:
    """Write TOML whose first `name` becomes that of the file.

    Raises `InputError` if the file exists and is not to be replaced.
    """
    if file.is_dir():
        raise InputError(f"{file} is a directory; give the name of a TOML file to write")
    if file.exists() and not replace:
        raise InputError(f"{file} exists; give another name, or force to replace it")
    name = re.sub(r"[^A-Za-z0-9._-]+", "-", file.stem) or "own"
    write_whole(file, re.sub(r'(?m)^name = ".*"$', f'name = "{name}"', text, count=1))


def write_new(path: Path, content: str | bytes) -> None:
    """Write a file that is not there yet, as `write_whole`.

    Raises `InputError` where something has its name, or as `write_whole`.
    """
    if os.path.lexists(path):
        raise InputError(f"{path} exists already; give another name or remove it")
    write_whole(path, content)


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
