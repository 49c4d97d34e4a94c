"""Figures of a disc or stator: shape, sectors, scans and response as the solved numbers have it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.patches import Circle, Wedge
from tests.unit.drawn import labelled, words
from tests.unit.made_results import WARM, made_result

from squeezefilm.core.kit import style
from squeezefilm.core.kit.style import BLUE, MINUS, MUTED, PLUS
from squeezefilm.design.plate.report import page
from squeezefilm.design.plate.report.figures import response, scan, shape
from squeezefilm.design.plate.report.page import write_plate
from squeezefilm.design.plate.ring import RingAnalysis
from squeezefilm.physics.plate.circuit import EquivalentCircuit
from squeezefilm.physics.plate.ring.body import RingResponse
from squeezefilm.physics.plate.ring.section import SectorDrive

pytestmark = pytest.mark.usefixtures("figures_as_described")

RADIUS = np.linspace(10e-3, 30e-3, 41)
# The rim stands at an angle of phase of its own; a nodal circle lies at 15 mm.
PHASE = np.exp(0.7j)
RADIAL = 2e-8 * (RADIUS - 15e-3) / 15e-3
GAIN = np.array([0.2, 1.0, 0.4])
FREQUENCIES = np.array([39e3, 40e3, 42e3])
ADMITTANCE = np.array([1e-3 + 3e-3j, 6e-3 + 8e-3j, 2e-3 - 1e-3j])
CIRCUIT = EquivalentCircuit(40e3, 100.0, 2e-9, 150.0, 60e-3, 0.26e-9)


def swept(radius: np.ndarray, radial: np.ndarray) -> RingResponse:
    return RingResponse(
        FREQUENCIES, radius, np.outer(GAIN, PHASE * radial), ADMITTANCE, (0, 1, 4), 7
    )


def layer(inner: float, outer: float, piezo: bool) -> Any:
    return SimpleNamespace(
        inner_radius=inner, outer_radius=outer, solid=SimpleNamespace(piezoelectric=piezo)
    )


def made(**changes: Any) -> Any:
    """A ring in two waves, driven by two sectors that begin at 20°."""
    turn = math.pi / 9
    parts: dict[str, Any] = {
        "annular": SimpleNamespace(harmonic=2, half_wavelength=31.4e-3),
        "working": SimpleNamespace(label="B(0,2)", frequency=40e3),
        "response": swept(RADIUS, RADIAL), "largest_per_volt": 20e-9, "resonance": 1,
        "scan_radius": 20e-3, "model": "annular_3d",
        "circles": np.array([15e-3]), "circuit": CIRCUIT, "summary": lambda: {"mode": "µ"},
        "body": SimpleNamespace(
            section=SimpleNamespace(
                layers=(layer(10e-3, 30e-3, False), layer(12e-3, 28e-3, True)),
            ),
            drive=SectorDrive(
                ((turn, turn + math.pi / 2, 1), (turn + math.pi / 2, turn + math.pi, -1))
            ),
        ),
    }  # fmt: skip
    return made_result(RingAnalysis, **{**parts, **changes})


RING = made()
WIDE = np.linspace(0, 30e-3, 61)
DISC = made(
    annular=SimpleNamespace(harmonic=0, half_wavelength=None),
    working=SimpleNamespace(label="B(1,0)", frequency=40e3),
    response=swept(WIDE, 1e-8 * (WIDE / 15e-3 - 1.2)),
    body=SimpleNamespace(
        section=SimpleNamespace(layers=(layer(0, 30e-3, False), layer(0, 25e-3, True))),
        drive=SectorDrive(((0.0, 2 * math.pi, 1),)),
    ),
)


def wedges(axes: Any) -> list[Wedge]:
    return [one for one in axes.patches if isinstance(one, Wedge)]


def test_the_shape_says_its_mode_and_where_nothing_moves() -> None:
    figure = shape(RING)
    assert words(figure.get_suptitle()) == (
        "Mode B(0,2) at 40.00 kHz moves up to 20 nm per volt; nodal lines 31.4 mm apart on the "
        "mean circumference"
    )
    assert figure.get_supxlabel() == "Model: annular_3d, channel driven at resonance"
    assert words(shape(DISC).get_suptitle()).endswith("nodal circle at a radius of 15 mm")
    still = made(annular=DISC.annular, circles=np.zeros(0))
    assert words(shape(still).get_suptitle()).endswith("per volt; no nodal line")


def test_nodal_lines_lie_where_the_driven_mode_is_still() -> None:
    figure = shape(RING)
    left, right, bar = figure.axes
    field, lines = left.collections[:2]
    # The largest motion is at the rim; levels go as far down as up.
    assert field.levels == pytest.approx(np.linspace(-20, 20, 21), rel=1e-3)
    assert lines.levels.tolist() == [0]
    points = np.concatenate([path.vertices for path in lines.get_paths()])
    radius = np.hypot(*points.T)
    angle = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
    # Sectors that change sign at 110° make a node there, and every 90° from it.
    away = np.abs((angle - 20 + 45) % 90 - 45)
    still = (away < 0.5) | (np.abs(radius - 15) < 0.1)
    assert np.all(still)
    assert np.count_nonzero(away < 0.5) > 100
    assert np.count_nonzero(np.abs(radius - 15) < 0.1) > 100
    assert (radius.min(), radius.max()) == pytest.approx((10, 30), abs=0.1)
    assert bar.get_xlabel() == "per volt (nm/V)"
    for axes in (left, right):
        assert axes.get_xlim() == pytest.approx((-31.5, 31.5))
        assert axes.get_ylim() == pytest.approx((-31.5, 31.5))
        assert axes.get_xlabel() == "x (mm)"
        assert axes.get_aspect() == 1
    assert left.get_ylabel() == "y (mm)"
    assert left.get_title(loc="left") == "touched face; nodal lines in black"


def test_the_motion_is_up_over_the_sector_poled_up() -> None:
    """One quarter is up at the rim: its colours there are those of the highest level."""
    figure = shape(RING)
    field = figure.axes[0].collections[0]
    highest = field.get_paths()[-1].vertices
    angle = np.degrees(np.arctan2(highest[:, 1], highest[:, 0])) % 180
    # The middle of the first sector is at 65°.
    assert np.all(np.abs(angle - 65) < 25)


def test_sectors_are_drawn_with_their_sign_on_the_ceramic() -> None:
    axes = shape(RING).axes[1]
    whole, up, down = wedges(axes)
    assert (whole.theta1, whole.theta2) == (0, 360)
    assert to_hex(whole.get_edgecolor()) == MUTED
    for one, start, color in ((up, 20, PLUS), (down, 110, MINUS)):
        assert (one.theta1, one.theta2) == pytest.approx((start, start + 90))
        assert to_hex(one.get_facecolor()) == color
    for one in (whole, up, down):
        assert (one.r, one.width) == pytest.approx((28, 16))
    signs = {one.get_text(): np.array(one.get_position()) for one in axes.texts}
    for sign, angle in (("+", 65), ("−", 155)):
        place = 20 * np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
        assert signs[sign] == pytest.approx(place)
    circles = [one.radius for one in axes.patches if isinstance(one, Circle)]
    assert sorted(circles) == pytest.approx([10, 30])
    assert [one.get_text() for one in axes.get_legend().get_texts()] == [
        "driven, poled up", "driven, poled down", "not on this channel",
    ]  # fmt: skip


def test_a_disc_poled_as_a_whole_has_one_sign_in_its_middle() -> None:
    axes = shape(DISC).axes[1]
    (one,) = wedges(axes)
    assert (one.theta1, one.theta2, one.r, one.width) == pytest.approx((0, 360, 25, 25))
    assert [(text.get_text(), text.get_position()) for text in axes.texts] == [("+", (0, 0))]
    assert [one.radius for one in axes.patches if isinstance(one, Circle)] == pytest.approx([30])
    assert [one.get_text() for one in axes.get_legend().get_texts()] == ["driven, poled up"]
    # With a hole in it, the middle is no ceramic: the sign stands half way round.
    layers = (layer(10e-3, 30e-3, False), layer(12e-3, 28e-3, True))
    section = SimpleNamespace(layers=layers)
    holed = made(body=SimpleNamespace(section=section, drive=DISC.body.drive))
    (sign,) = shape(holed).axes[1].texts
    assert sign.get_position() == pytest.approx((-20, 0), abs=1e-9)


def test_the_scan_goes_around_and_outwards() -> None:
    figure = scan(RING)
    above, below = figure.axes
    around, zero = above.get_lines()
    length = around.get_xdata()
    assert length[[0, -1]] == pytest.approx([0, 2 * math.pi * 20])
    # At 20 mm a third of the 20 nm/V at the rim; an antinode at the middle of a sector.
    antinode = math.radians(65)
    expected = 20 / 3 * np.cos(2 * (length / 20 - antinode))
    assert around.get_ydata() == pytest.approx(expected, abs=1e-9)
    assert zero.get_ydata() == [0, 0]
    spans = [one.get_extents().transformed(above.transData.inverted()) for one in above.patches]
    ends = [20 * math.radians(angle) for angle in (20, 110, 200)]
    assert [(one.x0, one.x1) for one in spans] == [
        pytest.approx(ends[:2]), pytest.approx(ends[1:]),
    ]  # fmt: skip
    assert [to_hex(one.get_facecolor()) for one in above.patches] == [PLUS, MINUS]
    assert [one.get_height() for one in above.patches] == [0.06, 0.06]
    assert above.get_xlim() == pytest.approx((0, 2 * math.pi * 20))
    assert above.get_xlabel() == "along the circumference at a radius of 20 mm (mm)"
    radial, level, circle = below.get_lines()
    assert radial.get_xdata() == pytest.approx(1e3 * RADIUS)
    assert radial.get_ydata() == pytest.approx(1e9 * RADIAL)
    assert level.get_ydata() == [0, 0]
    assert circle.get_xdata() == pytest.approx([15, 15])
    assert list(labelled(below)) == ["at the angle of an antinode", "nodal circle"]
    assert below.get_xlim() == pytest.approx((10, 30))
    assert below.get_xlabel() == "radius (mm)"
    assert (above.get_ylabel(), below.get_ylabel()) == ("per volt (nm/V)",) * 2
    assert words(figure.get_suptitle()) == (
        "2 waves stand around the mean circumference of 125.7 mm: 7 nm per volt at their antinodes"
    )


def test_without_nodal_diameters_the_scan_is_a_whole_diameter() -> None:
    figure = scan(DISC)
    (axes,) = figure.axes
    right, left, _, *circles = axes.get_lines()
    # It is the middle that moves most: there it is up.
    motion = 12 - 10 * WIDE / 15e-3
    assert right.get_ydata() == pytest.approx(motion, abs=1e-12)
    assert right.get_xdata() == pytest.approx(1e3 * WIDE)
    assert left.get_xdata() == pytest.approx(-1e3 * WIDE)
    assert left.get_ydata() == pytest.approx(motion, abs=1e-12)
    assert [one.get_xdata()[0] for one in circles] == pytest.approx([15, -15])
    assert list(labelled(axes)) == ["nodal circle"]
    assert axes.get_xlim() == pytest.approx((-30, 30))
    assert axes.get_xlabel() == "along a diameter (mm)"
    assert words(figure.get_suptitle()) == (
        "Along a diameter B(1,0) moves 12 nm per volt in the middle and 8 at the rim"
    )
    assert scan(made(annular=DISC.annular, circles=np.zeros(0))).axes[0].get_legend() is None


def test_the_response_has_amplitude_admittance_and_circuit() -> None:
    figure = response(RING)
    above, below = figure.axes
    (amplitude,) = above.get_lines()
    assert amplitude.get_xdata() == pytest.approx([39, 40, 42])
    assert amplitude.get_ydata() == pytest.approx(20 * GAIN)
    assert to_hex(amplitude.get_color()) == BLUE
    lines = labelled(below)
    assert list(lines) == ["|Y|", "Re Y", "equivalent circuit, R1 = 150 Ω"]
    size, real, circuit = (one.get_ydata() for one in lines.values())
    assert size == pytest.approx(1e3 * np.abs(ADMITTANCE))
    assert real == pytest.approx([1, 6, 2])
    assert circuit == pytest.approx(1e3 * np.abs(CIRCUIT.admittance(FREQUENCIES)))
    assert all(one.get_xdata() == pytest.approx([39, 40, 42]) for one in lines.values())
    assert below.get_yscale() == "log"
    assert below.yaxis.get_major_formatter()(0.1) == "0.1"
    assert above.get_ylim()[0] == 0
    assert above.get_ylabel() == "largest amplitude (nm/V)"
    assert (below.get_xlabel(), below.get_ylabel()) == ("frequency (kHz)", "admittance (mS)")
    assert words(figure.get_suptitle()) == "Resonance at 40 kHz: 10 mS"
    assert figure.get_supxlabel() == (
        "Model: annular_3d; 7 modes of its harmonic, 3 harmonics in the admittance"
    )
    assert list(labelled(response(made(circuit=None)).axes[1])) == ["|Y|", "Re Y"]


def test_a_page_says_what_the_terminal_says(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [("Mode B(0,2)", "40 kHz", "fitted & not predicted")]
    monkeypatch.setattr(page, "working_rows", lambda _: list(rows))
    monkeypatch.setattr(page, "drive_rows", lambda _: [("At 12 V", "1 mA", "")])
    monkeypatch.setattr(page, "fit_sentences", lambda fit: (f"Fitted: {fit} < all.",))
    told = {"provenance": dict.fromkeys(("squeezefilm_version", "created_utc", "config_sha256"), 1)}
    ring = made(
        display=SimpleNamespace(title="A <ring>", name="r", drive=SimpleNamespace(voltage=12.0)),
        body=SimpleNamespace(fit="thickness", quality_factor=None), rows=(), status="no modes",
        summary=lambda: told, heat=WARM, objections=(),
            mode=SimpleNamespace(amplitude_per_volt=20e-9),
    )  # fmt: skip
    text = page.plate_page(ring, {"line-scan": ("Scan", scan(RING))})
    for said in (
        "A &lt;ring&gt;", "Mode B(0,2)", "fitted &amp; not predicted", "At 12\u00a0V",
        "0.24\u00a0µm",
        "<p>Fitted: thickness &lt; all.</p>", "no modes", "line-scan.png",
        "<p>it is hot</p>",
    ):  # fmt: skip
        assert said in text, said
    assert "ParaView" not in text


def test_numbers_and_pictures_are_written_each_under_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A picture of its title: which goes where is what counts, and PNGs are slow.
    monkeypatch.setattr(style, "png", lambda one: one.get_suptitle().encode())
    monkeypatch.setattr(page, "plate_page", lambda _, figures: " ".join(figures))
    assert write_plate(RING, tmp_path) == tmp_path / "index.html"
    said = {one.name: one.read_text(encoding="utf-8") for one in tmp_path.iterdir()}
    data = said.pop("plate.json")
    assert json.loads(data) == {"mode": "µ"}
    assert "µ" in data
    assert data.endswith("}\n")
    assert said == {
        "index.html": "mode-plan line-scan frequency-response",
        "mode-plan.png": shape(RING).get_suptitle(),
        "line-scan.png": scan(RING).get_suptitle(),
        "frequency-response.png": response(RING).get_suptitle(),
    }
