"""Laws that hold for every grating, stroke and resonator."""

import math

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
    fastest_speed,
    finest_period,
    sine_swing_kept,
)
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SineWave, SquareWave

periods = st.floats(1e-4, 0.05)
speeds = st.floats(1e-3, 1.0)
taus = st.floats(1e-5, 1e-2)
shares = st.floats(0.01, 0.999)
positions = st.floats(-0.2, 0.2)
phases = st.floats(-10, 10)
shapes = st.sampled_from(["square", "sine"])


@st.composite
def gratings(draw: st.DrawFn) -> Amplitude:
    low = draw(st.floats(0, 1e-6))
    high = low + draw(st.floats(1e-9, 5e-6))
    period, phase = draw(periods), draw(phases)
    if draw(st.booleans()):
        return Amplitude(SineWave(period, phase), low, high)
    return Amplitude(SquareWave(period, draw(st.floats(0.05, 0.95)), phase), low, high)


def near_an_edge(texture: Amplitude, x: float) -> bool:
    """Whether rounding may put x on the other side of an edge of a square."""
    wave = texture.pattern
    if not isinstance(wave, SquareWave):
        return False
    cycle = (x / wave.spatial_period + wave.phase / (2 * math.pi)) % 1.0
    return min(cycle, 1 - cycle, abs(cycle - wave.duty)) < 1e-9


@given(gratings(), positions, st.integers(-50, 50))
def test_a_grating_repeats_after_whole_periods(texture: Amplitude, x: float, n: int) -> None:
    assume(not near_an_edge(texture, x))
    here = texture(x, 0.0, 0.1, 0.0)
    there = texture(x + n * (texture.spatial_period or 0.0), 0.0, 0.1, 0.0)
    assert abs(there - here) <= 1e-6 * (texture.high - texture.low)


@given(gratings(), st.lists(positions, min_size=1))
def test_a_grating_stays_between_low_and_high(texture: Amplitude, x: list[float]) -> None:
    values = texture(np.array(x), 0.0, 0.1, 0.0)
    assert np.all(values >= texture.low * (1 - 1e-15))
    assert np.all(values <= texture.high * (1 + 1e-15))


@given(gratings(), positions, st.floats(-1, 1), st.floats(0, 1), st.floats(0, 1))
def test_a_grating_depends_on_x_alone(
    texture: Amplitude, x: float, y: float, v: float, t: float
) -> None:
    assert texture(x, y, v, t) == texture(x, 0.0, 0.0, 0.0)


@given(periods, speeds, taus, st.floats(1.001, 10))
def test_a_faster_finger_keeps_less(period: float, speed: float, tau: float, faster: float) -> None:
    slow, fast = (sine_swing_kept(period, v, tau) for v in (speed, speed * faster))
    assert 0 < fast <= slow <= 1
    assert fast < slow or slow > 1 - 1e-12


@given(speeds, taus, shares)
def test_finest_period_and_fastest_speed_are_inverses(
    speed: float, tau: float, kept: float
) -> None:
    period = finest_period(speed, tau, kept)
    assert math.isclose(fastest_speed(period, tau, kept), speed, rel_tol=1e-12)
    assert math.isclose(math.tanh(period / (4 * speed * tau)), kept, rel_tol=1e-9)


commands = st.lists(st.floats(0, 1e-5), min_size=1, max_size=40)


@given(commands, st.floats(0, 1e-5), st.floats(1e-6, 1e-1), taus)
def test_a_response_never_leaves_the_range_of_what_drives_it(
    command: list[float], initial: float, step: float, tau: float
) -> None:
    response = DrivenEnvelope(tau, tau, 1e-5).response(np.array(command), step, initial)
    assert response[0] == initial
    assert np.all(response >= min(*command, initial) - 1e-18)
    assert np.all(response <= max(*command, initial) + 1e-18)


@given(speeds, st.floats(1e-3, 0.3), st.integers(1, 6), st.floats(-1, 1), st.floats(0, 1))
def test_a_stroke_stays_on_its_line_and_moves_at_its_speed(
    speed: float, length: float, passes: int, start: float, when: float
) -> None:
    stroke = Stroke(speed, length, passes, start)
    first, second = when * stroke.duration, min(1.0, when + 1e-3) * stroke.duration
    here, there = stroke.position(np.array([first, second]))
    for x in (here, there):
        assert start - 1e-12 <= x <= start + length + 1e-12
    assert abs(there - here) <= speed * (second - first) + 1e-12


@given(speeds, st.floats(1e-3, 0.3), st.floats(0, 1))
def test_there_and_back_is_the_same_way(speed: float, length: float, when: float) -> None:
    stroke = Stroke(speed, length, passes=2)
    t = when * stroke.pass_duration
    back = max(0.0, stroke.duration - t)
    assert math.isclose(stroke.position(t), stroke.position(back), abs_tol=1e-12)
