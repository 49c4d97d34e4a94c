"""TOML to the frozen dataclass a room owns. Generic: knows no display, no plate, no study."""

from squeezefilm.core.config.load import load, load_text
from squeezefilm.core.config.provenance import Provenance

__all__ = ["Provenance", "load", "load_text"]
