"""Displays named for their paper, each value with its source. Files only: rooms above read them."""

from __future__ import annotations

from pathlib import Path

from squeezefilm.errors import ConfigError
from squeezefilm.quantities import did_you_mean

_FOLDER = Path(__file__).parent
_NOT_DISPLAYS = {"claims"}


def names() -> tuple[str, ...]:
    """The names of all preset displays, sorted."""
    return tuple(
        sorted(path.stem for path in _FOLDER.glob("*.toml") if path.stem not in _NOT_DISPLAYS)
    )


def path(name: str) -> Path:
    """The TOML file of a preset display. Raises `ConfigError` for a name that is not known."""
    if name not in names():
        raise ConfigError(
            f"there is no preset '{name}'.{did_you_mean(name, names())} "
            f"Presets: {', '.join(names())}"
        )
    return _FOLDER / f"{name}.toml"


def claims_path() -> Path:
    """The TOML file of the published claims that `squeezefilm reproduce` recomputes."""
    return _FOLDER / "claims.toml"


def resolve(name_or_path: str | Path) -> Path:
    """The file of a preset's name or of a path to a TOML file.

    A text without a separator and without ``.toml`` is a preset's name unless such a file exists.
    """
    candidate = Path(name_or_path)
    looks_like_name = candidate.name == str(name_or_path) and candidate.suffix != ".toml"
    if looks_like_name and str(name_or_path) in names():
        return path(str(name_or_path))
    if looks_like_name and not candidate.exists():
        raise ConfigError(
            f"'{name_or_path}' is neither a file nor a preset."
            f"{did_you_mean(str(name_or_path), names())} Presets: {', '.join(names())}"
        )
    return candidate
