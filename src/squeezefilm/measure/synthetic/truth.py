"""The display that a synthetic bench stands for: values drawn from the ranges of a description."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal, get_args

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.chain.friction_models import DEFAULT_MODEL, FrictionModel
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.uncertainty.parameters import (
    SKIN_COMPLIANCE,
    Parameter,
    uncertain_parameters,
    with_values,
)

Mechanism = Literal["as described", "another law", "unmodelled mode", "uneven glue"]
MECHANISMS: tuple[Mechanism, ...] = get_args(Mechanism)
"""What the bench has that the description has not: nothing, friction by another law than the
default one, a resonance of what holds the plate, or a bond that is not the same everywhere."""

_OTHER_LAWS: tuple[FrictionModel, ...] = ("partial-levitation", "levitation-2016")
_TRIED = 40
# Of the ceramic's thickness, from patch to patch. The library's glue is one layer under all
# patches, so that a plate that is stiffer here than there stands for an uneven bond.
_UNEVEN = 0.12


@si.checked_numbers
@dataclass(frozen=True)
class SyntheticOptions:
    """How a synthetic bench errs.

    `noise` is one standard deviation of a recording over its largest value, of forces too;
    `stroke_spread` that of ln µ between strokes, `sweating` how much ln µ rises during the session;
    `background` the size of a straight remainder of frequency responses and the drift of a line
    scan, over the largest value; `missing` the share of points that are not there; with
    `phase_reversed` phases have the other sign. `backbone` and `damping_rise` are what frequency
    and loss change by at the display's own voltage, as shares. All are made up.
    """

    noise: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(0.2)] = 0.01
    stroke_spread: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(0.5)] = 0.08
    sweating: Annotated[si.Dimensionless, si.AtLeast(-1), si.AtMost(1)] = 0.2
    background: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(0.5)] = 0.02
    missing: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(0.5)] = 0.0
    phase_reversed: bool = False
    backbone: Annotated[si.Dimensionless, si.AtLeast(-0.05), si.AtMost(0.05)] = -0.004
    damping_rise: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(1)] = 0.15
    mechanism: Mechanism = "as described"

    def __post_init__(self) -> None:
        si.require_one_of("mechanism", self.mechanism, MECHANISMS)


@dataclass(frozen=True)
class SyntheticTruth:
    """What a synthetic bench is made of, and its recordings do not tell.

    `display` has the true `values` (by dotted path, SI); `model` is the true law of friction.
    """

    display: Display
    seed: int
    options: SyntheticOptions
    model: FrictionModel = DEFAULT_MODEL
    values: Mapping[str, float] = field(default_factory=dict)


def drawn_truth(
    display: Display,
    seed: int,
    options: SyntheticOptions | None = None,
    parameters: Sequence[Parameter] | None = None,
) -> SyntheticTruth:
    """A display with values drawn from its own ranges, by a seed.

    `parameters` are the display's uncertain ones by default; a calibration passes those that it
    learns. Draws that make no display (a plateau wider than its ridge) are drawn again. Raises
    `InputError` where none of 40 makes one.
    """
    options = options or SyntheticOptions()
    random = np.random.default_rng([seed, 19])
    drawn = uncertain_parameters(display, driven=True) if parameters is None else parameters
    # How soft a pad is belongs to the model, not to a value of the display.
    drawn = [one for one in drawn if one.path != SKIN_COMPLIANCE]
    for _ in range(_TRIED):
        shares = random.random(len(drawn))
        values = {
            one.path: one.drawn(np.array([share]))[0]
            for one, share in zip(drawn, shares, strict=True)
        }
        try:
            true = with_values(display, values)
        except InputError as error:
            refused = error
            continue
        break
    else:
        raise InputError(f"none of {_TRIED} draws makes a display: {refused}")
    model = DEFAULT_MODEL
    if options.mechanism == "another law":
        model = _OTHER_LAWS[int(random.integers(len(_OTHER_LAWS)))]
    if options.mechanism == "uneven glue":
        true = _uneven(true, random)
    return SyntheticTruth(true, seed, options, model, values)


def _uneven(display: Display, random: np.random.Generator) -> Display:
    plate = display.actuator
    if not isinstance(plate, RectangularPlate):
        raise InputError(
            f"'{display.name}' is no plate with ceramics on it; an uneven bond needs one",
            quantity="mechanism",
        )
    patches = tuple(
        dataclasses.replace(one, thickness=one.thickness * (1 + _UNEVEN * random.uniform(-1, 1)))
        for one in plate.patches
    )
    return dataclasses.replace(display, actuator=dataclasses.replace(plate, patches=patches))
