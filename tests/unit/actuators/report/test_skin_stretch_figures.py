"""Figures of a skin-stretch array: load lines meet at its tip, and what slips is drawn apart."""

from __future__ import annotations

import functools
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.report.skin_stretch import (
    crosstalk_figure,
    load_line_figure,
    strain_figure,
)
from squeezefilm.actuators.skin_stretch.array import SkinStretchDescription
from squeezefilm.actuators.skin_stretch.bimorph import loaded_tip, tip_motion
from squeezefilm.actuators.skin_stretch.cradle import seat

pytestmark = pytest.mark.usefixtures("figures_as_described")

FREQUENCIES = np.geomspace(1.0, 1000.0, 20)


@functools.cache
def analysis() -> Any:
    """An analysis of the preset with a wave that is made up and few draws."""
    described = load_actuator("biet2008-skin-stretch")
    assert isinstance(described, SkinStretchDescription)
    array, voltage = described.skin_stretch, 150.0
    skin = array.tissue.under_contactor(*array.cradle.size)
    count = array.cradle.count
    x, y = np.linspace(-7e-3, 7e-3, 8), np.linspace(-4e-3, 4e-3, 5)
    wave = SimpleNamespace(
        period=4.8e-3, edges_x=x, edges_y=y,
        strain=0.01 * np.sin(300 * x[None, :-1, None] + 100 * y[None, None, :-1]),
        displacements=1e-6 * np.arange(count)[None], slips=np.arange(count)[None] % 3 == 0,
    )  # fmt: skip
    intervals = {
        "skin_stiffness_N_per_m": (500.0, 900.0, 1300.0),
        "deflection_on_skin_m": (10e-6, 20e-6, 60e-6),
        "force_on_skin_N": (0.01, 0.02, 0.06),
    }
    return SimpleNamespace(
        array=array, voltage=voltage, skin=skin, tip=loaded_tip(array.bender, skin, voltage),
        frequencies=FREQUENCIES, motion=tip_motion(array.bender, skin, voltage, FREQUENCIES),
        free_deflection=voltage * array.bender.deflection_per_volt,
        blocked_force=voltage * array.bender.force_per_volt,
        seating=seat(array.cradle, array.finger, array.tissue, array.normal_force),
        wave=wave, drawn=SimpleNamespace(intervals=intervals),
    )  # fmt: skip


def test_the_load_lines_meet_where_the_tip_is() -> None:
    found = analysis()
    left, right = load_line_figure(found).axes
    (x,), (y,) = next(line for line in left.lines if line.get_marker() == "o").get_data()
    actuator, skin = left.lines[:2]
    assert np.interp(x, *actuator.get_data()) == pytest.approx(y)
    assert np.interp(x, *skin.get_data()) == pytest.approx(y)
    assert np.abs(found.motion) * 1e6 == pytest.approx(right.lines[0].get_ydata())
    none = SimpleNamespace(**{**vars(found), "drawn": SimpleNamespace(intervals={})})
    assert not load_line_figure(none).axes[0].collections


def test_what_slips_is_drawn_apart_from_what_sticks() -> None:
    found = analysis()
    _, contactors, _ = strain_figure(found).axes
    counts = {line.get_label(): len(line.get_xdata()) for line in contactors.lines}
    assert counts == {"sticks": 40, "slips": 20}


def test_crosstalk_is_of_neighbours_along_the_pull_and_elsewhere() -> None:
    found = analysis()
    left, _, _ = crosstalk_figure(found).axes
    along, elsewhere = (np.array(line.get_data()) for line in left.lines)
    assert along.shape[1] + elsewhere.shape[1] == found.array.cradle.count - 1
    # The worst of all contactors is told and drawn.
    assert elsewhere[1].max() < along[1].max() == pytest.approx(100 * found.array.crosstalk)
    columns = len(set(np.round(found.array.cradle.places[0], 9)))
    assert along.shape[1] == columns - 1
