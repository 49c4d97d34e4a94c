"""Which modes a drive is kept from, and what screening finds beside the solved plate."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plate.layout import CeramicPatch, Electrode, RectangularPlate
from squeezefilm.physics.plate.solid import resonances
from squeezefilm.physics.plate.solid.layers import SCREENING
from squeezefilm.physics.plate.solid.resonances import (
    SCREENING_ERROR,
    DrivenMode,
    Moving,
    antinode,
    screened_modes,
    strongest_neighbour,
)
from squeezefilm.physics.plate.solid.response import harmonic_response
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.symmetry import (
    drive_classes,
    forbidden_by,
    symmetry_in_words,
)
from squeezefilm.physics.plate.solid.working import solid_mode

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)


def strips(*signs: int, electrode: Electrode = "driven", **changes: Any) -> RectangularPlate:
    """A small glass plate with strips of 4 mm across it, each with its sign."""
    step = 30e-3 / len(signs)
    patches = tuple(
        CeramicPatch(k * step + (step - 4e-3) / 2, 0.0, 4e-3, 16e-3, 0.5e-3, sign)  # type: ignore[arg-type]
        for k, sign in enumerate(signs)
    )
    last = dataclasses.replace(patches[-1], electrode=electrode)
    return RectangularPlate(
        30e-3, 16e-3, 1.2e-3, 4, 60, GLASS, CERAMIC, (*patches[:-1], last), **changes
    )


@pytest.mark.parametrize(
    ("signs", "label", "kept"),
    [
        ((1, -1, 1, -1, 1), (5, 0), "length"),
        ((1, -1, 1, -1, 1), (6, 0), None),
        ((1, -1, 1, -1, 1), (6, 1), "width"),
        ((1, -1), (6, 0), "length"),
        ((1, -1), (5, 0), None),
        ((1, 1, -1), (5, 0), None),
        ((1, 1, -1), (6, 0), None),
        ((1, 1, -1), (0, 3), "width"),
    ],
)
def test_symmetry_says_which_modes_it_forbids(
    signs: tuple[int, ...], label: tuple[int, int], kept: str | None
) -> None:
    said = forbidden_by(strips(*signs), label)
    assert (said is None) == (kept is None)
    if kept is not None:
        assert said is not None
        assert f"lines across the {kept}" in said
        assert f"({label[0]},{label[1]})" in said


def on_both_faces(plate: RectangularPlate, sign: int) -> RectangularPlate:
    """The plate with the same ceramics on its upper face, their signs times `sign`."""
    above = tuple(
        dataclasses.replace(patch, face="top", polarity=sign * patch.polarity)
        for patch in plate.patches
    )
    return dataclasses.replace(plate, patches=(*plate.patches, *above))


def test_ceramics_that_only_stretch_a_plate_bend_nothing() -> None:
    """Equal signs on both faces: symmetry forbids every mode of bending, the beam says so, and the
    light mesh finds only rounding errors of it, where opposite signs double the moment."""
    plate, label = strips(1, -1, 1), (4, 0)
    alike, against = on_both_faces(plate, 1), on_both_faces(plate, -1)
    said = forbidden_by(alike, label)
    assert said is not None
    assert "(4,0)" in said
    assert "other face" in said
    assert forbidden_by(against, label) is None
    # One ceramic elsewhere, and the mirror is broken.
    moved = dataclasses.replace(alike.patches[-1], x=alike.patches[-1].x + 1e-3)
    broken = dataclasses.replace(alike, patches=(*alike.patches[:-1], moved))
    assert forbidden_by(broken, label) is None
    beam_response(against).require_driven()
    with pytest.raises(OutOfRangeError, match="does not bend the plate"):
        beam_response(alike).require_driven()
    amplitudes = {
        plate: max(
            (mode.alone_per_volt for mode in screened_modes(plate, (20e3, 70e3)) if mode.label),
            default=0.0,
        )
        for plate in (alike, against)
    }
    assert amplitudes[alike] < 1e-3 * amplitudes[against]


@pytest.mark.slow
@pytest.mark.parametrize("electrode", ["driven", "open", "shorted"])
def test_screened_modes_are_those_of_the_solved_plate(electrode: Electrode) -> None:
    plate, band = strips(1, -1, 1, electrode=electrode), (20e3, 70e3)
    solved = solve_modes(plate, band=band, driven_only=True, tolerance=0.05)
    screened = screened_modes(plate, band)
    omega = 2 * np.pi * solved.frequencies
    largest = np.max(np.abs(solved.shapes), axis=(1, 2))
    per_volt = solved.quality_factors * solved.drive_forces * largest / omega**2
    compared = 0
    for i in np.flatnonzero(per_volt > 0.05 * per_volt.max()):
        same = [mode for mode in screened if mode.label == solved.labels[i]]
        near = min(same, key=lambda mode: abs(mode.frequency - solved.frequencies[i]))
        assert near.frequency == pytest.approx(solved.frequencies[i], rel=SCREENING_ERROR)
        most = near.alone_per_volt / antinode(near.shape, near.label)
        assert most == pytest.approx(per_volt[i], rel=0.2)
        assert near.quality_factor == pytest.approx(solved.quality_factors[i], rel=0.05)
        compared += 1
    assert compared >= 1


def test_what_cannot_be_screened_is_refused() -> None:
    with pytest.raises(InputError, match="driven"):
        screened_modes(
            dataclasses.replace(
                strips(1),
                patches=(dataclasses.replace(strips(1).patches[0], electrode="shorted"),),
            ),
            (20e3, 60e3),
        )
    with pytest.raises(InputError, match="lower and a higher"):
        screened_modes(strips(1), (60e3, 20e3))


def test_of_two_axes_driven_both_ways_not_every_pair_is() -> None:
    # The corners, + − over − +, are odd along both sides, the middle is even along both.
    signs = {(0, 0): 1, (1, 1): 1, (0, 1): -1, (1, 0): -1}
    corners = tuple(
        CeramicPatch(x * 26e-3, y * 12e-3, 4e-3, 4e-3, 0.5e-3, sign)  # type: ignore[arg-type]
        for (x, y), sign in signs.items()
    )
    middle = CeramicPatch(13e-3, 6e-3, 4e-3, 4e-3, 0.5e-3)
    plate = dataclasses.replace(strips(1), patches=(*corners, middle))
    assert drive_classes(plate) == [("S", "S"), ("A", "A")]
    found = screened_modes(plate, (20e3, 60e3))
    assert {mode.parity for mode in found} == {("S", "S"), ("A", "A")}
    assert harmonic_response(plate, np.array([30e3]), resolution=SCREENING).maximum[0] > 0


def test_classes_have_words() -> None:
    assert symmetry_in_words(("S", "A")) == "even along length, odd along width"
    assert "no mirror along width" in symmetry_in_words(("S", None))


def test_an_antinode_lies_inside_the_face() -> None:
    x, y = np.linspace(-1, 1, 41)[:, None], np.linspace(-1, 1, 31)[None, :]
    bump = 0.4 * np.exp(-20 * (x**2 + y**2)) + 0 * y
    assert antinode(bump + 0.0) == pytest.approx(0.4)
    # Higher at the edge, where no finger is: the bump counts all the same.
    assert antinode(bump - 0.9 * (np.abs(x) > 0.95)) == pytest.approx(0.4)
    # A plane has no antinode: then what is largest counts.
    assert antinode(x + 0 * y) == pytest.approx(1.0)


def test_of_straight_nodal_lines_the_largest_lobe_between_them_counts() -> None:
    """The ends move most of a free plate, and lie outside of the outermost nodal line."""
    x = np.linspace(0, 1, 201)
    lobes = np.sin(4 * np.pi * (x - 1 / 8)) * np.where((x < 1 / 8) | (x > 7 / 8), 2.0, 0.7)
    along = np.repeat(lobes[:, None], 31, axis=1)
    assert antinode(along, (4, 0)) == pytest.approx(0.7, rel=1e-3)
    assert antinode(along.T, (0, 4)) == pytest.approx(0.7, rel=1e-3)


def test_a_driven_mode_has_a_name_and_a_bandwidth() -> None:
    mode = DrivenMode(30e3, 60.0, (8, 0), 0.9, ("S", "S"), 1e-7, np.ones((3, 3)))
    assert mode.name == "(8,0)"
    assert mode.moving == ("(8,0)", 30e3, pytest.approx(250.0), 1e-7)
    assert dataclasses.replace(mode, label=None).name == "in plane"


def test_the_neighbour_that_adds_most_need_not_be_the_nearest() -> None:
    own = Moving("(8,0)", 30e3, 250.0, 1e-7)
    near, far = Moving("(6,4)", 30.5e3, 250.0, 1e-9), Moving("in plane", 29e3, 500.0, 5e-8)
    found = strongest_neighbour(own, [near, far])
    assert found is not None
    assert (found.name, found.frequency) == ("in plane", 29e3)
    assert found.distance == pytest.approx(2.0)
    assert found.share == pytest.approx(0.5 / 5**0.5)
    assert strongest_neighbour(own, []) is None


def test_a_space_grown_from_several_forces_holds_the_same_modes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    band = 20e3, 45e3
    alone = screened_modes(plate, band)
    monkeypatch.setattr(resonances, "_LONG", 10)
    together = [mode for mode in screened_modes(plate, band) if mode.alone_per_volt > 1e-12]
    assert len(together) == len(alone)
    for one, other in zip(alone, together, strict=True):
        assert one.label == other.label
        assert one.frequency == pytest.approx(other.frequency, rel=1e-9)
        assert one.alone_per_volt == pytest.approx(other.alone_per_volt, rel=1e-5)


@pytest.mark.slow
def test_a_mode_in_the_plane_crosses_the_papers_and_takes_some_of_its_motion() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    below, at, above = (
        solid_mode(dataclasses.replace(plate, thickness=h)) for h in (1.7e-3, 1.75e-3, 1.8e-3)
    )
    for mode in (below, at, above):
        assert mode.neighbour is not None
        assert mode.neighbour.name == "in plane"
    assert at.neighbour.share > 3 * max(below.neighbour.share, above.neighbour.share)
    # What the mode itself has is less than between its neighbours on the curve.
    between = (below.alone_per_volt + above.alone_per_volt) / 2
    assert at.alone_per_volt < 0.9 * between
    # It is above the mode on the thinner plate and below it on the thicker one.
    assert below.neighbour.frequency > below.frequency
    assert above.neighbour.frequency < above.frequency
