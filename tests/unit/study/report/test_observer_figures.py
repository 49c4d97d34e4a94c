"""Figure of simulated participants: the evidence as tabulated."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import words

from squeezefilm.core.kit.style import BLUE, INK, ORANGE
from squeezefilm.physics.perception.observer import SensoryChannel, load_observer
from squeezefilm.physics.perception.percepts import Apparatus
from squeezefilm.physics.perception.senses import Candidates, line_periods
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.report.observer_figures import percepts
from squeezefilm.study.simulated.chain_tables import ChainTables
from squeezefilm.study.simulated.felt_surfaces import Causes

pytestmark = pytest.mark.usefixtures("figures_as_described")

PAPER = load_design("biet2008-gratings")
DESIGN = dataclasses.replace(
    PAPER, displays=("first plate", "other plate"), stimuli=PAPER.stimuli[1:3],
    alternatives=PAPER.alternatives[1:4],
)  # fmt: skip
CHANNELS = (SensoryChannel("slow", 0.0, 10.0, 20e-9), SensoryChannel("fast", 60.0, 400.0, 0.5e-6))
OBSERVER = dataclasses.replace(
    load_observer(), finger_classes=3, name="somebody", channels=CHANNELS, detection_criterion=1.5
)
PERIODS = line_periods()
# Evidence over (display, finger, stimulus): the other display's second grating is the faintest.
CLEAREST = np.array([[[6.0, 8.0], [7.0, 9.0], [5.0, 7.0]], [[4.0, 1.0], [9.0, 0.5], [3.0, 6.0]]])
RHYTHM = CLEAREST[..., None] * np.exp(-(np.log(PERIODS / 2e-3) ** 2))
REAL = np.arange(1.0, 10.0).reshape(3, 3, 1) * np.ones(PERIODS.size)


def why(frequency: float, bandwidth: float) -> Causes:
    return Causes(frequency, bandwidth, *(1.0,) * 8)


def tables(**changes: Any) -> ChainTables:
    found = ChainTables(
        design=DESIGN, observer=OBSERVER, fingers=OBSERVER.fingers(), apparatus=(Apparatus(),) * 2,
        virtual=Candidates(
            np.full((2, 3, 2, 2), 2e-3), np.stack([CLEAREST, np.zeros_like(CLEAREST)], axis=-1)
        ),
        real=Candidates(np.full((3, 3, 1), 2e-3), np.ones((3, 3, 1))),
        virtual_rhythm=RHYTHM, real_rhythm=REAL,
        causes=(
            ((why(40, 100),) * 3, (why(20, 100),) * 3),
            ((why(40, 250),) * 3, (why(20, 250),) * 3),
        ),
    )  # fmt: skip
    return dataclasses.replace(found, **changes)


def test_percepts_have_a_cell_for_each_surface_and_display() -> None:
    figure = percepts(tables())
    cells = np.array(figure.axes).reshape(3, 3)
    titles = [[one.get_title(loc="left") for one in row] for row in cells]
    assert titles == [
        ["first plate: 2 mm", "other plate: 2 mm", "real gratings: 2 mm"],
        ["first plate: 4 mm", "other plate: 4 mm", "real gratings: 4 mm"],
        ["", "", "real gratings: 8 mm"],
    ]
    # Three real gratings beside two virtual ones: what is left over is empty.
    assert [[one.axison for one in row] for row in cells] == [
        [True] * 3, [True] * 3, [False, False, True],
    ]  # fmt: skip
    for row, period in enumerate((2, 4, 8)):
        for column, color in enumerate((BLUE, ORANGE, INK)):
            cell = cells[row, column]
            if not cell.axison:
                continue
            *fingers, median, criterion, true = cell.get_lines()
            found = RHYTHM[column, :, row] if column < 2 else REAL[:, row]
            assert len(fingers) == 3
            for line, values in zip(fingers, found, strict=True):
                assert line.get_xdata() == pytest.approx(1e3 * PERIODS)
                assert line.get_ydata() == pytest.approx(values)
                assert to_hex(line.get_color()) == color
            assert median.get_ydata() == pytest.approx(np.sort(found, axis=0)[1])
            assert criterion.get_ydata() == [1.5, 1.5]
            assert true.get_xdata() == pytest.approx([period, period])
            assert cell.get_xscale() == "log"
            assert cell.get_xlim() == pytest.approx((0.25, 20))
    # Displays share one scale, so that their evidence can be compared.
    for cell in cells[:2, :2].flat:
        assert cell.get_ylim() == pytest.approx((0, 1.15 * 9))
    assert cells[0, 2].get_ylim()[0] == 0
    assert cells[0, 2].get_ylim()[1] < 1.15 * 9
    labels = [[one.get_xlabel() for one in row] for row in cells]
    assert labels == [[""] * 3, [""] * 3, ["spatial period (mm)"] * 3]
    assert figure.get_supylabel() == "evidence for a rhythm, d′"
    ticks = [one.get_text() for one in cells[2, 2].get_xticklabels()]
    assert ticks == ["0.4", "1", "2", "4", "10"]
    assert figure.get_figheight() == pytest.approx(1.4 + 2 * 1.15)


def test_the_faintest_is_named_by_its_median_finger() -> None:
    title = words(percepts(tables()).get_suptitle())
    assert title == "Least evident: 4 mm on other plate, d′ = 1.00 at its clearest rhythm"


def test_evidence_below_none_is_none_and_the_criterion_is_always_in_sight() -> None:
    nothing = Candidates(np.full((2, 3, 2, 1), 2e-3), np.full((2, 3, 2, 1), -2.0))
    figure = percepts(tables(virtual=nothing))
    assert "Least evident: 2 mm on first plate, d′ = 0.00" in words(figure.get_suptitle())
    assert figure.axes[0].get_ylim() == pytest.approx((0, 1.15 * 1.5))
