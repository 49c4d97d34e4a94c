"""An actuator as a file describes it: a motor or a skin-stretch array, told apart by its table.

A kind is a dataclass with `name`, `title`, `provenance` and one field that is named as its table,
``[motor]`` or ``[skin_stretch]``. `KINDS` is the one list of them.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from squeezefilm.actuators.motor.description import MotorDescription
from squeezefilm.actuators.skin_stretch.array import SkinStretchDescription
from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.config.load import load_text
from squeezefilm.core.config.syntax import require_quick_toml
from squeezefilm.core.errors import ConfigError, SqueezefilmError
from squeezefilm.core.regular_file import read_toml_text

Described = MotorDescription | SkinStretchDescription
KINDS: dict[str, type[Described]] = {
    "motor": MotorDescription,
    "skin_stretch": SkinStretchDescription,
}
"""Kinds by the table that a file has: the dataclass that it is read into. What `analyze` says of
each is in `actuators.report.page`."""


def is_actuator(name_or_path: str | Path) -> bool:
    """True where a preset's name or a TOML file is that of an actuator: with the table of one of
    `KINDS`. False for what cannot be read, which whoever reads it next says."""
    text, path = str(name_or_path), Path(name_or_path)
    if path.suffix != ".toml":
        return text in presets.names("actuator")
    try:
        said = read_toml_text(path)
    except SqueezefilmError:
        return False
    return re.search(rf"^\s*\[+\s*({'|'.join(KINDS)})\b", said, re.MULTILINE) is not None


def load_actuator(name_or_path: str | Path) -> Described:
    """The actuator of a preset's name or of a TOML file: the dataclass of its kind.

    Raises `ConfigError`, with file, line and key, for a file that cannot be read, one that has the
    table of no kind, or of more than one.
    """
    path = presets.resolve(name_or_path, "actuator")
    text = read_toml_text(path)
    return load_text(actuator_class(text, path), text, file=path)


def actuator_class(text: str, file: str | Path | None = None) -> type[Described]:
    """The dataclass that the TOML text of an actuator is read into, by the table that it has.

    What is no TOML is left to the loader, which says where it is wrong: taken as the first kind.
    Raises `ConfigError` where it has none, or more than one.
    """
    require_quick_toml(text, file)
    try:
        tree: dict[str, Any] = tomllib.loads(text)
    except (ValueError, RecursionError):
        return next(iter(KINDS.values()))
    kinds = [kind for kind in KINDS if kind in tree]
    tables = " or ".join(f"[{kind}]" for kind in KINDS)
    if len(kinds) > 1:
        raise ConfigError(
            f"has the tables {' and '.join(f'[{kind}]' for kind in kinds)}; an actuator is one of "
            "them: write two files",
            file=file,
        )
    if not kinds:
        near = next((hint for key in tree if (hint := si.did_you_mean(key, list(KINDS)))), "")
        raise ConfigError(
            f"has no table of an actuator; one needs {tables}.{near} It has: "
            f"{', '.join(tree) or 'nothing'}",
            file=file,
        )
    return KINDS[kinds[0]]
