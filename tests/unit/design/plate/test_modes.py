"""The list of driven modes: neighbours, labels, the suggestion; what a ring's one channel does."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import pytest

from squeezefilm.design.plate.listed_modes import (
    CROWDED,
    DRIVEN_SHARE,
    HEARING,
    ListedMode,
    chosen,
    suggested,
    with_neighbours,
)
from squeezefilm.design.plate.modes import ModeList, list_modes
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate

PAPER = load_display("biet2008-plate")


def row(label: str, frequency: float, per_volt: float, **changes: Any) -> ListedMode:
    """A mode of Q 50: half-bandwidths of a hundredth of the frequency."""
    one = ListedMode(
        label, frequency, 50.0, per_volt, "", frequency < HEARING, None, None, 0.0, True,
        0.9, f"nodal_lines = {label[1]}",
    )  # fmt: skip
    return dataclasses.replace(one, **changes)


@pytest.fixture(scope="module")
def paper() -> ModeList:
    return list_modes(PAPER)


def five_strips(lines: int) -> Display:
    """The paper's plate with five strips of alternating sign, which are their own mirror image."""
    plate = PAPER.actuator
    assert isinstance(plate, RectangularPlate)
    first = plate.patches[0]
    strips = tuple(
        dataclasses.replace(first, x=3.5e-3 + 16e-3 * k, length=12e-3, polarity=(-1) ** k)  # type: ignore[arg-type]
        for k in range(5)
    )
    changed = dataclasses.replace(plate, patches=strips, nodal_lines=lines)
    return dataclasses.replace(PAPER, actuator=changed)


def test_a_neighbour_counts_by_its_own_bandwidth() -> None:
    low, high = with_neighbours([row("(8,0)", 30e3, 1e-7), row("(6,2)", 31e3, 2e-7)])
    # 1 kHz is 3.23 half-bandwidths of 310 Hz, and 3.33 of 300 Hz.
    assert low.neighbour == "(6,2)"
    assert low.neighbour_distance == pytest.approx(1000 / 310)
    assert low.neighbour_share == pytest.approx(2 / math.hypot(1, 1000 / 310))
    assert high.neighbour_distance == pytest.approx(1000 / 300)
    assert low.crowded
    assert not low.hidden
    assert high.neighbour_share == pytest.approx(0.5 / math.hypot(1, 1000 / 300))
    assert not high.crowded
    (alone,) = with_neighbours([row("(8,0)", 30e3, 1e-7)])
    assert alone.neighbour is None
    assert not alone.crowded


def test_a_label_is_unique_unless_a_strong_one_has_it_too() -> None:
    strong, weak = with_neighbours([row("(8,0)", 30e3, 1e-7), row("(8,0)", 40e3, 0.9e-8)])
    assert strong.unique
    assert not weak.unique
    both = with_neighbours([row("(8,0)", 30e3, 1e-7), row("(8,0)", 40e3, 1.1e-8)])
    assert not any(mode.unique for mode in both)
    in_plane = with_neighbours([row("in plane", 30e3, 1e-7), row("in plane", 40e3, 1e-7)])
    assert all(mode.unique for mode in in_plane)


def test_of_one_label_the_strongest_is_meant_or_the_one_nearest() -> None:
    modes = [row("(8,0)", 30e3, 1e-7), row("(8,0)", 40e3, 2e-7), row("(9,0)", 35e3, 3e-7)]
    assert chosen(modes, "(8,0)") is modes[1]
    assert chosen(modes, "(8,0)", 31e3) is modes[0]
    assert chosen(modes, "(7,0)") is None


@pytest.mark.parametrize("share", [1e-12, 0.9 * DRIVEN_SHARE])
def test_a_mode_that_the_drive_cannot_move_is_never_suggested(share: float) -> None:
    strong = row("in plane", 36e3, 4.5e-10, choice=None)
    vanishing = row("(6,0)", 30e3, share * strong.alone_per_volt)
    assert suggested(with_neighbours([strong, vanishing])).mode is None
    driven = row("(6,0)", 30e3, 1.1 * DRIVEN_SHARE * strong.alone_per_volt)
    assert suggested([strong, driven]).mode is driven
    assert suggested([row("(6,0)", 30e3, 0.0)]).mode is None


def test_the_suggestion_is_inaudible_straight_and_moves_most() -> None:
    modes = [
        row("(6,0)", 18e3, 9e-7),
        row("(7,0)", 26e3, 3e-7, straightness=0.4),
        row("(6,2)", 27e3, 4e-7, choice=None),
        row("(8,0)", 30e3, 1e-7),
        row("(9,0)", 40e3, 1.5e-7, neighbour="(2,6)", neighbour_share=0.4, neighbour_distance=1.0),
    ]
    best = suggested(modes)
    # 1.5e-7 with 40 % of a neighbour in it is worth less than 1e-7 alone.
    assert best.mode is modes[3]
    assert best.text.startswith("Write nodal_lines = 8: at 30 kHz (8,0)")
    assert "of 2 such modes" in best.text
    # What may be audible for all that was screened is not advised, however far it moves.
    doubtful = row("(6,0)", 20.5e3, 9e-7, perhaps_audible=True)
    assert suggested([doubtful, *modes]).text == best.text
    # What the file has already need not be written.
    kept = suggested(modes, modes[3])
    assert kept.text.startswith("Keep nodal_lines = 8, as described: at 30 kHz (8,0)")
    assert suggested(modes, modes[4]).text == best.text
    nothing = suggested(modes[:3])
    assert nothing.mode is None
    assert "none can be suggested" in nothing.text
    assert "crowded" not in best.text
    close = dataclasses.replace(modes[3], neighbour_share=0.3)
    assert "It is crowded all the same" in suggested([close]).text
    twice = suggested([dataclasses.replace(modes[3], unique=False)])
    assert 'working_frequency = "30 kHz"' in twice.text


def test_the_papers_plate_works_in_the_mode_that_is_suggested(paper: ModeList) -> None:
    own = paper.working_mode
    assert own is not None
    assert own is paper.suggestion.mode
    assert own.label == paper.working == "(8,0)"
    assert own.frequency == pytest.approx(33574, rel=0.02)
    assert own.neighbour_share < CROWDED
    assert paper.forbidden is None
    assert len(paper.rules) == 2
    assert all("odd" in rule for rule in paper.rules)
    assert all(mode.symmetry == "even along length, even along width" for mode in paper.modes)
    assert [mode.frequency for mode in paper.modes] == sorted(m.frequency for m in paper.modes)
    assert len(paper.screened) == len(paper.modes)
    summary = json.loads(json.dumps(paper.summary()))
    assert summary["working_mode"]["frequency_Hz"] == own.frequency
    assert summary["modes"][0]["audible"] is True
    assert len(paper._table()) == len(paper.modes)


@pytest.mark.slow
def test_a_mode_that_symmetry_forbids_is_named_and_not_listed() -> None:
    found = list_modes(five_strips(5), (18e3, 40e3))
    assert found.working == "(5,0)"
    assert found.forbidden is not None
    assert "odd number" in found.forbidden
    assert found.working_mode is None
    assert all(label.startswith(("in", "(")) for label in {m.label for m in found.modes})
    assert not any(mode.label == "(5,0)" for mode in found.modes)
    assert list_modes(five_strips(6), (18e3, 40e3)).forbidden is None


def with_diameters() -> Display:
    """The T-PaD's disc in B(0,3), driven by two of its six sectors."""
    display = load_display("winfield2007-tpad")
    disc = display.actuator
    assert isinstance(disc, DiscPlate)
    changed = dataclasses.replace(disc, nodal_circles=0, nodal_diameters=3, sectors=2)
    return dataclasses.replace(display, actuator=changed)


def test_a_disc_without_diameters_has_no_pair() -> None:
    found = list_modes(load_display("winfield2007-tpad"), (20e3, 30e3))
    assert found.pair is None
    assert found.working_mode is not None
    assert found.suggestion.text.startswith("Keep nodal_circles = 1, nodal_diameters = 0")


@pytest.mark.slow
def test_one_channel_carries_no_finger_and_an_uneven_ring_may() -> None:
    found = list_modes(with_diameters(), (30e3, 36e3))
    pair = found.pair
    assert pair is not None
    assert pair.label == found.working == "B(0,3)"
    assert [at.half_bandwidths for at in pair.splits] == pytest.approx([0.1, 0.5, 2.0])
    assert pair.splits[-1].crest_speed == pytest.approx(pair.two_channels / 2)
    assert pair.splits[-1].standing_wave_ratio == pytest.approx(1.0)
    assert "carry no finger along" in " ".join(pair.sentences)
