"""A rendered stroke and its report: refusals, silence without a finger, strict JSON."""

from __future__ import annotations

import json

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import FloatArray
from squeezefilm.core.results import to_json
from squeezefilm.physics.render.fidelity.rendered_stroke import rendered_stroke
from squeezefilm.physics.render.fidelity.report import fidelity_report
from squeezefilm.physics.render.motion.estimator import (
    TOUCH_PANEL_120_HZ,
    TOUCH_PANEL_240_HZ,
    MotionEstimator,
    MotionModel,
)
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SquareWave

ENVELOPE = DrivenEnvelope(0.5e-3, 0.5e-3, 1e-6)
GRATING = Amplitude(SquareWave(2e-3), 0.0, 0.8e-6)
STROKE = Stroke(0.1, 0.04, 2)


def friction(amplitude: FloatArray, speed: object) -> FloatArray:
    return np.asarray(np.exp(-amplitude / 1e-6))


def test_the_report_becomes_strict_json_with_units_in_its_keys() -> None:
    rendered = rendered_stroke(
        GRATING, STROKE, ENVELOPE, friction, compensation="preview", sensor=TOUCH_PANEL_120_HZ
    )
    data = json.loads(json.dumps(to_json(fidelity_report(rendered)), allow_nan=False))
    assert data["spatial_frequency_1_per_m"] == [500.0, 1500.0, 2500.0]
    assert data["sensor"]["evidence"] == "assumed"
    assert data["compensation"] == "preview"
    assert set(data) >= {"lag_m", "lag_time_s", "rms_error", "position_error_m", "silent"}
    known = fidelity_report(rendered_stroke(GRATING, STROKE, ENVELOPE, friction))
    data = json.loads(json.dumps(to_json(known), allow_nan=False))
    assert data["sensor"] is data["position_error_m"] is data["samples_refused"] is None


def test_the_drive_is_silent_until_the_finger_is_known_and_after_it_is_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rendered = rendered_stroke(
        GRATING, STROKE, ENVELOPE, friction, sensor=TOUCH_PANEL_240_HZ, compensation="inverse"
    )
    assert np.all(rendered.command[rendered.time < 5e-3] == 0)
    assert np.any(rendered.command > 0)
    # An estimator that calls the finger lost between any two samples silences nearly everything.
    nervous = MotionEstimator(MotionModel(), 3e-5, stall=1e-3)
    monkeypatch.setattr(MotionEstimator, "for_sensor", staticmethod(lambda _: nervous))
    lost = rendered_stroke(GRATING, STROKE, ENVELOPE, friction, sensor=TOUCH_PANEL_240_HZ)
    assert lost.silent == 1.0
    assert not np.any(lost.command)


def test_one_seed_gives_one_stroke() -> None:
    one, same, other = (
        rendered_stroke(GRATING, STROKE, ENVELOPE, friction, sensor=TOUCH_PANEL_240_HZ, seed=seed)
        for seed in (1, 1, 2)
    )
    assert np.array_equal(one.command, same.command)
    assert not np.array_equal(one.command, other.command)


def test_any_texture_without_a_period_is_judged_over_octaves() -> None:
    class Noise:
        """A pattern of many lines."""

        def __call__(self, x, y, v, t, /):  # type: ignore[no-untyped-def]
            k = np.geomspace(300, 4000, 24)
            waves = np.sin(np.multiply.outer(x, k * 2 * np.pi) + k)
            return 5e-7 + 2e-8 * waves.sum(axis=-1) * np.ones_like(t)

    report = fidelity_report(rendered_stroke(Noise(), STROKE, ENVELOPE, friction))
    assert report.spatial_frequency.size == 8
    kept = report.contrast_kept[np.isfinite(report.contrast_kept)]
    assert kept.size >= 4
    assert np.all(np.diff(kept) < 0.1)
    assert kept[-1] == pytest.approx(1 / np.hypot(1, 2 * np.pi * 200 * 0.5e-3), rel=0.02)
    assert 0 < report.lag < 1.5 * 0.1 * 0.5e-3


def test_chosen_frequencies_are_measured() -> None:
    rendered = rendered_stroke(GRATING, STROKE, ENVELOPE, friction)
    assert fidelity_report(rendered, [500.0]).contrast_kept.shape == (1,)


def test_four_periods_in_a_pass_are_enough_to_the_last_digit() -> None:
    stroke = rendered_stroke(GRATING, STROKE, ENVELOPE, friction)
    # The second pass, from the turn to the last step that still moves.
    length = stroke.position.max() - stroke.position[-2]
    for off in (-1e-12, 1e-12):
        asked = [(4 + off) / length, 500.0]
        kept = fidelity_report(stroke, asked).contrast_kept
        assert np.isfinite(kept[1])
        # There the 2 mm grating has no line; one of four periods to the pass has.
        wide = rendered_stroke(
            Amplitude(SquareWave(length / 4), 0.0, 0.8e-6), STROKE, ENVELOPE, friction
        )
        assert np.isfinite(fidelity_report(wide, asked).contrast_kept[0])
    with pytest.raises(InputError, match="no pass shows 4 periods"):
        fidelity_report(stroke, [3.999 / length, 500.0])


def bad_texture(x, y, v, t):  # type: ignore[no-untyped-def]
    return x * np.nan


def rendered(**changed):  # type: ignore[no-untyped-def]
    return rendered_stroke(GRATING, STROKE, ENVELOPE, friction, **changed)


@pytest.mark.parametrize(("ask", "word"), [
    (lambda: rendered(control_rate=0.0), "control_rate"),
    (lambda: rendered(control_rate=1e-3), "longer or slower"),
    (lambda: rendered(control_rate=1e9), "steps of"),
    (lambda: rendered(compensation="?"), "compensation"),  # type: ignore[arg-type]
    (lambda: rendered_stroke(bad_texture, STROKE, ENVELOPE, friction), "texture"),
    (lambda: rendered_stroke(GRATING, STROKE, ENVELOPE, lambda a, v: a[:-1]), "relative_friction"),
    (lambda: fidelity_report(rendered_stroke(GRATING, Stroke(0.1, 5e-4), ENVELOPE, friction)),
     "settled"),
    (lambda: fidelity_report(rendered_stroke(GRATING, STROKE, ENVELOPE, lambda a, v: 1 + 0 * a)),
     "does not change"),
    (lambda: fidelity_report(rendered(), []), "list"),
    (lambda: fidelity_report(rendered(), [-1.0]),
     "above 0"),
    (lambda: fidelity_report(rendered(), [10.0]),
     "4 periods"),
])  # fmt: skip
def test_senseless_requests_are_refused(ask: object, word: str) -> None:
    with pytest.raises(InputError, match=word):
        ask()  # type: ignore[operator]
