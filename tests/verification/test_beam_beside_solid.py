"""How far a beam is from plates solved in three dimensions: a campaign, which prints what it found.

What is told of a beam's doubt (`physics.plausibility.expected`,
`physics.chain.touch`) rests on this.
"""

from collections.abc import Callable

import numpy as np
import pytest
from tests.verification.random_plates import random_glass, random_plate, screened_plate

from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.physics.plate import beam_pieces
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plate.layout import RectangularPlate, turned
from squeezefilm.physics.plate.working_mode import working_mode

LEAST_DRIVEN = 1e-9
"""The amplitude (m/V) below which a plate's ceramics cancel, and a ratio says nothing."""


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("make", "count"),
    [(random_plate, 50), (screened_plate, 24), (random_glass, 24)],
    ids=["strips that cross the plate", "covered in part", "glass with edge strips"],
)
def test_the_beams_frequency_beside_the_solved_one(
    make: Callable[[int], RectangularPlate], count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And how near it would be with other lengths without stress at the ceramics' ends."""
    frequencies, amplitudes = list[float](), list[float]()
    others = dict[float, list[float]]((inset, []) for inset in (0.0, 0.3, 0.6, 0.9, 1.2))
    for seed in range(count):
        plate = make(seed)
        try:
            solved, beam = working_mode(plate), beam_response(plate)
        except SqueezefilmError as error:
            print(f"plate {seed}: {error}")
            continue
        frequencies.append(beam.mode.frequency / solved.resonance_frequency)
        if min(solved.amplitude_per_volt, beam.amplitude_per_volt) > LEAST_DRIVEN:
            amplitudes.append(beam.amplitude_per_volt / solved.amplitude_per_volt)
        along = plate if plate.lines_across == "length" else turned(plate)
        for inset, ratios in others.items():
            with monkeypatch.context() as patch:
                patch.setattr(beam_pieces, "UNSTRESSED", inset)
                made = beam_pieces.beam_pieces(along, "plane_strain")
            there = beam_pieces.pieced_beam_mode(made, plate.nodal_lines).frequency
            ratios.append(there / solved.resonance_frequency)
        print(
            f"plate {seed}, {plate.nodal_lines} lines, {plate.coverage:.2f} covered: frequency "
            f"{frequencies[-1]:.3f} of {solved.resonance_frequency:.0f} Hz, amplitude per volt "
            f"{beam.amplitude_per_volt:.3g} for {solved.amplitude_per_volt:.3g} m"
        )
    off = np.abs(np.log(frequencies))
    counts = ", ".join(
        f"{np.sum(off < np.log1p(one))} within {one:.0%}" for one in (0.05, 0.1, 0.3)
    )
    print(f"frequencies of {off.size} plates: {counts}; the worst {np.exp(np.max(off)):.3f}")
    for inset, ratios in others.items():
        mean, spread = np.mean(np.log(ratios)), np.std(np.log(ratios))
        print(f"{inset} thicknesses without stress: mean {mean:+.4f}, spread {spread:.4f}")
    off = np.abs(np.log(amplitudes))
    counts = ", ".join(f"{np.sum(off < np.log1p(one))} within {one:.0%}" for one in (0.1, 0.3, 1.0))
    print(f"amplitudes of {off.size} plates that are driven: {counts}")
    assert np.max(np.abs(np.log(frequencies))) < np.log1p(0.15)
