"""A friction bench: strokes found, drift told from amplitude, spread between strokes kept."""

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.made_bench.strokes import PlannedStrokes, recorded_strokes

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.friction.friction_bench import (
    _Fitted,
    _levels,
    fit_friction_bench,
    sliding_strokes,
)

LEVELS = np.array([0.0, 0.5e-6, 1e-6, 2e-6])
RELATIVE = 0.2 + 0.8 * np.exp(-LEVELS / 0.8e-6)


def bench(*, mixed: bool = True, spread: float = 0.05, sweat: float = 0.0, seed: int = 2):
    random = np.random.default_rng(seed)
    number = np.repeat(np.arange(4), 8)
    if mixed:
        random.shuffle(number)
    speed = 0.07 * np.exp(0.25 * random.standard_normal(32).clip(-2, 2))
    force = 0.5 * np.exp(0.2 * random.standard_normal(32).clip(-2, 2))
    mu = 0.8 * RELATIVE[number] * (speed / 0.07) ** 0.1 * (force / 0.5) ** -0.2
    mu = mu * np.exp(spread * random.standard_normal(32) + sweat * np.linspace(-0.5, 0.5, 32))
    planned = PlannedStrokes(LEVELS[number], speed, force, mu)
    return planned, recorded_strokes(planned, random, frequency=33e3)


def test_strokes_are_found_with_what_was_planned_of_them() -> None:
    planned, recording = bench()
    found = sliding_strokes(recording)
    assert len(found.rows) == 32
    assert found.column("coefficient") == pytest.approx(planned.coefficient, rel=0.03)
    assert found.column("amplitude") == pytest.approx(planned.amplitude, abs=1e-12)
    assert found.column("speed") == pytest.approx(planned.speed, rel=0.03)
    assert found.column("force") == pytest.approx(planned.force, rel=0.03)
    assert set(found.column("direction")) == {-1.0, 1.0}
    assert 0.3 < found.used < 0.7


def test_a_stroke_whose_amplitude_changes_counts_where_it_is_even() -> None:
    _, recording = bench()
    step = recording.vibration_amplitude.copy()
    first = np.flatnonzero(recording.normal_force > 0.2)[:61]
    step[first[:60]] += 1e-6
    found = sliding_strokes(dataclasses.replace(recording, vibration_amplitude=step))
    assert found.rows[0].amplitude == pytest.approx(recording.vibration_amplitude[first[60]])


def test_friction_by_amplitude_speed_and_force_with_what_may_be_used_of_it() -> None:
    fit = fit_friction_bench(bench()[1])
    assert fit.adequacy.adequate
    assert fit.amplitudes == pytest.approx(LEVELS, abs=1e-9)
    for one, true in zip(fit.relative_friction, RELATIVE[1:], strict=True):
        assert one.value == pytest.approx(true, abs=4 * one.standard_error)
    assert fit.between_strokes == pytest.approx(0.05, rel=0.4)
    assert fit.speed_exponent is not None
    assert fit.force_exponent is not None
    assert fit.speed_exponent.interval[0] < 0.1 < fit.speed_exponent.interval[1]
    assert fit.force_exponent.interval[0] < -0.2 < fit.force_exponent.interval[1]
    first, second = fit.observations[:2]
    assert first.answer == "friction_coefficient"
    assert second.answer == "relative_friction"
    assert second.conditions["vibration_amplitude"] == pytest.approx(0.5e-6)


def test_a_finger_that_sweats_is_told_from_the_vibration_in_a_mixed_order_only() -> None:
    fit = fit_friction_bench(bench(sweat=0.5)[1])
    assert fit.adequacy.adequate
    assert fit.drift.interval[0] < 0.5 < fit.drift.interval[1]
    for one, true in zip(fit.relative_friction, RELATIVE[1:], strict=True):
        assert one.value == pytest.approx(true, abs=4 * one.standard_error)
    sorted_order = fit_friction_bench(bench(mixed=False, sweat=0.5)[1])
    assert not sorted_order.adequacy.adequate
    assert "mixed order" in sorted_order.adequacy.sentence


def test_ten_times_as_many_samples_of_the_same_strokes_tell_no_more() -> None:
    recording = bench()[1]
    fit = fit_friction_bench(recording)
    often = np.linspace(recording.time[0], recording.time[-1], 10 * recording.time.size)
    finer = type(recording)(
        often,
        *(
            np.interp(often, recording.time, column)
            for column in (
                recording.normal_force,
                recording.tangential_force,
                recording.position,
                recording.vibration_amplitude,
            )
        ),
    )
    other = fit_friction_bench(finer)
    # Amplitudes between two levels while the finger is lifted belong to no stroke.
    ratio = other.relative_friction[0].standard_error / fit.relative_friction[0].standard_error
    assert ratio == pytest.approx(1, abs=0.15)


def test_without_a_level_of_no_vibration_nothing_is_relative() -> None:
    _, recording = bench()
    always = np.maximum(recording.vibration_amplitude, 0.4e-6)
    fit = fit_friction_bench(dataclasses.replace(recording, vibration_amplitude=always))
    assert fit.relative_friction == ()
    assert fit.observations == ()
    assert len(fit.coefficients) >= 3


def test_an_amplitude_that_leaves_no_friction_is_left_out_and_said() -> None:
    _, recording = bench()
    floating = recording.vibration_amplitude == LEVELS[3]
    pull = np.where(floating, 0.0, recording.tangential_force)
    noise = 2e-3 * np.random.default_rng(6).standard_normal(pull.size)
    fit = fit_friction_bench(dataclasses.replace(recording, tangential_force=pull + noise))
    assert fit.amplitudes == pytest.approx(LEVELS[:3], abs=1e-9)
    assert "At 2 µm" in fit.adequacy.sentence
    always = dataclasses.replace(recording, tangential_force=np.abs(recording.tangential_force))
    with pytest.raises(InputError, match="zero and the sign"):
        fit_friction_bench(always)


def test_what_is_no_sliding_is_refused() -> None:
    _, recording = bench()
    still = dataclasses.replace(recording, position=np.zeros(recording.time.size))
    with pytest.raises(InputError, match="stroke"):
        fit_friction_bench(still)
    few = slice(0, 500)
    short = type(recording)(
        *(
            getattr(recording, name)[few]
            for name in (
                "time", "normal_force", "tangential_force", "position", "vibration_amplitude"
            )
        )
    )  # fmt: skip
    with pytest.raises(InputError, match="need at least"):
        fit_friction_bench(short)


def test_levels_are_told_apart_by_a_share_of_the_largest() -> None:
    levels, number = _levels(np.array([2e-6, 0.0, 1.01e-6, 0.99e-6, 2e-6, 0.01e-6]))
    assert levels == pytest.approx([0.005e-6, 1e-6, 2e-6])
    assert number.tolist() == [2, 0, 1, 1, 2, 0]
    assert _levels(np.zeros(3))[1].tolist() == [0, 0, 0]


def test_a_design_has_a_column_for_each_thing_that_varied() -> None:
    random = np.random.default_rng(3)
    known = {
        "amplitude": np.tile([0.0, 1e-6, 2e-6], 4),
        "speed": 0.07 * np.exp(0.2 * random.standard_normal(12)),
        "force": np.exp(0.3 * random.standard_normal(12)),
        "time": np.array([1.0, 2.0, 2.5, 4.0, 5.0, 5.5, 6.0, 6.25, 7.0, 7.5, 8.5, 9.0]),
        "direction": np.array([1.0, -1.0, 1.0, -1.0, 1.0, 1.0] * 2),
        "coefficient": np.exp(random.standard_normal(12)),
    }

    def design(**changes: np.ndarray) -> tuple[_Fitted, np.ndarray]:
        strokes: Any = SimpleNamespace(column=(known | changes).__getitem__, rows=range(12))
        found = _Fitted.of(strokes)
        return found, found.matrix.T

    whole, columns = design()
    assert whole.levels == pytest.approx([0.0, 1e-6, 2e-6])
    assert whole.middle["speed"] == pytest.approx(np.prod(known["speed"]) ** (1 / 12))
    assert whole.middle["force"] == pytest.approx(np.prod(known["force"]) ** (1 / 12))
    assert np.flatnonzero(whole.drifts).tolist() == [7, 8]
    share = known["amplitude"] / 2e-6
    place = (known["time"] - 5) / 4
    bend = (3 * place**2 - 1) / 2
    expected = [known["amplitude"] == level for level in (0.0, 1e-6, 2e-6)]
    for middle, name in ((whole.middle["speed"], "speed"), (whole.middle["force"], "force")):
        deviation = np.log(known[name] / middle)
        expected += [deviation, deviation * share]
    direction = known["direction"]
    expected += [place - place.mean(), bend - bend.mean(), direction - direction.mean()]
    assert columns == pytest.approx(np.array(expected, dtype=float))
    # What hardly varied has no column, and one level no share of it.
    even, columns = design(speed=np.full(12, 0.07), direction=np.ones(12))
    assert ("speed" in even.names, "force" in even.names, len(columns)) == (False, True, 7)
    assert np.flatnonzero(even.drifts).tolist() == [5, 6]
    alone, columns = design(amplitude=np.full(12, 1e-6))
    assert (alone.levels.size, len(columns)) == (1, 6)
    assert np.flatnonzero(alone.drifts).tolist() == [3, 4]
    # A level of its own for each direction.
    with pytest.raises(InputError, match="went together"):
        design(amplitude=np.tile([0.0, 1e-6], 6), direction=np.tile([1.0, -1.0], 6))
