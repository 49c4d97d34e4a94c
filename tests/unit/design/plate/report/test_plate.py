"""The figures of a solved plate: what is drawn is what the response says, in the units said."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from tests.unit.drawn import labelled, words
from tests.unit.made_results import made_result

from squeezefilm.core.kit import style
from squeezefilm.design.plate.command import PlateAnalysis
from squeezefilm.design.plate.report import page
from squeezefilm.design.plate.report.figures import (
    PLATE_FIGURES,
    admittance,
    driven_shape,
    frequency_response,
    line_scan,
    plan_view,
)
from squeezefilm.design.plate.report.page import write_mode, write_plate

pytestmark = pytest.mark.usefixtures("figures_as_described")

LENGTH, WIDTH = 80e-3, 50e-3
PHASE = np.exp(2.5j)
NODES = np.array([10e-3, 30e-3, 50e-3, 70e-3])  # of cos(4πx/L)
FREQUENCIES = np.linspace(29e3, 31e3, 401)


@dataclasses.dataclass
class Response:
    """Four nodal lines across one side, 100 nm/V at its far end and half as far on the edges of
    the other side, with a little that lags a quarter of a period; it moves most at 30 kHz."""

    across_width: bool = False
    resonance: int = 200
    model: str = "a-model"
    method: str = "a-method"
    truncation_error: float = 2e-5
    frequencies: np.ndarray = dataclasses.field(default_factory=lambda: FREQUENCIES)

    def amplitude_at(self, x: float, y: float) -> np.ndarray:
        """A resonance of Q = 100."""
        r = self.frequencies / 30e3
        return 1e-7 / 100 / np.abs(1 - r**2 + 0.01j * r)

    @property
    def admittance(self) -> np.ndarray:
        """A circle of 4 mS on 3 mS of capacitance; its real part is largest at 30 kHz."""
        r = self.frequencies / 30e3
        return 3e-3j + 4e-3 / (1 + 100j * (r - 1 / r))

    def motion(self, at: int, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        assert at == self.resonance
        along, middle = (y / WIDTH, x / LENGTH) if self.across_width else (x / LENGTH, y / WIDTH)
        across = 1 - 0.5 * np.abs(2 * middle - 1)
        lines = np.cos(4 * np.pi * along) * (0.8 + 0.2 * along)
        lag = 0.2j * np.sin(np.pi * along) ** 2  # nothing at the ends
        profile = 1e-7 * PHASE * (lines + lag)
        return across[:, None] * profile if self.across_width else profile[:, None] * across


def true_shape(along: np.ndarray) -> np.ndarray:
    """Along the middle, in nm/V, when the far end stands highest."""
    return 100 * np.cos(4 * np.pi * along) * (0.8 + 0.2 * along)


def solved(label: tuple[int, int] = (4, 0), volts: float = 15.0, **changes: Any) -> Any:
    parts: dict[str, Any] = {
        "plate": SimpleNamespace(length=LENGTH, width=WIDTH),
        "response": Response(label[1] > label[0]), "working_label": label,
        "working": SimpleNamespace(label=f"({label[0]},{label[1]})", frequency=30.01e3),
        "modes": SimpleNamespace(model="solid"), "resonance": 200, "largest_per_volt": 100e-9,
        "mode": SimpleNamespace(amplitude_per_volt=91e-9, lobe=(0.5 * LENGTH, 0.5 * WIDTH)),
        "display": SimpleNamespace(drive=SimpleNamespace(voltage=volts)),
        "summary": lambda: {"mode": "µ"},
    }  # fmt: skip
    return made_result(PlateAnalysis, **{**parts, **changes})


def data(line: Any) -> tuple[np.ndarray, np.ndarray]:
    return np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)


@pytest.mark.parametrize("label", [(4, 0), (0, 4)])
def test_the_shape_is_that_of_the_instant_when_its_largest_point_is_highest(
    label: tuple[int, int],
) -> None:
    x, y = np.linspace(0, LENGTH, 17), np.linspace(0, WIDTH, 9)
    w = driven_shape(solved(label), x, y)
    assert w.shape == (17, 9)
    line = w[:, 4] if label[0] else w[8]
    along = np.linspace(0, 1, line.size)
    # What lags by a quarter of a period is not seen in that instant.
    assert 1e9 * line == pytest.approx(true_shape(along), abs=1e-9)
    assert np.max(w) == np.max(np.abs(w)) == pytest.approx(1e-7)


def test_from_above_colours_and_nodal_lines_are_where_the_motion_is() -> None:
    figure = plan_view(solved())
    assert words(figure.get_suptitle()) == (
        "Mode (4,0) at 30.01 kHz from above: up to 100 nm per volt"
    )
    assert "solid, all electrodes driven at resonance" in words(figure.get_supxlabel())
    axes, bar = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (mm)", "y (mm)")
    assert bar.get_ylabel() == "w per volt (nm/V)"
    assert axes.get_aspect() == 1.0
    field, lines = axes.collections
    # Zero has the palest colour: the levels are as far up as down.
    assert field.levels[[0, -1]] == pytest.approx([-100.0, 100.0])
    assert field.levels == pytest.approx(-field.levels[::-1])
    assert field.cmap.name == "RdBu_r"
    assert axes.dataLim.bounds == pytest.approx((0, 0, 80, 50))
    assert list(lines.levels) == [0.0]
    at = lines.get_paths()[0].vertices
    crossed = np.unique(np.round(at[:, 0], 1))
    assert crossed == pytest.approx(1e3 * NODES, abs=0.11)
    for node in 1e3 * NODES:
        on = at[np.abs(at[:, 0] - node) < 0.2]
        assert [on[:, 1].min(), on[:, 1].max()] == pytest.approx([0, 50])


@pytest.mark.parametrize(
    ("label", "side", "name"), [((4, 0), LENGTH, "x (mm)"), ((0, 4), WIDTH, "y (mm)")]
)
def test_a_scan_runs_across_the_nodal_lines(label: tuple[int, int], side: float, name: str) -> None:
    figure = line_scan(solved(label))
    assert words(figure.get_suptitle()) == (
        "At the antinode 91 nm per volt, 100 nm per volt at the largest of the face"
    )
    (axes,) = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == (name, "w per volt (nm/V)")
    assert axes.get_xlim() == pytest.approx((0, 1e3 * side))
    seen = labelled(axes)
    assert list(seen) == ["centreline", "edge", "4 nodes of the centreline"]
    position, middle = data(seen["centreline"])
    assert position[[0, -1]] == pytest.approx([0, 1e3 * side])
    # The edge is on the grid of the shape's largest point, the middle of it: one instant for both.
    assert middle == pytest.approx(true_shape(position / 1e3 / side), abs=1e-6)
    assert data(seen["edge"])[1] == pytest.approx(0.5 * middle, abs=1e-6)
    nodes, heights = data(seen["4 nodes of the centreline"])
    assert nodes == pytest.approx(1e3 * NODES * side / LENGTH, abs=0.02)
    assert np.all(heights == 0)


def test_beside_the_scan_stands_the_amplitude_at_the_displays_voltage() -> None:
    figure = line_scan(solved())
    (axes,) = figure.axes
    (right,) = axes.child_axes
    assert right.get_ylabel() == "w at 15 V (µm)"
    FigureCanvasAgg(figure).draw()
    # 1 nm/V at 15 V is 0.015 µm.
    assert right.get_ylim() == pytest.approx(0.015 * np.array(axes.get_ylim()))
    assert line_scan(solved(volts=0.0)).axes[0].child_axes == []


def test_the_resonance_is_drawn_with_its_half_power_band() -> None:
    figure = frequency_response(solved())
    # Q = 100 at 30 kHz.
    assert words(figure.get_suptitle()) == (
        "Resonance at 30.00 kHz: 100 nm per volt, 300 Hz wide at half power"
    )
    assert "a-model, a-method; at the antinode" in words(figure.get_supxlabel())
    (axes,) = figure.axes
    seen = labelled(axes)
    assert list(seen) == [
        "half-power band", "solved plate, all modes", "mode (4,0) extrapolated, 30.01 kHz",
    ]  # fmt: skip
    f, w = data(seen["solved plate, all modes"])
    assert f == pytest.approx(FREQUENCIES / 1e3)
    assert w == pytest.approx(1e9 * Response().amplitude_at(0, 0))
    box = seen["half-power band"].get_extents()
    band = axes.transData.inverted().transform(box)[:, 0]
    assert band == pytest.approx([29.85, 30.15], abs=2e-3)
    line = seen["mode (4,0) extrapolated, 30.01 kHz"]
    assert data(line)[0] == pytest.approx([30.01, 30.01])
    assert axes.get_xlim() == pytest.approx((29, 31))
    assert axes.get_ylim()[0] == 0
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        "frequency (kHz)", "amplitude at the antinode (nm/V)",
    )  # fmt: skip


def test_a_resonance_that_is_not_wholly_swept_has_no_width() -> None:
    response = Response(resonance=150, frequencies=np.linspace(29.9e3, 30.1e3, 301))
    figure = frequency_response(solved(response=response, resonance=150))
    assert words(figure.get_suptitle()) == "Resonance at 30.00 kHz: 100 nm per volt"
    assert "half-power band" not in labelled(figure.axes[0])


def test_the_admittance_is_drawn_in_parts_and_as_a_circle() -> None:
    figure = admittance(solved())
    # 4 mS beside 3 mS: 5 in all.
    assert words(figure.get_suptitle()) == (
        "Admittance: 5 mS at 30.00 kHz, where its real part is largest"
    )
    assert "a-method; truncation 2e-05 of the admittance" in words(figure.get_supxlabel())
    left, right = figure.axes
    seen = labelled(left)
    assert list(seen) == ["|Y|", "Re Y (conductance)", "Im Y (susceptance)"]
    Y = 1e3 * Response().admittance
    for name, values in zip(seen, (np.abs(Y), Y.real, Y.imag), strict=True):
        f, drawn = data(seen[name])
        assert f == pytest.approx(FREQUENCIES / 1e3)
        assert drawn == pytest.approx(values)
    assert left.get_xlim() == pytest.approx((29, 31))
    assert (left.get_xlabel(), left.get_ylabel()) == ("frequency (kHz)", "admittance (mS)")
    circle, top = right.get_lines()
    real, imaginary = data(circle)
    assert np.hypot(real - 2, imaginary - 3) == pytest.approx(np.full(real.size, 2.0))
    assert data(top) == (pytest.approx([4.0]), pytest.approx([3.0]))
    assert list(labelled(right)) == ["30.00 kHz"]
    assert (right.get_xlabel(), right.get_ylabel()) == ("Re Y (mS)", "Im Y (mS)")
    assert right.get_aspect() == 1.0
    assert right.get_xlim()[0] == 0


def test_numbers_volume_and_pictures_are_written_each_under_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The pictures themselves are drawn by the tests above; here it matters which goes where."""
    written: list[Path] = []
    pages: list[Any] = []

    def text(result: Any, figures: list[Any]) -> str:
        pages.append(figures)
        return "a page"

    named = [
        dataclasses.replace(one, draw=lambda _, name=one.draw.__name__: name)
        for one in PLATE_FIGURES
    ]
    monkeypatch.setattr(page, "PLATE_FIGURES", named)
    monkeypatch.setattr(style, "png", lambda figure: f"PNG {figure}".encode())
    monkeypatch.setattr(page, "write_mode", lambda _, file: written.append(file))
    monkeypatch.setattr(page, "plate_page", text)
    always = {
        "mode-plan": ("Mode shape from above", "plan_view"),
        "line-scan": ("Line scan along the plate", "line_scan"),
        "frequency-response": ("Frequency response", "frequency_response"),
        "admittance": ("Admittance", "admittance"),
    }
    for given, expected in (({}, always),):
        folder = tmp_path / str(len(expected))
        folder.mkdir()
        assert write_plate(solved(**given), folder) == folder / "index.html"
        files = {file.name: file.read_bytes() for file in folder.iterdir()}
        assert files.pop("index.html") == b"a page"
        assert json.loads(files.pop("plate.json")) == {"mode": "µ"}
        assert files == {
            f"{name}.png": f"PNG {figure}".encode() for name, (_, figure) in expected.items()
        }
        assert pages.pop() == expected
        assert written.pop() == folder / "mode.vtu"


def test_the_volume_is_the_mode_by_itself_at_the_displays_voltage(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(
        page, "write_vtu", lambda *given, **named: asked.append((given, named)) or given[0]
    )
    result = solved(solid=SimpleNamespace(modes="modes", index=3))
    assert write_mode(result, tmp_path / "a.vtu") == tmp_path / "a.vtu"
    named = {"response": result.response, "at": 200, "voltage": 15.0}
    assert asked == [((tmp_path / "a.vtu", "modes", 3), named)]
