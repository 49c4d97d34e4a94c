"""Whether a toothed stator carries the finger as a continuous one would.

The teeth of a travelling-wave motor's stator stand over slots far deeper than the film, so that
the air in a slot is at ambient pressure, and the film on each tooth is a strip of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.film.gas import ISOTHERMAL, FilmGas
from squeezefilm.film.planar.film import FilmPlanar, solve_planar
from squeezefilm.film.planar.gap import GapFunction, PlanarGap
from squeezefilm.kept.store import Kept

_PHASES = 5
# Some twenty films in the plane: seconds, for one number that an analysis asks for every time.
_KEPT: Kept[float] = Kept("toothed-films", float)


@dataclass(frozen=True)
class ToothedFilm:
    """Mean over-pressure over the finger, on a continuous and on a toothed surface.

    `toothed` is already a mean over teeth and slots; `ratio` is `toothed` over `continuous`;
    `tooth_squeeze_number` is σ on the tooth's width.
    """

    continuous: si.Dimensionless
    toothed: si.Dimensionless
    ratio: si.Dimensionless
    tooth_squeeze_number: si.Dimensionless
    tooth_width: si.Dimensionless
    tooth_pitch: si.Dimensionless
    surface: FilmPlanar
    status: str


def _tooth_gap(gap: PlanarGap, excursion: float, width: float, shift: float) -> GapFunction:
    wave_number = gap.ridge_wave_number * width
    if gap.ridge_height == 0.0:
        return PlanarGap(excursion)

    def on_tooth(X: si.FloatArray, Y: si.FloatArray, T: si.FloatArray) -> si.FloatArray:
        ridges = gap.ridge_height * np.cos(wave_number * X + shift)
        return np.asarray(1.0 + excursion * np.cos(T) + ridges)

    return on_tooth


@si.checked_numbers
def compare_teeth(
    squeeze_number: si.Dimensionless,
    gap: PlanarGap,
    *,
    tooth_width: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)],
    tooth_pitch: Annotated[si.Dimensionless, si.Above(0.0)],
    aspect_ratio: si.Dimensionless = 1.0,
    gas: FilmGas = ISOTHERMAL,
    tolerance: si.Dimensionless = 1e-2,
) -> ToothedFilm:
    """The over-pressure under a rectangular finger on a toothed surface, against a smooth one.

    `squeeze_number` is on the finger's side along X; `tooth_width` and `tooth_pitch` are in that
    length, the teeth run along Y over the whole `aspect_ratio`. Each tooth is solved in the plane
    with all sides at ambient pressure, moving with the amplitude of the wave at its centre (its
    slope over one tooth is left out); the mean is taken over the positions of teeth along the
    wave, and over those of the finger's ridges on a tooth.

    Raises what `solve_planar` raises, and `InputError` for a tooth wider than its pitch.
    An estimate: the flow along a slot is taken as free, and the finger as plane.
    """
    if tooth_width > tooth_pitch:
        raise InputError(
            f"tooth_width = {tooth_width:.4g} exceeds tooth_pitch = {tooth_pitch:.4g}; "
            "a tooth must be at most as wide as its pitch"
        )
    surface = solve_planar(
        "rectangle", gap, squeeze_number, aspect_ratio=aspect_ratio, gas=gas, tolerance=tolerance
    )
    local = squeeze_number * tooth_width**2
    of_tooth = (gap, local, tooth_width, aspect_ratio / tooth_width, gas, tolerance)
    total = _KEPT.found(repr(of_tooth), lambda: _over_teeth(*of_tooth))
    toothed = total * tooth_width / tooth_pitch
    ratio = toothed / surface.over_pressure
    return ToothedFilm(
        continuous=surface.over_pressure,
        toothed=toothed,
        ratio=ratio,
        tooth_squeeze_number=local,
        tooth_width=tooth_width,
        tooth_pitch=tooth_pitch,
        surface=surface,
        status=f"a toothed surface gives {ratio:.2g} of the continuous surface's over-pressure",
    )


def _over_teeth(
    gap: PlanarGap,
    squeeze_number: float,
    width: float,
    aspect_ratio: float,
    gas: FilmGas,
    tolerance: float,
) -> float:
    """The over-pressure on teeth, over their places along the wave and those of ridges on them.

    `squeeze_number` and `aspect_ratio` are a tooth's, on its `width` in the finger's length.
    """
    # Midpoints in the finger's half length: the wave need not fit it a whole number of times.
    centres = (np.arange(_PHASES) + 0.5) / (2 * _PHASES) if gap.wave_number > 0 else np.zeros(1)
    # Ridges: a groove, a flank or a crest at the middle of the tooth; the flank counts twice.
    ridged = gap.ridge_height > 0.0
    shifts = ((0.0, 0.25), (0.5 * np.pi, 0.5), (np.pi, 0.25)) if ridged else ((0.0, 1.0),)
    cells = (2 * max(4, int(np.ceil(gap.ridge_wave_number * width / 2))), 8)
    total = 0.0
    for amplitude in gap.excursion_ratio * np.abs(np.cos(gap.wave_number * centres)):
        # At a node of the wave a tooth carries nothing, and less than can be computed.
        if amplitude < 1e-3 * gap.excursion_ratio:
            continue
        for shift, share in shifts:
            film = solve_planar(
                "rectangle",
                _tooth_gap(gap, float(amplitude), width, shift),
                squeeze_number,
                aspect_ratio=aspect_ratio,
                cells=cells if ridged else None,
                gas=gas,
                tolerance=tolerance,
            )
            total += share * film.over_pressure / centres.size
    return total
