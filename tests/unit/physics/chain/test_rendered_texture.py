"""A texture rendered on a stator: every link against a closed form, and what is refused."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.chain import standing_wave
from squeezefilm.physics.chain.played_texture import lowered
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.chain.rendered_texture import (
    CONTROL_RATE,
    RenderAnalysis,
    render_texture,
)
from squeezefilm.physics.chain.standing_wave import WAVES, UnderPad, wave_factors
from squeezefilm.physics.contact.finger.fingertip import EXPLORING_SPEED
from squeezefilm.physics.contact.sliding.march import SpeedFriction
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.fidelity.report import strongest_lines
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ
from squeezefilm.physics.render.motion.stroke import FingerPath, Stroke
from squeezefilm.physics.render.texture.image import Image
from squeezefilm.physics.render.texture.levels import Amplitude, FrictionReduction, RelativeFriction
from squeezefilm.physics.render.texture.pattern import AlongDirection
from squeezefilm.physics.render.texture.shapes import Constant, SineWave, SquareWave
from squeezefilm.physics.texture_files.texture_file import TextureFile

STATOR = load_display("biet2008-stator")
RATE = 4e3
STROKE = Stroke(0.1, 40e-3, 2)
TAU = 200 / (math.pi * 40.5e3)
GRATING = TextureFile(RelativeFriction(SquareWave(4e-3), 0.7, 1.0), "Square")
EVEN = RelativeFriction(Constant(), 0.85, 0.85)
MICROMETRE = Amplitude.constant(1e-6)


@functools.cache
def point() -> Prediction:
    """The stator at its own voltage."""
    return predict(STATOR)


def law_at_the_strokes_speed(amplitude: Any) -> Any:
    return point().law.over_speeds(np.atleast_1d(amplitude), np.array([STROKE.speed]))[0]


@functools.cache
def made(
    texture: Any = GRATING, motion: Any = STROKE, wave: str = "ignored", **others: Any
) -> RenderAnalysis:
    return render_texture(STATOR, texture, motion, wave=wave, **{"control_rate": RATE, **others})


def test_what_is_asked_is_the_grating_at_the_finger() -> None:
    found = made()
    groove = (found.finger.x / 4e-3) % 1.0 < 0.5
    edges = np.abs((found.finger.x / 2e-3 + 0.5) % 1.0 - 0.5) < 1e-9
    assert np.array_equal(found.asked[~edges], np.where(groove, 1.0, 0.7)[~edges])
    wanted = found.stroke.relative_friction_wanted
    assert wanted == pytest.approx(found.asked, abs=1e-3)
    miss = found.stroke.relative_friction_rendered - found.asked
    assert found.rms_error == pytest.approx(math.sqrt(float(np.mean(miss**2))))
    assert 0.01 < found.rms_error < 0.15


def test_the_envelope_closes_in_with_the_resonators_time_constant() -> None:
    found = made()
    assert found.time_constant == pytest.approx(TAU)
    envelope = found.stroke.envelope
    assert envelope.fall_time_constant == found.time_constant
    assert envelope.amplitude_limit == point().vibration_amplitude
    a, target = found.stroke.amplitude, found.stroke.command[:-1]
    assert a[1:] == pytest.approx(target + (a[:-1] - target) * math.exp(-1 / RATE / TAU))
    assert found.stroke.control_rate == RATE
    assert CONTROL_RATE == 192e3 / 10


def test_an_even_amplitude_gives_the_friction_law_there() -> None:
    found = made(MICROMETRE)
    law = float(law_at_the_strokes_speed(1e-6)[0])
    # The stroke is faster than the speed of the prediction, and so stickier.
    assert law > point().law.at(1e-6) + 0.005
    for friction in (found.asked, found.stroke.relative_friction_rendered):
        assert friction == pytest.approx(law, abs=2e-3)
    assert np.all(found.factor == 1.0)


def test_a_stroke_too_short_to_judge_says_so() -> None:
    # Fifteen time constants are 23.6 ms.
    found = made(motion=Stroke(0.1, 2e-3))
    assert found.fidelity is None
    data = found.summary()
    assert data["not_judged_because"] == found.unjudged
    assert str(found.unjudged).startswith("the stroke of 0.02 s ends before its start has settled")
    for key in ("contrast_kept", "spatial_frequency_per_m", "lag_m", "lag_s", "fidelity"):
        assert data[key] is None
    assert made().unjudged is None


def test_a_reduction_is_taken_from_the_coefficient_at_rest() -> None:
    found = made(FrictionReduction(SquareWave(4e-3), 0.0, 0.18))
    assert point().friction_coefficient == 0.9
    assert {round(float(one), 12) for one in found.asked} == {1.0, 0.8}
    assert np.min(found.stroke.relative_friction_wanted) == pytest.approx(0.8, abs=1e-3)


def test_a_texture_beyond_reach_is_asked_whole_and_counted() -> None:
    least = made().summary()["least_relative_friction"]
    law = float(law_at_the_strokes_speed(point().vibration_amplitude)[0])
    assert least == pytest.approx(law, abs=point().inverse.max_error)
    found = made(RelativeFriction(SquareWave(4e-3), 0.1, 1.0))
    assert np.min(found.asked) == pytest.approx(0.1)
    assert np.min(found.stroke.relative_friction_wanted) == pytest.approx(least, abs=1e-6)
    beyond = int(np.count_nonzero(found.asked < least))
    data = found.summary()
    assert data["unreachable_samples"] == beyond > 1000
    assert data["unreachable"] == {
        "stickier_than_at_rest": 0, "slipperier_than_the_display": beyond, "amplitude_below_0": 0,
        "amplitude_above_the_largest": 0,
    }  # fmt: skip
    assert np.max(found.stroke.amplitude) <= point().vibration_amplitude * (1 + 1e-9)


def test_the_wave_is_felt_where_it_is_not_made_up_for() -> None:
    assert WAVES == ("ignored", "felt", "compensated")
    wave = wave_factors(STATOR, point())
    found = made(MICROMETRE, wave="felt")
    # The display's law has the pad at the best place, which is no antinode.
    expected = wave.factor(found.finger.x)
    assert found.factor[0] < 0.9
    assert found.factor == pytest.approx(expected)
    assert np.ptp(found.factor) > 0.1
    law = law_at_the_strokes_speed(1e-6 * expected[::400])
    assert found.stroke.relative_friction_rendered[::400] == pytest.approx(law, abs=2e-3)
    assert found.asked == pytest.approx(float(law_at_the_strokes_speed(1e-6)[0]), abs=2e-3)
    data = found.summary()
    assert data["wave_least_factor"] == np.min(found.factor)
    assert data["wave_greatest_factor"] == np.max(found.factor)
    assert found.stroke.model.endswith("position known; standing wave felt")


def test_a_compensated_wave_leaves_an_even_texture_even() -> None:
    motion = Stroke(EXPLORING_SPEED, 40e-3, 2)
    friction = made(EVEN, motion, wave="compensated")
    felt = made(EVEN, motion, wave="felt").stroke.relative_friction_rendered
    rendered = friction.stroke.relative_friction_rendered
    # What the wave leaves was found at the prediction's amplitude, and the texture asks for less.
    assert rendered == pytest.approx(0.85, abs=7e-3)
    assert np.ptp(rendered) < np.ptp(felt) / 4
    assert friction.asked == pytest.approx(0.85)
    assert friction.stroke.relative_friction_wanted == pytest.approx(0.85, abs=1e-3)
    # The amplitude of an even one is that at the best place, less than over the antinode at x = 0.
    amplitude = made(MICROMETRE, motion, wave="compensated")
    best = float(point().law.at(1e-6))
    assert amplitude.asked == pytest.approx(best, abs=2e-3)
    assert amplitude.stroke.relative_friction_rendered == pytest.approx(best, abs=9e-3)
    assert "standing wave" not in made(MICROMETRE).stroke.model


def test_the_force_is_friction_times_load_once_the_pad_slides() -> None:
    found = made(EVEN)
    assert found.force.friction_force[1200] == pytest.approx(0.9 * 0.85 * 0.5, rel=2e-3)
    harder = made(EVEN, normal_force=0.25)
    assert harder.prediction.normal_force == 0.25
    assert harder.force.friction_force[1200] == pytest.approx(0.9 * 0.85 * 0.25, rel=2e-3)
    data = found.summary()
    forces = np.abs(found.force.friction_force)
    assert data["tangential_force_mean_N"] == pytest.approx(float(np.mean(forces)))
    assert data["tangential_force_largest_N"] == float(np.max(forces))
    assert found.force.friction_force[2500] < 0  # on the way back


def test_the_summary_says_what_was_done() -> None:
    found = made(seed=5, surface="bare", voltage=100.0, model="partial-levitation")
    data = found.summary()
    assert {key: data[key] for key in (
        "display", "texture", "quantity", "surface", "voltage_V", "normal_force_N", "samples",
        "control_rate_Hz", "sensor", "compensation", "braking", "wave", "wave_least_factor",
    )} == {
        "display": "biet2008-stator", "texture": "Square", "quantity": "relative_friction",
        "surface": "bare", "voltage_V": 100.0, "normal_force_N": 0.5, "samples": 3201,
        "control_rate_Hz": RATE, "sensor": None, "compensation": "none", "braking": False,
        "wave": "ignored", "wave_least_factor": 1.0,
    }  # fmt: skip
    assert data["largest_amplitude_m"] == pytest.approx(2e-6 * 100 / 140)
    assert data["resonance_frequency_Hz"] == pytest.approx(40.5e3)
    assert data["quality_factor"] == pytest.approx(200)
    assert data["envelope_time_constant_s"] == pytest.approx(TAU)
    assert data["duration_s"] == pytest.approx(0.8)
    assert data["way_m"] == pytest.approx(0.08)
    assert data["mean_speed_m_per_s"] == pytest.approx(0.1, rel=1e-3)
    assert data["asked_friction_mean"] == pytest.approx(0.85, abs=2e-3)
    assert data["asked_friction_rms_swing"] == pytest.approx(0.15, abs=1e-4)
    rendered = found.stroke.relative_friction_rendered
    assert data["rendered_friction_mean"] == pytest.approx(float(rendered.mean()))
    assert data["rendered_friction_rms_swing"] == pytest.approx(float(rendered.std()))
    assert 0.05 < data["rendered_friction_rms_swing"] < 0.15
    assert data["spatial_frequency_per_m"] == pytest.approx([250, 750, 1250])
    first, third, fifth = data["contrast_kept"]
    assert 1 > first > third > fifth > 0
    assert data["lag_s"] == pytest.approx(data["lag_m"] / 0.1, rel=1e-3)
    assert data["model"]["friction"] == "partial-levitation"
    assert data["provenance"]["seed"] == 5
    assert data["fidelity"]["wanted_swing"] == pytest.approx(0.3, abs=2e-3)
    assert made(EVEN).summary()["texture"] == "relative_friction"
    assert repr(made(EVEN).played) == "a texture of relative_friction"


def test_the_origin_changes_with_each_input() -> None:
    hashes = {
        one.provenance()["config_sha256"]
        for one in (made(), made(EVEN), made(EVEN, Stroke(0.1, 40e-3, 3)))
    }
    assert len(hashes) == 3


def test_drive_and_sensor_are_those_asked_for() -> None:
    seen = made(sensor="lvdt-10-khz", seed=3, compensation="inverse", braking=True)
    assert seen.stroke.sensor is LVDT_10_KHZ
    assert seen.stroke.seed == 3
    assert (seen.stroke.compensation, seen.stroke.envelope.braking) == ("inverse", True)
    assert seen.rms_error < made().rms_error
    assert made(sensor=LVDT_10_KHZ).stroke.sensor is LVDT_10_KHZ
    names = list(made().columns())
    assert names == [
        "time_s", "position_x_m", "position_y_m", "speed_m_per_s", "relative_friction_asked",
        "relative_friction_rendered", "amplitude_wanted_m", "amplitude_commanded_m", "amplitude_m",
        "wave_factor", "tangential_force_N", "sticking",
    ]  # fmt: skip
    assert list(seen.columns()) == [*names, "estimated_way_m", "estimated_speed_m_per_s"]
    assert seen.columns()["estimated_way_m"] == pytest.approx(seen.finger.x, abs=1e-3)
    assert all(column.shape == (3201,) for column in seen.columns().values())
    assert seen.summary()["sensor"] == "LVDT 10 kHz"


def test_a_pass_of_five_periods_is_judged_at_its_period() -> None:
    assert made(motion=Stroke(0.1, 19e-3)).played.spatial_period is None
    assert made(motion=Stroke(0.1, 20.001e-3)).played.spatial_period == 4e-3
    slanted = FingerPath(np.array([0.0, 1.0]), np.array([0.0, 0.03]), np.array([0.0, 0.0]))
    assert made(motion=slanted).played.spatial_period == 4e-3


def test_a_slanted_grating_is_judged_at_its_strongest_line() -> None:
    found = made(RelativeFriction(SineWave(2e-3, along=AlongDirection(math.pi / 3)), 0.7, 1.0))
    assert found.played.spatial_period is None
    assert found.fidelity is not None
    assert found.fidelity.spatial_frequency == pytest.approx([250.0], rel=1e-6)


WAY = np.linspace(0.0, 40e-3, 1500)


def strongest(way: Any, *strengths: tuple[int, float], period: float | None = None) -> Any:
    wanted = 0.8 + sum(0.01 * a * np.sin(2 * math.pi * n * way / 40e-3) for n, a in strengths)
    stroke = dataclasses.replace(
        made().stroke, position=way, relative_friction_wanted=np.asarray(wanted)
    )
    return strongest_lines(stroke, period)


def test_the_strongest_lines_of_the_first_pass_are_found() -> None:
    assert strongest(WAY, (30, 1.0), (10, 1.0)) == pytest.approx([250.0, 750.0])
    assert strongest(WAY[::-1] + 1.0, (10, 1.0)) == pytest.approx([250.0])
    # A hundredth of the strongest in power is a tenth in swing.
    assert strongest(WAY, (10, 1.0), (20, 0.12)) == pytest.approx([250.0, 500.0])
    assert strongest(WAY, (10, 1.0), (20, 0.08)) == pytest.approx([250.0])
    eight = [(10 * n, 1.0 + (n in (3, 8)) - 0.5 * (n in (1, 5))) for n in range(1, 9)]
    assert strongest(WAY, *eight) == pytest.approx([500, 750, 1000, 1500, 1750, 2000])
    # Fewer than seven periods a pass would be lost with the start, and are no line here.
    assert strongest(WAY, (7, 1.0)) == pytest.approx([175.0])
    assert strongest(WAY, (6, 1.0)) is None
    assert strongest(WAY, (6, 1.0), (12, 0.2)) == pytest.approx([300.0])


def test_later_passes_and_what_others_know_are_left_out() -> None:
    there_and_back = np.concatenate([WAY, WAY[-2::-1]])
    stroke = dataclasses.replace(
        made().stroke,
        position=there_and_back,
        relative_friction_wanted=np.concatenate(
            [np.sin(500 * math.pi * WAY), np.sin(1500 * math.pi * WAY[-2::-1])]
        ),
    )
    assert strongest_lines(stroke, None) == pytest.approx([250.0], rel=1e-3)
    assert strongest(WAY, (10, 1.0), period=4e-3) is None
    assert strongest(WAY[:63], (10, 1.0)) is None
    assert strongest(np.linspace(0, 40e-3, 64), (10, 1.0)) is not None
    assert strongest(np.zeros(100), (10, 1.0)) is None


def test_a_program_knows_the_quantity_and_the_largest_amplitude() -> None:
    for texture in (EVEN, MICROMETRE, FrictionReduction(Constant(), 0.1, 0.1)):
        program = lowered(TextureFile(texture), point(), point().inverse)
        assert program.quantity == texture.quantity
        assert program.largest_amplitude == point().vibration_amplitude


def test_each_step_is_told() -> None:
    told: list[str] = []
    render_texture(STATOR, GRATING, STROKE, control_rate=RATE, progress=told.append)
    assert told == [
        "the display at its largest amplitude", "the loop along the stroke", "tangential force",
    ]  # fmt: skip


PICTURE = Image(((0.0, 1.0), (1.0, 0.0)), 1e-3)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"compensation": "inverted"}, "compensation = 'inverted' is not known. Did you mean 'inv"),
        ({"wave": "fel"}, "wave = 'fel' is not known. Did you mean 'felt'? Allowed: ignored, "),
        ({"sensor": "eye"}, "the sensor 'eye' is not known"),
        ({"place": (30e-3, 1e-3), "wave": "felt"}, "place keeps the finger at one place of the"),
        ({"voltage": 0.0}, "display 'biet2008-stator' changes no friction at 0 V, so it renders"),
        ({"motion": FingerPath(np.array([0.0, 1.0]), np.array([0.0, 0.0]), np.array([0.0, 0.01]))},
         "a stator renders along its circumference"),
        ({"texture": RelativeFriction(PICTURE, 0.7, 1.0)}, "the stroke leaves the image: at"),
    ],
)  # fmt: skip
def test_what_cannot_be_rendered_is_refused(changes: dict[str, Any], says: str) -> None:
    arguments = {"texture": GRATING, "motion": STROKE, "control_rate": RATE, **changes}
    with pytest.raises(InputError) as caught:
        render_texture(STATOR, **arguments)
    assert str(caught.value).startswith(says)


def test_an_even_texture_has_no_fidelity_to_judge() -> None:
    found = render_texture(
        load_display("biet2008-stator"), Amplitude.constant(1e-6),
        "100 mm/s over 4 cm, 2 passes", control_rate=4e3,
    )  # fmt: skip
    assert np.ptp(found.stroke.relative_friction_wanted) == 0.0
    assert found.fidelity is None
    assert "does not change along the stroke" in str(found.unjudged)


def test_a_long_stroke_takes_fewer_speeds_of_the_skin(monkeypatch: pytest.MonkeyPatch) -> None:
    display = load_display("biet2008-stator")
    p = predict(display)
    under = UnderPad.of(display, p, "ignored")
    amplitude = np.linspace(0.0, p.vibration_amplitude, 200)
    whole = under.of_the_skin(amplitude, 0.9)
    assert isinstance(whole, SpeedFriction)
    assert np.array_equal(whole.speed, p.friction.speed)
    monkeypatch.setattr(standing_wave, "_MOST_FRICTIONS", 2400)
    fewer = under.of_the_skin(amplitude, 0.9)
    assert isinstance(fewer, SpeedFriction)
    assert fewer.speed.size == 12
    assert set(fewer.speed) < set(whole.speed)
    assert fewer.speed[[0, -1]].tolist() == whole.speed[[0, -1]].tolist()
    # Between the speeds left it is a line, and never far from the law.
    slow = [np.interp(0.08, one.speed, one.coefficient[-1]) for one in (whole, fewer)]
    assert slow[1] == pytest.approx(slow[0], rel=0.05)
