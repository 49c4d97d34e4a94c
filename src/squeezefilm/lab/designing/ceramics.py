"""Where a plate's ceramics end when the plate is made longer or wider: said, and stretched."""

from __future__ import annotations

import tomlkit

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.lab.designing.form import display_of, form, write_value
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate

_METRE = si.Unit("m")
_LEAST_SHARE: si.Dimensionless = 1e-3
"""Of a side: ceramics that end so near the edge cover it."""
_SIDES = {"actuator.length": ("x", "length"), "actuator.width": ("y", "width")}


def covered(actuator: Actuator) -> dict[str, str]:
    """For each side that the ceramics leave partly bare, by its dotted path, what they cover."""
    if not isinstance(actuator, RectangularPlate) or not actuator.patches:
        return {}
    said = {}
    for path, (axis, size) in _SIDES.items():
        side = getattr(actuator, size)
        first, last = _ends(actuator, axis, size)
        if last - first < side * (1.0 - _LEAST_SHARE):
            ends = " to ".join(si.format_quantity(end, _METRE) for end in (first, last))
            whole = si.format_quantity(side, _METRE)
            said[path] = f"the ceramics cover {axis} = {ends} of {whole}"
    return said


def stretched(text: str, path: str) -> str:
    """The display's text with its ceramics stretched over a side, their gaps with them.

    `path` is the side's, "actuator.length" or "actuator.width".
    Raises `InputError` for another path, a display without ceramics there, or one that does not
    fit stretched; `ConfigError` for a text that is no display.
    """
    actuator = display_of(text).actuator
    if path not in _SIDES or not isinstance(actuator, RectangularPlate) or not actuator.patches:
        raise InputError(f"there are no ceramics to stretch along '{path[:200]}'")
    axis, size = _SIDES[path]
    first, last = _ends(actuator, axis, size)
    scale = getattr(actuator, size) / (last - first)
    document, rows = tomlkit.parse(text), {row["path"]: row for row in form(text)}
    for number, patch in enumerate(actuator.patches):
        start, end = (scale * (place - first) for place in _edges(patch, axis, size))
        for name, value in ((axis, start), (size, end - start)):
            written = si.typed_quantity(value, _METRE, digits=9)
            write_value(document, rows, f"actuator.patches.{number}.{name}", written)
    found = tomlkit.dumps(document)
    display_of(found)
    return found


def _edges(patch: object, axis: str, size: str) -> tuple[si.Metre, si.Metre]:
    start: float = getattr(patch, axis)
    return start, start + float(getattr(patch, size))


def _ends(actuator: RectangularPlate, axis: str, size: str) -> tuple[si.Metre, si.Metre]:
    edges = [_edges(patch, axis, size) for patch in actuator.patches]
    return min(start for start, _ in edges), max(end for _, end in edges)
