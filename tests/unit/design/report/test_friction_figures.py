"""Figures of a friction: every curve, band and mark lies where the numbers are, and says so."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import labelled, words

from squeezefilm.core.distributions import Uniform
from squeezefilm.core.kit import style
from squeezefilm.core.kit.style import BLUE, GREEN, ORANGE
from squeezefilm.core.quantities import Unit
from squeezefilm.design.analysis.curves import ModelCurve
from squeezefilm.design.friction import FrictionMap
from squeezefilm.design.report.friction import (
    friction_map,
    models,
    predictions,
    ripple,
    uncertainty,
    write_friction,
)
from squeezefilm.physics.chain.friction import FrictionLaw, friction_law
from squeezefilm.physics.contact.sharing.pad import FrictionRipple
from squeezefilm.physics.display import load_display
from squeezefilm.physics.uncertainty.draws import Refusals
from squeezefilm.physics.uncertainty.intervals import Influence
from squeezefilm.physics.uncertainty.parameters import Knowledge, Parameter
from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

pytestmark = pytest.mark.usefixtures("figures_as_described")

AMPLITUDE = "vibration amplitude, zero-to-peak (µm)"
FRICTION = "relative friction µ′/µ"
FINE, COARSE = np.linspace(0, 4e-6, 9), np.array([0.0, 4e-6])
PATHS = (
    "finger.asperities.reference_gap", "surfaces.0.roughness", "gas.dynamic_viscosity",
    "actuator.ceramic.young_modulus", "skin_compliance", "finger.asperities.decay_length",
    "finger.plateau_width", "finger.contact_length", "actuator.quality_factor",
)  # fmt: skip
POINT: Any = SimpleNamespace(
    vibration_amplitude=1.5e-6,
    relative_friction=0.62,
    normal_force=0.4,
    model="partial-levitation",
    surface=SimpleNamespace(name="glass"),
)


def curve(model: Any, amplitude: np.ndarray, slope: float) -> ModelCurve:
    return ModelCurve(model, amplitude, 1 - slope * amplitude / 4e-6)


CURVES = (
    curve("paper2008", FINE, 0.9),
    curve("levitation-2016", COARSE, 0.8),
    curve("partial-levitation", FINE, 0.4),
)


def influence(number: int, path: str) -> Influence:
    # The last ones are of no influence, and estimated a little below none.
    known: Knowledge = "unknown" if path == "skin_compliance" else "measurable"
    parameter = Parameter(path, 1.0, Unit("1"), Uniform(0.5, 1.5), "assumed", "test", known)
    total = 0.5 - 0.1 * number if number < 5 else -0.01
    return Influence(parameter, 0.5 * total, 0.01, total, 0.02 + 0.01 * number)


UNSURE = UncertainFriction(
    nominal=0.62, median=0.6, interval=(0.41, 0.83), level=0.9,
    samples=np.array([0.01, 0.41, 0.43, 0.83, 0.99]), amplitudes=np.full(5, 1.5e-6), draws=5,
    influences=tuple(influence(number, path) for number, path in enumerate(PATHS)),
    groups=(), refused=Refusals(77), seed=1,
    model="a model of nothing",
)  # fmt: skip
FORCES = np.geomspace(0.04, 1.6, 5)
COLUMNS = np.linspace(0, 3e-6, 7)
FIELD = np.tile(1 - COLUMNS / 3e-6, (5, 1))
FIELD[4, 6] = np.nan
MAP = FrictionMap(COLUMNS, FORCES, FIELD, "the model of the map")
RIPPLE = FrictionRipple(np.array([0.0, 2e-3, 4e-3]), np.array([0.5, 0.6, 0.7]), 10e-3, 6e-3)
RESULT: Any = SimpleNamespace(
    curves=CURVES, prediction=POINT, uncertainty=UNSURE, map=MAP, ripple=RIPPLE,
    summary=lambda: {"display": "µ"},
)  # fmt: skip


def without(**changes: Any) -> Any:
    return SimpleNamespace(**{**vars(RESULT), **changes})


def test_every_model_is_drawn_in_its_own_way() -> None:
    axes = models(RESULT).axes[0]
    lines = labelled(axes)
    expected = {
        "paper's asymptote": (ORANGE, 0.9),
        "levitation, as published in 2016": (GREEN, 0.8),
        "partial levitation": (BLUE, 0.4),
    }
    for name, (color, slope) in expected.items():
        line = lines[name]
        assert to_hex(line.get_color()) == color
        assert line.get_ydata() == pytest.approx(1 - slope * line.get_xdata() / 4)
    # The model of the prediction stands out.
    widths = {name: lines[name].get_linewidth() for name in expected}
    assert max(widths, key=lambda name: widths[name]) == "partial levitation"
    assert len(lines) == 4
    assert axes.get_xlim() == pytest.approx((0, 4))
    assert axes.get_ylim() == (0, 1.04)
    assert (axes.get_xlabel(), axes.get_ylabel()) == (AMPLITUDE, FRICTION)
    assert axes.get_legend() is not None


def test_the_curve_is_drawn_that_the_working_point_is_on() -> None:
    point = SimpleNamespace(**{**vars(POINT), "model": "levitation-ridges", "speed": 0.08})
    curves = (*CURVES, curve("levitation-ridges", FINE, 0.5))
    figure = models(without(curves=curves, prediction=point))
    line = labelled(figure.axes[0])["levitation, films over single ridges, at 80 mm/s"]
    assert line.get_ydata() == pytest.approx(1 - 0.5 * np.linspace(0, 1, 9))
    assert words(ripple(without(prediction=point)).get_supxlabel()).startswith(
        "Model: levitation-ridges, ridge by ridge"
    )


def test_the_working_point_stands_on_its_interval() -> None:
    axes = models(RESULT).axes[0]
    label = "this display, partial-levitation: 0.62 (0.41–0.83, 90 %, median 0.60)"
    point = labelled(axes)[label]
    assert point.get_xydata().tolist() == [[pytest.approx(1.5), 0.62]]
    others = [one for one in axes.get_lines() if one.get_label().startswith("_")]
    assert [one.get_ydata().tolist() for one in others] == [[0.41, 0.83], [0.41], [0.83]]
    assert all(one.get_xdata() == pytest.approx(1.5) for one in others)
    figure = models(RESULT)
    assert words(figure.get_suptitle()) == (
        "At 1.5 µm on glass µ′/µ = 0.62 as described (0.41–0.83, median 0.60): the model decides; "
        "two are fitted to measured curves"
    )
    assert words(figure.get_supxlabel()) == "Model: as in the legend; 0.4 N"


def test_without_an_interval_the_point_stands_alone() -> None:
    figure = models(without(uncertainty=None))
    axes = figure.axes[0]
    assert "this display, partial-levitation: 0.62" in labelled(axes)
    assert len(axes.get_lines()) == 4
    assert "on glass µ′/µ = 0.62: the model decides" in words(figure.get_suptitle())


@pytest.fixture(scope="module")
def law() -> FrictionLaw:
    return friction_law(load_display("biet2008-stator"), 10e-3, 40e3, model="paper2008")


def prediction(law: FrictionLaw, amplitude: float, friction: float) -> Any:
    return SimpleNamespace(
        law=law, vibration_amplitude=amplitude, relative_friction=friction, model=law.model
    )


def test_predictions_share_the_curve_of_their_law_up_to_the_highest(law: FrictionLaw) -> None:
    harder = dataclasses.replace(law, normal_force=2 * law.normal_force)
    found = [
        prediction(law, 1e-6, law.at(1e-6)),
        prediction(law, 2e-6, law.at(2e-6)),
        prediction(harder, 0.1e-6, harder.at(0.1e-6)),
    ]
    figure = predictions(found)
    axes = figure.axes[0]
    first, second, *points = axes.get_lines()
    assert to_hex(first.get_color()) == BLUE
    assert to_hex(second.get_color()) == ORANGE
    assert first.get_xdata()[[0, -1]] == pytest.approx([0, 2])
    # A small amplitude still gets half a micrometre of its curve.
    assert second.get_xdata()[[0, -1]] == pytest.approx([0, 0.5])
    for line, one in ((first, law), (second, harder)):
        assert line.get_ydata() == pytest.approx(one.curve(1e-6 * line.get_xdata()), abs=1e-9)
    for mark, one in zip(points, found, strict=True):
        assert mark.get_xdata() == pytest.approx([1e6 * one.vibration_amplitude])
        assert mark.get_ydata() == [one.relative_friction]
    frictions = [one.relative_friction for one in found]
    assert words(figure.get_suptitle()) == (
        f"3 predictions: µ′/µ from {min(frictions):.2f} to {max(frictions):.2f}"
    )
    assert figure.get_supxlabel() == "Model: paper2008"
    assert axes.get_xlim()[0] == 0
    assert axes.get_ylim() == (0, 1.04)
    assert (axes.get_xlabel(), axes.get_ylabel()) == (AMPLITUDE, FRICTION)


def test_one_prediction_is_told_with_its_amplitude(law: FrictionLaw) -> None:
    title = predictions([prediction(law, 1e-6, 0.875)]).get_suptitle()
    assert words(title) == "µ′/µ = 0.88 at 1 µm"


def test_the_map_has_amplitude_across_and_force_up() -> None:
    figure = friction_map(RESULT)
    axes, bar = figure.axes
    filled, lines = axes.collections[:2]
    assert filled.levels == pytest.approx(np.linspace(0, 1, 11))
    assert lines.levels == pytest.approx([0.1, 0.3, 0.5, 0.7, 0.9])
    # The field falls evenly with the amplitude alone: a line of equal friction stands upright.
    for level, path in zip(lines.levels[1:], lines.get_paths()[1:], strict=True):
        assert path.vertices[:, 0] == pytest.approx(3 * (1 - level))
        assert path.vertices[:, 1].min() == pytest.approx(0.04)
        assert path.vertices[:, 1].max() == pytest.approx(1.6)
    point = labelled(axes)["this display"]
    assert point.get_xydata() == pytest.approx(np.array([[1.5, 0.4]]))
    assert axes.get_yscale() == "log"
    assert (axes.get_xlabel(), axes.get_ylabel()) == (AMPLITUDE, "normal force (N)")
    assert bar.get_ylabel() == FRICTION
    assert words(figure.get_suptitle()) == (
        "µ′/µ is 0.62 at 1.5 µm and 0.4 N; over these ranges it goes from 0.00 to 1.00"
    )
    assert figure.get_supxlabel() == "Model: the model of the map"
    assert {one.get_text() for one in axes.texts} >= {"0.5", "0.7"}


def test_samples_are_counted_beside_their_interval() -> None:
    figure = uncertainty(RESULT)
    left = figure.axes[0]
    bars = left.containers[0]
    heights = np.zeros(24)
    heights[[0, 9, 10, 19, 23]] = 1
    assert bars.datavalues.tolist() == heights.tolist()
    marks = labelled(left)
    assert marks["as described: 0.62"].get_xdata() == [0.62, 0.62]
    assert marks["median: 0.60"].get_xdata() == [0.6, 0.6]
    box = marks["90 % interval"].get_extents().transformed(left.transData.inverted())
    assert (box.x0, box.x1) == pytest.approx((0.41, 0.83))
    assert left.get_xlim() == (0, 1)
    assert (left.get_xlabel(), left.get_ylabel()) == (FRICTION, "draws")
    assert words(figure.get_suptitle()) == (
        "µ′/µ = 0.62 as described (0.41–0.83, median 0.60); to know it better, measure the gap of "
        "the asperities"
    )
    assert figure.get_supxlabel() == "Model: a model of nothing, 77 draws"


def test_the_eight_most_important_parameters_are_ranked_from_above() -> None:
    right = uncertainty(RESULT).axes[1]
    assert [one.get_text() for one in right.get_yticklabels()][::-1] == [
        "gap of the asperities", "roughness of the surface", "dynamic viscosity",
        "ceramic.young modulus", "softness of the pad", "decay length of the asperities",
        "width of a ridge's plateau", "length of the contact",
    ]  # fmt: skip
    known, unknown = (labelled(right)[name] for name in ("could be measured", "nobody knows"))
    shares = np.array([50, 40, 30, 20, 10, 0, 0, 0])
    rows = {
        round(bar.get_y() + bar.get_height() / 2): bar.get_width()
        for group in (known, unknown)
        for bar in group
    }
    assert [rows[k] for k in range(8)][::-1] == pytest.approx(shares)
    # The softness of the pad is the fifth, and nobody knows it.
    assert [bar.get_width() for bar in unknown] == pytest.approx([10])
    (segments,) = known.errorbar.lines[2]
    ends = np.array([part[:, 0] for part in segments.get_segments()])[::-1]
    assert 0.5 * np.diff(ends)[:, 0] == pytest.approx([2, 3, 4, 5, 7, 8, 9])
    assert right.get_yticks().tolist() == list(range(8))
    assert right.get_xlabel() == "share of the variance of µ′/µ (%)"
    assert right.get_xlim()[0] == 0


def test_the_ripple_goes_over_two_half_waves_and_ends_as_it_began() -> None:
    figure = ripple(RESULT)
    axes = figure.axes[0]
    curve_, mean, *nodes = axes.get_lines()
    assert curve_.get_xdata() == pytest.approx([0, 2, 4, 6, 8, 10, 12])
    assert curve_.get_ydata() == pytest.approx([0.5, 0.6, 0.7, 0.5, 0.6, 0.7, 0.5])
    assert mean.get_ydata() == pytest.approx([0.6, 0.6])
    # x = 0 is an antinode, so nodes lie a quarter and three quarters of the wave away.
    assert [one.get_xdata()[0] for one in nodes] == pytest.approx([3, 9])
    assert list(labelled(axes)) == [
        "relative friction of the whole pad", "mean 0.60", "nodal lines",
    ]  # fmt: skip
    assert axes.get_xlim() == pytest.approx((0, 12))
    assert axes.get_ylim() == (0, 1.04)
    assert axes.get_xlabel() == "centre of the pad, from an antinode (mm)"
    assert words(figure.get_suptitle()) == (
        "The wave itself is felt: 33 % of ripple every 6 mm under a contact of 10 mm"
    )


def test_numbers_and_pictures_are_written_each_under_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A picture of its title: which goes where is what counts, and PNGs are slow.
    monkeypatch.setattr(style, "png", lambda one: words(one.get_suptitle()).encode())
    assert write_friction(RESULT, tmp_path / "all") == tmp_path / "all"
    said = {one.name: one.read_text(encoding="utf-8") for one in (tmp_path / "all").iterdir()}
    data = said.pop("friction.json")
    for name, drawing in (
        ("models", models), ("map", friction_map), ("uncertainty", uncertainty), ("ripple", ripple),
    ):  # fmt: skip
        assert said.pop(f"friction-{name}.png") == words(drawing(RESULT).get_suptitle())
    assert not said
    assert '"µ"' in data
    assert data.endswith("}\n")
    found = json.loads(data)["map"]
    assert found["vibration_amplitude_m"] == COLUMNS.tolist()
    assert found["normal_force_N"] == FORCES.tolist()
    assert found["relative_friction"][0] == FIELD[0].tolist()
    assert found["relative_friction"][4][5:] == [FIELD[4, 5], None]


def test_what_was_not_computed_gets_no_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(style, "png", lambda _: b"")
    write_friction(without(uncertainty=None, ripple=None), tmp_path)
    assert sorted(one.name for one in tmp_path.iterdir()) == [
        "friction-map.png", "friction-models.png", "friction.json",
    ]  # fmt: skip
    with pytest.raises(AssertionError, match="asked without samples"):
        uncertainty(without(uncertainty=None))
    with pytest.raises(AssertionError, match="nothing vibrates"):
        ripple(without(ripple=None))
