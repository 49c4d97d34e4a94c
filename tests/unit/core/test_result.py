"""What results have in common: a short repr, a table, ways out of Python, small pickles."""

import builtins
import dataclasses
import html
import json
import pickle
from typing import Any, ClassVar

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.quantities import Metre, MetreArray
from squeezefilm.core.results import Result
from squeezefilm.physics.film.periodic.profile import (
    flexural_profile,
    profile_from_function,
)
from squeezefilm.study.psychometric.fit import PsychometricFit


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Part:
    """Something inside."""

    depth: Metre


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Measured(Result):
    """A result as small as can be."""

    name: str
    width: Metre
    part: Part | None
    places: MetreArray
    _shown: ClassVar[str] = "name width part.depth ends twice"

    @property
    def ends(self) -> tuple[Metre, Metre]:
        """Of the places (m)."""
        return float(self.places[0]), float(self.places[-1])

    @property
    def twice(self) -> int:
        """Without a unit."""
        return 2


MEASURED = Measured("<a>", 2e-3, Part(5e-6), np.array([0.0, 1e-3]))


def test_a_repr_has_units_and_goes_inside_and_leaves_out_what_is_not_there() -> None:
    assert (
        repr(MEASURED)
        == "<Measured name=<a>, width=2 mm, part.depth=5 µm, ends=0 m to 1 mm, twice=2>"
    )
    assert "part" not in repr(dataclasses.replace(MEASURED, part=None))


def test_a_notebook_s_table_escapes_what_it_shows() -> None:
    shown = MEASURED._repr_html_()
    assert shown.startswith("<table>")
    assert f"<td>{html.escape('<a>')}</td>" in shown
    assert "<td>width</td><td>2 mm</td>" in shown


def test_a_dict_is_json_with_units_in_its_keys() -> None:
    assert MEASURED.to_dict() == {
        "name": "<a>", "width_m": 2e-3, "part": {"depth_m": 5e-6}, "places_m": [0.0, 1e-3],
    }  # fmt: skip


def test_a_data_frame_has_the_single_numbers_and_needs_pandas(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    frame = MEASURED.to_pandas()
    assert frame.to_dict("records") == [{"name": "<a>", "width_m": 2e-3}]
    real = builtins.__import__

    def without(name: str, *args: Any, **kwargs: Any) -> Any:
        if name == "pandas":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError, match=r"needs pandas, which is not installed.*to_dict"):
        MEASURED.to_pandas()


@pytest.fixture(scope="module")
def prediction() -> Any:
    return sf.predict("biet2008-stator", vibration_amplitude="2 um", model="paper2008")


@pytest.fixture(scope="module")
def fit() -> PsychometricFit:
    return sf.fit_psychometric([0.1, 0.2, 0.4], [11, 15, 20], [20, 20, 20])


def test_a_prediction_is_short_small_and_json(prediction: Any) -> None:
    assert repr(prediction).startswith("<Prediction display=biet2008-stator, model=paper2008,")
    assert "relative_friction=0.7019" in repr(prediction)
    assert len(repr(prediction)) < 300
    sent = pickle.dumps(prediction)
    assert len(sent) < 30_000
    assert pickle.loads(sent).to_dict() == prediction.to_dict()
    assert json.loads(json.dumps(prediction.to_dict(), allow_nan=False)) == prediction.to_dict()
    assert prediction.to_pandas()["relative_friction"][0] == prediction.relative_friction


def test_a_display_is_short_and_travels_with_its_sources() -> None:
    display = sf.load_display("biet2008-plate")
    assert len(repr(display)) < 300
    there = pickle.loads(pickle.dumps(display))
    assert there == display
    assert there.provenance == display.provenance
    with pytest.raises(TypeError):
        there.provenance["drive.voltage"] = None


def test_friction_as_a_table_and_its_inverse_are_the_prediction_s_and_travel(
    prediction: Any,
) -> None:
    table = pickle.loads(pickle.dumps(prediction.friction))
    amplitude = np.linspace(0, 2e-6, 7)
    np.testing.assert_array_equal(table(amplitude), prediction.friction(amplitude))
    np.testing.assert_allclose(table(amplitude), prediction.law.curve(amplitude), atol=1e-4)
    with pytest.raises(OutOfRangeError, match="tabulated for amplitudes from 0 to 2e-06 m"):
        table(np.array([2.1e-6]))
    inverse = prediction.inverse
    assert inverse.largest_amplitude == prediction.vibration_amplitude
    assert inverse.least_friction == pytest.approx(prediction.relative_friction, abs=1e-4)


def given(X: np.ndarray, T: np.ndarray) -> np.ndarray:
    """A gap of one's own."""
    return 1 + 0.1 * X + 0.4 * np.cos(T)


def test_gaps_travel() -> None:
    x, t = np.linspace(-0.5, 0.5, 9), 2 * np.pi * np.arange(8) / 8
    for profile in (
        flexural_profile(0.4, wavenumber=3.0, ridge_depth=0.1, ridge_wavenumber=40.0, tilt=0.05),
        profile_from_function(given),
    ):
        there = pickle.loads(pickle.dumps(profile))
        np.testing.assert_array_equal(there.gap(x, t), profile.gap(x, t))
    np.testing.assert_allclose(there.gap(x, t), given(x[:, None], t[None, :]), atol=1e-9)


def test_a_psychometric_fit_is_short_and_a_frame_of_its_data(fit: PsychometricFit) -> None:
    assert repr(fit).startswith("<PsychometricFit function.shape=logistic, function.threshold=")
    assert len(repr(fit)) < 400
    assert list(fit.to_pandas().columns) == ["intensity", "positive", "trials"]
    assert pickle.loads(pickle.dumps(fit)).to_dict() == fit.to_dict()


def test_a_plan_is_a_frame_of_trials() -> None:
    plan = sf.plan_study("biet2008-gratings", participants=2)
    assert len(repr(plan)) < 300
    frame = plan.to_pandas()
    assert set(frame["participant"]) == {0, 1}
    assert len(frame) == sum(len(one) for one in plan.schedules)
