"""What speaks against a working mode, and that nothing good stands on one that is not driven."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import GeometryError
from squeezefilm.design.analysis.verdict import Finding, held_back, verdict
from squeezefilm.design.plate import listed_modes as room
from squeezefilm.design.plate.listed_modes import ListedMode, mode_doubts, why_undriven
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.solid.resonances import Neighbour
from squeezefilm.physics.plate.working_mode import WorkingMode, working_mode

from .test_modes import PAPER, five_strips, row


def mode(
    label: str,
    frequency: float = 30e3,
    own: float = 1.0,
    beside: Neighbour | None = None,
    **changes: Any,
) -> WorkingMode:
    """A working mode that has the share `own` of what moves at its antinode, and a neighbour."""
    lines = tuple(int(n) for n in label.strip("()").split(","))
    solid = SimpleNamespace(
        alone_per_volt=own * 1e-7,
        amplitude_per_volt=1e-7,
        index=0,
        neighbour=beside,
        modes=SimpleNamespace(labels=(lines,)),
        response=SimpleNamespace(settled_modes=lambda band: ()),
    )
    one = WorkingMode(
        label,
        frequency,
        11e-3,
        60.0,
        1e-7,
        "a model",
        (0.0, 0.0),
        solid=solid,  # type: ignore[arg-type]
    )
    return dataclasses.replace(one, **changes)


def near(monkeypatch: pytest.MonkeyPatch, *modes: ListedMode) -> None:
    """Let these modes be what is driven."""
    monkeypatch.setattr(room, "_screened", lambda plate, where: modes)
    monkeypatch.setattr(room, "listed_modes", lambda settled: modes)


def test_a_mode_alone_is_not_doubted(monkeypatch: pytest.MonkeyPatch) -> None:
    near(monkeypatch, row("(8,0)", 30e3, 1e-7))
    assert list(mode_doubts(PAPER, mode("(8,0)"))) == []


def test_an_undriven_mode_is_named_with_the_symmetry_and_another(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    near(monkeypatch, row("(6,0)", 25e3, 1e-7))
    (doubt,) = mode_doubts(five_strips(5), mode("(5,0)"))
    assert "(5,0) is not driven: symmetry forbids (5,0)" in doubt
    assert "Write nodal_lines = 6" in doubt
    near(monkeypatch)
    (doubt,) = mode_doubts(five_strips(5), mode("(5,0)"))
    assert doubt.endswith("squeezefilm modes lists what is driven.")


@pytest.mark.parametrize(("own", "doubted"), [(0.45, True), (0.55, False)])
def test_a_mode_that_its_neighbours_move_is_hardly_driven(own: float, doubted: bool) -> None:
    said = why_undriven(PAPER, mode("(8,0)", own=own))
    assert (said is not None) == doubted
    if said is not None:
        assert "hardly driven: of 100 nm/V" in said


def test_people_hear_what_is_below_20_kHz(monkeypatch: pytest.MonkeyPatch) -> None:
    near(monkeypatch)
    (doubt,) = mode_doubts(PAPER, mode("(8,0)", 19.9e3))
    assert "19.9 kHz" in doubt
    assert list(mode_doubts(PAPER, mode("(8,0)", 20.1e3))) == []
    stator = load_display("biet2008-stator")
    (doubt,) = mode_doubts(stator, mode("(0,9)", 10.8e3, solid=None))
    assert "(0,9) is audible" in doubt


def test_company_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    crowd = row("(8,0)", 30e3, 1e-7, neighbour="(6,4)", neighbour_share=0.3, neighbour_distance=1.5)
    near(monkeypatch, crowd)
    # A beam has no neighbours of its own; of a solved plate they are taken from its solution.
    (doubt,) = mode_doubts(PAPER, mode("(8,0)", solid=None))
    assert "(6,4) lies 1.5 half-bandwidths away (by screening) and adds about 30 %" in doubt
    assert list(mode_doubts(PAPER, mode("(8,0)", beside=Neighbour("(6,4)", 31e3, 4.0, 0.19)))) == []
    solved = mode("(8,0)", beside=Neighbour("in plane", 31.1e3, 1.15, 0.25))
    (doubt,) = mode_doubts(PAPER, solved)
    assert doubt == solved.company
    assert "the mode in plane at 31.1 kHz lies 1.1 half-bandwidths away and adds 25 %" in doubt
    # A mode that the drive hardly moves.
    idle = mode("(8,0)", beside=Neighbour("(8,1)", 31e3, 4.0, 2.9e7)).company
    assert idle is not None
    assert idle.startswith("(8,0) is hidden: the mode (8,1)")
    near(monkeypatch, row("(8,0)", 30e3, 1e-7), row("(8,0)", 31e3, 2e-8))
    (doubt,) = mode_doubts(PAPER, mode("(8,0)"))
    assert "2 modes near have the label (8,0), at 30 kHz (100 nm/V) and 31 kHz" in doubt
    assert "write working_frequency" in doubt
    # Who chose by frequency knows.
    chosen = dataclasses.replace(PAPER.actuator, working_frequency=30e3)  # type: ignore[type-var]
    assert list(mode_doubts(dataclasses.replace(PAPER, actuator=chosen), mode("(8,0)"))) == []


def test_a_mode_chosen_by_frequency_that_has_other_lines_says_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    near(monkeypatch)
    other = mode("(8,0)")
    other.solid.modes.labels = ((6, 4),)  # type: ignore[union-attr,misc]
    (doubt,) = mode_doubts(PAPER, other)
    assert "has nodal lines (6,4) and not (8,0)" in doubt
    other.solid.modes.labels = (None,)  # type: ignore[union-attr,misc]
    (doubt,) = mode_doubts(PAPER, other)
    assert "moves in its plane" in doubt


@pytest.mark.slow
def test_the_papers_plate_is_not_doubted() -> None:
    assert list(mode_doubts(PAPER, working_mode(PAPER.actuator))) == []


def test_good_is_taken_back_where_the_mode_is_not_driven() -> None:
    good, limit = Finding("good", "Fine."), Finding("limit", "Not fine.")
    assert held_back(good, None) is good
    assert held_back(limit, "Undriven.") is limit
    assert held_back(good, "Undriven.") == Finding("limit", "Fine. Undriven.")


@pytest.mark.slow
def test_five_symmetric_strips_with_five_lines_get_no_good_line() -> None:
    from squeezefilm.design.analysis.analyze import analyze

    found = analyze(five_strips(5), samples=0).verdict
    assert any(one.kind == "doubt" and "not driven" in one.text for one in found)
    assert not any(finding.kind == "good" for finding in found)


def test_an_amplitude_that_is_given_needs_no_mode() -> None:
    display = load_display("biet2008-stator")
    p = predict(display, vibration_amplitude=2e-6)
    quiet = dataclasses.replace(p, mode=dataclasses.replace(p.mode, resonance_frequency=10e3))
    curve: Any = SimpleNamespace(amplitude_for_criterion=None)
    texts = [one.text for one in verdict(display, quiet, None, curve, None)]
    assert not any("audible" in text for text in texts)


def test_a_plate_that_cannot_be_screened_lists_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> object:
        raise GeometryError("too thin")

    monkeypatch.setattr(room, "screened_modes", refused)
    plate: Any = None
    assert room._screened(plate, (1e3, 2e3)) == ()
