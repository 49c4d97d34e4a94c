"""Displays named for their paper, each value with its source; materials by name; textures, studies
and simulated observers to begin with.

Files only: rooms above read them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.presets import materials as materials

_FOLDER = Path(__file__).parent
_NOT_DISPLAYS = {"claims", "materials"}

Kind = Literal["display", "actuator", "texture", "requirements", "study", "observer"]
"""Kinds of preset; an actuator is a motor or a skin-stretch array."""
_FOLDERS: dict[Kind, Path] = {
    "display": _FOLDER,
    "actuator": _FOLDER / "actuators",
    "texture": _FOLDER / "textures",
    "requirements": _FOLDER / "requirements",
    "study": _FOLDER / "studies",
    "observer": _FOLDER / "observers",
}
_WORDS = {"display": "preset", "requirements": "set of requirements"}
_PLURALS = {"study": "studies", "requirements": "sets of requirements"}


def names(kind: Kind) -> tuple[str, ...]:
    """The names of all presets of a kind, sorted."""
    return tuple(
        sorted(
            path.stem
            for path in _FOLDERS[kind].glob("*.toml")
            if kind != "display" or path.stem not in _NOT_DISPLAYS
        )
    )


def display_names() -> tuple[str, ...]:
    """The names of all preset displays, sorted."""
    return names("display")


def texture_names() -> tuple[str, ...]:
    """The names of all preset textures, sorted."""
    return names("texture")


def study_names() -> tuple[str, ...]:
    """The names of all preset studies, sorted."""
    return names("study")


def friction_folder() -> Path:
    """The folder of published friction measurements."""
    return _FOLDER / "friction"


def claims_path() -> Path:
    """The TOML file of the published claims that `squeezefilm reproduce` recomputes."""
    return _FOLDER / "claims.toml"


def path(name: str, kind: Kind = "display") -> Path:
    """The TOML file of a preset. Raises `ConfigError` for a name that is not known."""
    if name not in names(kind):
        raise _unknown(f"there is no {_WORDS.get(kind, kind)} '{name}'", name, kind)
    return _FOLDERS[kind] / f"{name}.toml"


def resolve(name_or_path: str | Path, kind: Kind = "display") -> Path:
    """The file of a preset's name or of a path to a TOML file.

    A text without a separator and without ``.toml`` is a preset's name unless such a file exists.
    """
    text, candidate = str(name_or_path), Path(name_or_path)
    looks_like_name = candidate.name == text and candidate.suffix != ".toml"
    if looks_like_name and text in names(kind):
        return path(text, kind)
    if looks_like_name and not _exists(candidate):
        says = f"'{text[:100]}' is neither a file nor a {_WORDS.get(kind, kind)}"
        raise _unknown(says, text, kind)
    return candidate


def _unknown(says: str, name: str, kind: Kind) -> ConfigError:
    """The error for a name that is not a preset of a kind: `says` what was asked, and then what
    there is. Where a display is wanted, motors and skin-stretch arrays are listed as well."""
    known, also = names(kind), names("actuator") if kind == "display" else ()
    listed = f"{_PLURALS.get(kind, f'{kind}s').capitalize()}: {', '.join(known)}"
    if also:
        if name in also:
            says = f"'{name}' is a motor or a skin-stretch array, and a display is wanted here"
        listed = (
            f"Displays: {', '.join(known)}. Motors and skin-stretch arrays, for squeezefilm "
            f"analyze and squeezefilm show only: {', '.join(also)}"
        )
    near = "" if name in names("actuator") else si.did_you_mean(name, (*known, *also))
    return ConfigError(f"{says}.{near} {listed}")


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:
        # A name longer than the system has, for one.
        return False
