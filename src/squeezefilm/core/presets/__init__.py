"""Displays named for their paper, each value with its source; materials by name; textures, studies
and simulated observers to begin with.

Files only: rooms above read them.
"""

from __future__ import annotations

from pathlib import Path

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.presets import materials as materials

_FOLDER = Path(__file__).parent
_NOT_DISPLAYS = {"claims", "materials"}


def display_names() -> tuple[str, ...]:
    """The names of all preset displays, sorted."""
    return tuple(name for name in _names(_FOLDER) if name not in _NOT_DISPLAYS)


def friction_folder() -> Path:
    """The folder of published friction measurements."""
    return _FOLDER / "friction"


def actuator_names() -> tuple[str, ...]:
    """The names of all preset motors and skin-stretch arrays, sorted."""
    return _names(_FOLDER / "actuators")


def texture_names() -> tuple[str, ...]:
    """The names of all preset textures, sorted."""
    return _names(_FOLDER / "textures")


def requirement_names() -> tuple[str, ...]:
    """The names of all preset requirements for a design search, sorted."""
    return _names(_FOLDER / "requirements")


def study_names() -> tuple[str, ...]:
    """The names of all preset studies, sorted."""
    return _names(_FOLDER / "studies")


def _names(folder: Path) -> tuple[str, ...]:
    return tuple(sorted(path.stem for path in folder.glob("*.toml")))


def path(name: str) -> Path:
    """The TOML file of a preset display. Raises `ConfigError` for a name that is not known."""
    if name not in display_names():
        raise _unknown(f"there is no preset '{name}'", name, "preset", display_names())
    return _FOLDER / f"{name}.toml"


def study_path(name: str) -> Path:
    """The TOML file of a preset study. Raises `ConfigError` for a name that is not known."""
    if name not in study_names():
        raise _unknown(f"there is no study '{name}'", name, "study", study_names())
    return _FOLDER / "studies" / f"{name}.toml"


def claims_path() -> Path:
    """The TOML file of the published claims that `squeezefilm reproduce` recomputes."""
    return _FOLDER / "claims.toml"


def resolve(name_or_path: str | Path) -> Path:
    """The file of a preset's name or of a path to a TOML file.

    A text without a separator and without ``.toml`` is a preset's name unless such a file exists.
    """
    return _resolved(name_or_path, "preset", display_names(), _FOLDER)


def resolve_actuator(name_or_path: str | Path) -> Path:
    """The file of a preset actuator's name or of a path to a TOML file. As `resolve` does."""
    return _resolved(name_or_path, "actuator", actuator_names(), _FOLDER / "actuators")


def resolve_requirements(name_or_path: str | Path) -> Path:
    """The file of preset requirements' name or of a path to a TOML file. As `resolve` does."""
    return _resolved(
        name_or_path, "set of requirements", requirement_names(), _FOLDER / "requirements"
    )


def resolve_texture(name_or_path: str | Path) -> Path:
    """The file of a preset texture's name or of a path to a TOML file. As `resolve` does."""
    return _resolved(name_or_path, "texture", texture_names(), _FOLDER / "textures")


def resolve_study(name_or_path: str | Path) -> Path:
    """The file of a preset study's name or of a path to a TOML file. As `resolve` does."""
    return _resolved(name_or_path, "study", study_names(), _FOLDER / "studies")


def resolve_observer(name_or_path: str | Path) -> Path:
    """The file of a preset observer's name or of a path to a TOML file. As `resolve` does."""
    folder = _FOLDER / "observers"
    return _resolved(name_or_path, "observer", _names(folder), folder)


def _resolved(name_or_path: str | Path, kind: str, known: tuple[str, ...], folder: Path) -> Path:
    text, candidate = str(name_or_path), Path(name_or_path)
    looks_like_name = candidate.name == text and candidate.suffix != ".toml"
    if looks_like_name and text in known:
        return folder / f"{text}.toml"
    if looks_like_name and not _exists(candidate):
        raise _unknown(f"'{text[:100]}' is neither a file nor a {kind}", text, kind, known)
    return candidate


def _unknown(says: str, name: str, kind: str, known: tuple[str, ...]) -> ConfigError:
    """The error for a name that is not a preset of a kind: `says` what was asked, and then what
    there is. Where a display is wanted, motors and skin-stretch arrays are listed as well."""
    also = actuator_names() if kind == "preset" else ()
    plural = {"study": "studies", "set of requirements": "sets of requirements"}
    listed = f"{plural.get(kind, f'{kind}s').capitalize()}: {', '.join(known)}"
    if also:
        if name in also:
            says = f"'{name}' is a motor or a skin-stretch array, and a display is wanted here"
        listed = (
            f"Displays: {', '.join(known)}. Motors and skin-stretch arrays, for squeezefilm "
            f"analyze and squeezefilm show only: {', '.join(also)}"
        )
    near = "" if name in actuator_names() else si.did_you_mean(name, (*known, *also))
    return ConfigError(f"{says}.{near} {listed}")


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:
        # A name longer than the system has, for one.
        return False
