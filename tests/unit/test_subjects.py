"""Each type of result has its figures and its report; what has none is told what has."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.style import png

pytestmark = pytest.mark.usefixtures("figures_as_described")


@pytest.fixture(scope="module")
def sweep() -> list[Any]:
    return [
        sf.predict("biet2008-stator", vibration_amplitude=f"{size} um", model="paper2008")
        for size in (1, 2)
    ]


def test_a_prediction_and_a_sweep_of_them_are_plotted(sweep: list[Any]) -> None:
    one, several = sf.plot(sweep[1]), sf.plot(sweep)
    assert " ".join(one.get_suptitle().split()) == "µ′/µ = 0.70 at 2 µm"
    assert " ".join(several.get_suptitle().split()).startswith("2 predictions: µ′/µ from 0.70 to")
    # One law for both, and a mark for each.
    assert len(several.axes[0].lines) == 3
    marks = [float(line.get_ydata()[0]) for line in several.axes[0].lines[1:]]
    assert marks == [one.relative_friction for one in sweep]
    assert png(several, 40).startswith(b"\x89PNG")


@pytest.mark.parametrize("shape", ["strip", "disc", "rectangle"])
def test_a_film_is_plotted_as_its_pressure(shape: str) -> None:
    film = sf.solve_film(5.0, 0.3, shape=shape, tolerance=0.05)
    figure = sf.plot(film)
    line = figure.axes[-1].lines[0]
    assert float(np.max(line.get_ydata())) == pytest.approx(
        float(film.film.mean_pressure.max()), rel=1e-6
    )
    assert figure.axes[-1].get_xlabel().startswith({"strip": "x", "disc": "r"}.get(shape, "X"))


def test_a_film_under_a_gap_of_one_s_own() -> None:
    film = sf.solve_film(5.0, lambda X, T: 1 + 0.3 * np.cos(T) + 0 * X, tolerance=1e-3)
    plain = sf.solve_film(5.0, 0.3, tolerance=1e-3)
    assert film.excursion_ratio == pytest.approx(0.3)
    assert film.over_pressure == pytest.approx(plain.over_pressure, rel=3e-3)
    assert film.model.endswith("a gap of one's own")
    assert list(film.to_pandas().columns) == ["position", "mean_pressure"]
    assert "film" not in film.to_dict()
    with pytest.raises(InputError, match="solved under a strip, not under a disc"):
        sf.solve_film(5.0, lambda X, T: 1 + 0.3 * np.cos(T), shape="disc")


def test_a_texture_and_a_psychometric_fit_are_plotted() -> None:
    texture = sf.RelativeFriction(sf.SquareWave("2 mm"), 0.5, 1.0)
    assert len(sf.plot(texture).axes) == 3
    fit = sf.fit_psychometric(
        [0.1, 0.2, 0.4], [11, 15, 20], [20, 20, 20], shape="weibull", axis="log"
    )
    figure = sf.plot(fit)
    assert figure.get_suptitle().startswith(f"The threshold is {fit.function.threshold:.3g}")
    assert figure.axes[0].get_xscale() == "log"


def test_what_is_not_there_is_refused_with_what_there_is(sweep: list[Any], tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no figure 'frictoin'\. Did you mean 'friction'\?"):
        sf.plot(sweep[0], "frictoin")
    with pytest.raises(InputError, match=r"int has no figure; these have: Prediction, A"):
        sf.plot(3)
    with pytest.raises(InputError, match=r"a Prediction has no report; take plot\(result\)"):
        sf.write_report(sweep[0], tmp_path)
    assert not list(tmp_path.iterdir())
