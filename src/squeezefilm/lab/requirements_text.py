"""Requirements from a page's text: read with the lab's own files only, checked, said in words."""

from __future__ import annotations

import hashlib
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit

from squeezefilm.core import config, presets
from squeezefilm.core.config.scan import require_quick_toml
from squeezefilm.core.errors import ConfigError
from squeezefilm.design.search.candidate import Design
from squeezefilm.design.search.criteria import bounded, criterion_of
from squeezefilm.design.search.report.page import plate_file
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.lab.files import existing

_DISPLAYS = ("start_from", "compare_with")
"""Keys of requirements that name a display, which may be a file."""


def requirements_of(text: str, folder: Path) -> Requirements:
    """The requirements that a TOML text states. A display that it names is a preset's or a file of
    the lab's folder, as everything else that a page reads.

    Raises:
        ConfigError: a text that states none, with the line.
        InputError: a display's file that is not in the folder.
    """
    return config.load_text(Requirements, _with_files_of(text, folder))


def _with_files_of(text: str, folder: Path) -> str:
    """The same text, line by line, with the whole paths of the displays' files."""
    require_quick_toml(text)
    try:
        stated = tomllib.loads(text)
    except (ValueError, RecursionError):
        return text  # whoever reads it says what is wrong in which line
    files = {}
    for key in _DISPLAYS:
        name = stated.get(key)
        if isinstance(name, str) and name and name not in presets.display_names():
            files[key] = str(existing(folder, name, ".toml").resolve())
    if not files:
        return text
    document = tomlkit.parse(text)
    document.update(files)
    return tomlkit.dumps(document)


def asked_of(text: str, folder: Path) -> dict[str, Any]:
    """Words for what requirements ask for, before anything is computed. Raises as
    `requirements_of`, and for a display that they start from and that cannot be read."""
    asked = requirements_of(text, folder)
    return {
        "name": asked.name,
        "title": asked.title,
        "note": asked.note,
        "objectives": [
            {
                "key": criterion.key,
                "said": criterion.said,
                "unit": "" if criterion.unit.symbol == "1" else criterion.unit.symbol,
            }
            for criterion in map(criterion_of, asked.objectives)
        ],
        "limits": [criterion.limit_said(bound) for criterion, bound in bounded(asked.limits)],
        "shapes": [
            {"name": space.shape, "chosen": [free.name.replace("_", " ") for free in space.free]}
            for space in asked.spaces
        ],
        "start_from": Path(asked.start_from).stem,
        "compare_with": Path(asked.compare_with).stem if asked.compare_with else "",
        "assumed": list(asked.assumed),
    }


def display_text(text: str, folder: Path, shape: int, values: Mapping[str, Any]) -> str:
    """The TOML text of the display that a search of requirements made of a shape's number and of
    what it chose. Raises as `requirements_of`, and `ConfigError` for a shape that is not there."""
    asked = requirements_of(text, folder)
    if not 0 <= shape < len(asked.shapes):
        raise ConfigError(f"the requirements have no shape {shape + 1}")
    return plate_file(asked, Design(shape, tuple(values.items())))


def folder_of(name: str, text: str) -> str:
    """The name of the folder of a search: the same for the same text, so that what is known is
    asked once, and another for every other, whose answers are not alike."""
    plain = re.sub(r"[^A-Za-z0-9]+", "-", name)[:40].strip("-") or "search"
    return f"{plain}-{hashlib.sha256(text.encode()).hexdigest()[:8]}"
