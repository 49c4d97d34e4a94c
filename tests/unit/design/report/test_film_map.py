"""The map of a film and the pressure of one: contours and curves where the numbers are."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import words

from squeezefilm.core.kit import style
from squeezefilm.core.kit.style import BLUE
from squeezefilm.design.film import FilmMap, FilmRequest
from squeezefilm.design.report.film import film_map, film_pressure, write_film_map
from squeezefilm.physics.film.planar.film import FilmPlanar
from squeezefilm.physics.film.planar.grid import PlanarGap

pytestmark = pytest.mark.usefixtures("figures_as_described")

SIGMA, EXCURSION = np.geomspace(0.01, 1e4, 121), np.linspace(0.02, 0.95, 40)
# Rises with σ to its asymptote, and with ε alone beside it.
RISE, HEIGHT = SIGMA / (SIGMA + 20), EXCURSION**2
MAP = FilmMap(
    request=FilmRequest(polytropic_exponent=1.4, knudsen_number=0.0625),
    squeeze_number=SIGMA, excursion_ratio=EXCURSION, over_pressure=np.outer(RISE, HEIGHT),
    over_pressure_error=np.zeros((121, 40)), stiffness_relative=np.zeros((121, 40)),
    damping_relative=np.zeros((121, 40)),
    force_error=np.zeros((121, 40)), model="a film of nothing",
)  # fmt: skip


def test_lines_of_equal_over_pressure_lie_where_it_is_so_high() -> None:
    figure = film_map(MAP)
    left, right = figure.axes[:2]
    (lines,) = left.collections
    assert lines.levels == pytest.approx([1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 3e-2, 0.1, 0.3, 1, 3])
    for level, path in zip(lines.levels[4:8], lines.get_paths()[4:8], strict=True):
        sigma, excursion = path.vertices.T
        assert sigma.size > 20
        found = np.interp(sigma, SIGMA, RISE) * excursion**2
        assert found == pytest.approx(np.full(found.size, level), rel=0.02)
    assert {one.get_text() for one in left.texts} >= {"0.1", "0.3"}
    assert left.get_title(loc="left") == "over-pressure W − 1 over ambient"
    assert left.get_ylabel() == "excursion ε = amplitude over mean gap"
    for axes in (left, right):
        assert axes.get_xscale() == "log"
        assert axes.get_xlabel() == "squeeze number σ"
        assert axes.xaxis.get_major_formatter()(100) == "100"
    assert words(figure.get_suptitle()) == (
        "The strip's over-pressure grows with both; below σ of about 100 it falls short of its "
        "asymptote"
    )
    assert words(figure.get_supxlabel()) == (
        "Model: a film of nothing, tolerance 0.001 of the over-pressure, n = 1.4, Kn = 0.0625"
    )


def test_the_share_is_of_what_the_largest_squeeze_number_has() -> None:
    _, right, bar = film_map(MAP).axes
    parts, ninety = right.collections
    assert parts.levels == pytest.approx(np.arange(0, 101, 10))
    # 90 % of σ/(σ + 20) is reached at 180, whatever the excursion.
    (path,) = ninety.get_paths()
    assert path.vertices[:, 0] == pytest.approx(180, rel=0.03)
    assert np.ptp(path.vertices[:, 1]) == pytest.approx(0.93)
    assert right.get_title(loc="left") == "dashed: 90 %"
    assert bar.get_ylabel() == "share of the over-pressure at σ = 10⁴ (%)"


def answer(film: Any) -> Any:
    return SimpleNamespace(
        film=film, over_pressure=0.12345, over_pressure_error=2.34e-4, model="a film",
        squeeze_number=12.345, excursion_ratio=0.25,
    )  # fmt: skip


def line_film(shape: str) -> Any:
    place, time = np.linspace(-0.5, 0.5, 11), np.linspace(0, 2 * np.pi, 8, endpoint=False)
    gap = (1 + 0.1 * place)[:, None] * (1 + 0.25 * np.cos(time))
    return SimpleNamespace(
        position=place, gap=gap, mean_pressure=1.2 - place**2, shape=shape, time=time
    )


@pytest.mark.parametrize(("shape", "label"), [("strip", "x / l0"), ("disc", "r / R")])
def test_a_film_along_a_line_has_its_gap_above_its_pressure(shape: str, label: str) -> None:
    figure = film_pressure(answer(line_film(shape)))
    top, axes = figure.axes
    place = np.linspace(-0.5, 0.5, 11)
    (mean,) = top.get_lines()
    assert mean.get_xdata() == pytest.approx(place)
    assert mean.get_ydata() == pytest.approx(1 + 0.1 * place)
    (band,) = top.collections[0].get_paths()
    for at in (-0.4, 0.3):
        y = band.vertices[np.isclose(band.vertices[:, 0], at), 1]
        reach = np.array([0.75, 1.25]) * (1 + 0.1 * at)
        assert (y.min(), y.max()) == pytest.approx(tuple(reach))
    assert top.get_ylabel() == "gap over H0"
    assert top.get_ylim()[0] == 0
    (pressure,) = axes.get_lines()
    assert pressure.get_xdata() == pytest.approx(place)
    assert pressure.get_ydata() == pytest.approx(1.2 - place**2)
    assert to_hex(pressure.get_color()) == BLUE
    assert (axes.get_xlabel(), axes.get_ylabel()) == (label, "mean pressure over ambient")
    assert words(figure.get_suptitle()) == (
        "The film's over-pressure is 0.123 of the ambient pressure, within 0.0002"
    )
    assert words(figure.get_supxlabel()) == "Model: a film, σ = 12.35, ε = 0.25"


def test_a_film_in_the_plane_is_cut_along_its_middle() -> None:
    # Rows at Y = −0.2, 0.1 and 0.4, in no order along X: the nearest to 0 is the second.
    across, along = np.meshgrid([-0.2, 0.1, 0.4], [0.3, -0.1, 0.0, -0.4], indexing="ij")
    count = across.size
    film = FilmPlanar(
        mean_load=1.1, over_pressure=0.1, over_pressure_error=1e-3, stiffness_relative=0.0,
        damping_relative=0.0, force_error=0.0, force_harmonics=np.zeros(8, dtype=complex),
        force_harmonics_error=np.zeros(8), X=along.ravel(),
        Y=across.ravel(), area=np.ones(count),
        mean_pressure=1 + along.ravel() ** 2 + 10 * across.ravel(), rows=3, columns=4,
        time_points=8, iterations=1, residual=0.0, status="converged",
        shape="rectangle", aspect_ratio=1.0, gap=PlanarGap(0.5), squeeze_number=1.0,
        polytropic_exponent=1.0, knudsen_number=0.0, slip="first", tolerance=1e-3,
    )  # fmt: skip
    (axes,) = film_pressure(answer(film)).axes
    (line,) = axes.get_lines()
    assert line.get_xdata().tolist() == [-0.4, -0.1, 0.0, 0.3]
    assert line.get_ydata() == pytest.approx([2.16, 2.01, 2.0, 2.09])
    assert axes.get_xlabel() == "X over the reference length"
    assert axes.get_ylabel() == "mean pressure over ambient"


def test_the_map_is_written_as_numbers_and_as_a_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A picture of its title: PNGs are slow.
    monkeypatch.setattr(style, "png", lambda one: one.get_suptitle().encode())
    path = write_film_map(MAP, tmp_path / "new")
    assert path == tmp_path / "new" / "film-map.png"
    assert path.read_text(encoding="utf-8").startswith("The strip's over-pressure")
    text = (tmp_path / "new" / "film-map.json").read_text(encoding="utf-8")
    assert text.endswith("}\n")
    assert json.loads(text)["over_pressure"] == MAP.over_pressure.tolist()
