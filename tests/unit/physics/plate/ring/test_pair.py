"""One channel on a ring's pair of modes: limits, a search against the closed forms, the crests."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.plate.ring_pair import (
    crest_speed,
    electrode_split,
    least_standing_wave_ratio,
    most_travelling,
)
from squeezefilm.physics.plate.layout import DiscPlate
from squeezefilm.physics.plate.ring.modes import AnnularMode, annular_modes
from squeezefilm.physics.plate.ring.section import alternate_sectors, bonded_disc


@pytest.mark.parametrize("split", [0.05, 0.3, 1.0, 2.0, 3.0, 5.0])
def test_the_worst_is_that_of_a_search(split: float) -> None:
    # Both orientations as one channel drives them whose antinodes lie `axis` from the lower one's,
    # d half-bandwidths from the middle: two waves around, of sizes |c ± i s|/2.
    axis = np.linspace(0.01, math.pi / 2 - 0.01, 179)[:, np.newaxis]
    d = np.linspace(-split, split, 201)
    lower = np.cos(axis) / (1 + 1j * (d + split / 2))
    upper = np.sin(axis) / (1 + 1j * (d - split / 2))
    forward, backward = abs(lower + 1j * upper) / 2, abs(lower - 1j * upper) / 2
    travelling = abs(forward - backward)
    assert np.max(travelling) == pytest.approx(most_travelling(split), rel=2e-3)
    ratio = np.min((forward + backward) / travelling)
    assert ratio == pytest.approx(least_standing_wave_ratio(split), rel=0.1)


def bending(disc: DiscPlate, diameters: int) -> AnnularMode:
    modes = annular_modes(bonded_disc(disc), diameters, count=4, quality_factor=50.0)
    return next(mode for mode in modes if mode.label == f"B(0,{diameters})")


def test_open_electrodes_part_a_pair_and_shorted_ones_do_not(disc: DiscPlate) -> None:
    section, mode = bonded_disc(disc), bending(disc, 3)
    whole = electrode_split(section, mode, alternate_sectors(6, math.pi / 3))
    half = electrode_split(section, mode, alternate_sectors(3, math.pi / 3))
    most = electrode_split(section, mode, alternate_sectors(1, math.pi / 3))
    # Each sector that is left open adds the same: none, three, five of six.
    assert whole == 0.0
    assert half > 0
    assert most / half == pytest.approx(5 / 3)
    with pytest.raises(InputError, match="one orientation"):
        electrode_split(
            section,
            annular_modes(section, 0, count=4, quality_factor=50.0)[-1],
            alternate_sectors(6, math.pi / 3),
        )


def test_crests_move_as_a_thin_plates_do(disc: DiscPlate) -> None:
    # u = −(h/2 above the neutral plane) ∂w/∂s: for a thin disc the ratio is a height over r/m.
    mode = bending(disc, 3)
    speed = crest_speed(mode, 1e-6)
    radius = disc.diameter / 2
    whole = disc.thickness + disc.ceramic_thickness
    height = speed / (2 * math.pi * mode.frequency * 1e-6) * radius / 3
    assert 0.3 * whole < height < 0.8 * whole
    assert crest_speed(mode, 0.0) == 0.0


@pytest.mark.parametrize("harmonic", [0, 1])
def test_rigid_motions_of_a_thin_ring_are_rigid(disc: DiscPlate, harmonic: int) -> None:
    # A tilt of such a ring was listed as an elastic mode "B(0,1)" at 0.34 Hz.
    ring = dataclasses.replace(
        disc,
        diameter=0.2,
        inner_diameter=0.19,
        thickness=0.3e-3,
        ceramic_outer_diameter=0.2,
        ceramic_inner_diameter=0.19,
        ceramic_thickness=0.2e-3,
    )
    modes = annular_modes(bonded_disc(ring), harmonic, count=4, quality_factor=50.0)
    assert [mode.is_rigid for mode in modes] == [True, True, False, False]
    assert all(mode.frequency == 0 for mode in modes[:2])
    assert all(mode.frequency > 100 for mode in modes[2:])
