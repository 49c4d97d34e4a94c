"""Predictions over arrays of voltage, force, speed and place, as a labelled dataset with units."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError, optional
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import stamp
from squeezefilm.physics.chain.pad_law import FrictionModel
from squeezefilm.physics.chain.pad_place import FacePlace, read_place
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import NamedDisplay

MOST_POINTS = 20_000
"""Points of one grid, at some 15 ms each."""

_ANSWERS = {
    "relative_friction": ("1", "friction over the friction at rest"),
    "friction_reduction": ("1", "coefficient without vibration less that with it"),
    "tangential_force": ("N", "tangential force"),
    "vibration_amplitude": ("m", "amplitude at the antinode, zero-to-peak, finger on"),
    "amplitude_under_pad": ("m", "root mean square amplitude that the pad meets, finger on"),
}
_UNITS = {"voltage": "V", "normal_force": "N", "speed": "m/s"}


@reads_text
def predict_grid(
    display: NamedDisplay,
    *,
    voltage: Sequence[si.Volt] | si.VoltArray | None = None,
    normal_force: Sequence[si.Newton] | si.NewtonArray | None = None,
    speed: Sequence[si.MetrePerSecond] | si.MetrePerSecondArray | None = None,
    place: Sequence[FacePlace | str] | None = None,
    model: FrictionModel | None = None,
    progress: SayProgress | None = None,
) -> Any:
    """The friction of a display at every combination of voltages (V), normal forces (N), speeds of
    the finger (m/s) and places (x, y in m), as a `xarray.Dataset`.

    Each argument that is given is a dimension, in the order above; places are numbered and have
    `place_x` and `place_y`. What is left out is the display's own, as in `predict`, whose ranges,
    `model` and sources hold. Variables have their unit and meaning as attributes `units` and
    `long_name`, the dataset the display, the model, the warnings of any point, version and hash.
    `progress` is told each point before it is predicted.

    Raises:
        InputError: nothing was given, an empty or nested array, more than 20 000 points, or a value
            that `predict` refuses; nothing is computed before the first three are known.
        MissingPackageError: without xarray, which comes with the extra `design`.
    """
    with optional("design", "a dataset of predictions"):
        import xarray

    grid: dict[str, Sequence[Any]] = {}
    for name, values in (("voltage", voltage), ("normal_force", normal_force), ("speed", speed)):
        if values is not None:
            grid[name] = _row(name, values)
    if place is not None:
        grid["place"] = [read_place(xy) if isinstance(xy, str) else xy for xy in place]
    if not grid:
        raise InputError("give at least one of voltage, normal_force, speed and place as an array")
    shape = tuple(len(values) for values in grid.values())
    if 0 in shape or np.prod(shape, dtype=float) > MOST_POINTS:
        sizes = " × ".join(f"{len(values)} of {name}" for name, values in grid.items())
        raise InputError(f"a grid of {sizes}; allowed are 1 to {MOST_POINTS} points in all")
    points = []
    for number, values in enumerate(itertools.product(*grid.values())):
        if progress is not None:
            progress(f"prediction {number + 1} of {math.prod(shape)}")
        points.append(predict(display, **dict(zip(grid, values, strict=True)), model=model))
    return xarray.Dataset(
        {
            name: (tuple(grid), _values(points, name, shape), {"units": unit, "long_name": said})
            for name, (unit, said) in _ANSWERS.items()
        },
        coords=_coordinates(grid),
        attrs={
            "display": display.name,
            "model": points[0].model,
            "warnings": list(dict.fromkeys(text for point in points for text in point.warnings)),
            **{key: value for key, value in stamp(display).items() if value is not None},
        },
    )


def _row(name: str, values: Any) -> list[float]:
    """The values of one dimension as plain numbers."""
    array = np.asarray(values, dtype=float)
    if array.ndim != 1:
        raise InputError(f"{name} has {array.ndim} dimensions; give a list or an array of one")
    return [float(value) for value in array]


def _values(points: list[Prediction], name: str, shape: tuple[int, ...]) -> si.FloatArray:
    return np.array([getattr(point, name) for point in points]).reshape(shape)


def _coordinates(grid: dict[str, Sequence[Any]]) -> dict[str, Any]:
    """The values of each dimension, with their units."""
    coordinates: dict[str, Any] = {
        name: (name, values, {"units": _UNITS[name]})
        for name, values in grid.items()
        if name in _UNITS
    }
    if "place" in grid:
        for axis, along in enumerate(("place_x", "place_y")):
            coordinates[along] = ("place", [place[axis] for place in grid["place"]], {"units": "m"})
    return coordinates
