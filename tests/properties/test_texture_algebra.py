"""The laws of patterns and textures."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from squeezefilm.physics.render.texture.composition import AT_REST, Composable
from squeezefilm.physics.render.texture.pattern import AlongDirection, AlongY, Pattern
from squeezefilm.physics.render.texture.shapes import Constant, SineWave, SquareWave

from .texture_strategies import (
    any_textures,
    duties,
    patterns,
    phases,
    places,
    quantities,
    textures,
    widths,
)

RNG = np.random.default_rng(5)
WHERE = (
    RNG.uniform(-0.06, 0.06, 60),
    RNG.uniform(-0.06, 0.06, 60),
    RNG.uniform(-0.4, 0.4, 60),
    RNG.uniform(0.0, 2.0, 60),
)
NOTHING, ALL = Constant(0.0), Constant(1.0)

laws = settings(settings.get_profile("dear"))


def same(a: Pattern | Composable, b: Pattern | Composable) -> bool:
    return bool(np.array_equal(a(*WHERE), b(*WHERE)))


def near(a: Pattern | Composable, b: Pattern | Composable) -> bool:
    # To the rounding of a number of order 1, or of micrometres.
    unit = 1e-6 if isinstance(a, Composable) and a.quantity == "amplitude" else 1.0
    return bool(np.allclose(a(*WHERE), b(*WHERE), rtol=1e-12, atol=4e-15 * unit))


@given(patterns)
@laws
def test_a_pattern_stays_between_0_and_1_and_its_complement_too(a: Pattern) -> None:
    values = a(*WHERE)
    assert values.shape == (60,)
    assert np.all((values >= 0.0) & (values <= 1.0))
    assert near(~~a, a)
    assert (~a)(*WHERE) == pytest.approx(1.0 - values, abs=1e-15)


@given(patterns, patterns, patterns)
@laws
def test_and_or_make_a_distributive_lattice(a: Pattern, b: Pattern, c: Pattern) -> None:
    assert same(a & b, b & a)
    assert same(a | b, b | a)
    assert (a & b) & c == a & (b & c)
    assert (a | b) | c == a | (b | c)
    assert same(a & a, a)
    assert same(a | a, a)
    assert same(a & (a | b), a)
    assert same(a | (a & b), a)
    assert same(a & (b | c), (a & b) | (a & c))
    assert same(a | (b & c), (a | b) & (a | c))
    assert same(a & ALL, a)
    assert same(a | NOTHING, a)
    assert near(~(a & b), ~a | ~b)
    assert near(~(a | b), ~a & ~b)


@given(patterns, patterns, patterns)
@laws
def test_products_of_patterns(a: Pattern, b: Pattern, c: Pattern) -> None:
    assert near(a * b, b * a)
    assert (a * b) * c == a * (b * c)
    assert same(a * ALL, a)
    assert same(a * NOTHING, NOTHING)
    assert near(a * (b | c), (a * b) | (a * c))
    assert near(a * (b & c), (a * b) & (a * c))


@st.composite
def three_alike(draw: st.DrawFn) -> tuple[Composable, Composable, Composable]:
    kind = textures(draw(quantities), max_leaves=2)
    return draw(kind), draw(kind), draw(kind)


@given(three_alike(), patterns)
@laws
def test_sums_and_products_of_textures(
    three: tuple[Composable, Composable, Composable], m: Pattern
) -> None:
    a, b, c = three
    assert near(a + b, b + a)
    assert (a + b) + c == a + (b + c)
    assert near((a + b) * m, a * m + b * m)
    assert near((a + b) * 0.5, a * 0.5 + b * 0.5)
    assert same(a * ALL, a)
    assert same(a * 1.0, a)
    assert m * a == a * m
    assert 0.5 * a == a * 0.5
    assert near((a * m) * 0.5, (a * 0.5) * m)


@given(any_textures, patterns, patterns)
@laws
def test_masks_fade_to_the_plate_at_rest(a: Composable, m: Pattern, n: Pattern) -> None:
    rest = AT_REST[a.quantity]
    assert same(a & ALL, a)
    assert np.all((a & NOTHING)(*WHERE) == rest)
    assert near((a & m) & n, a & (m * n))
    assert a.mask(m) == a.when(m) == a & m
    if rest == 0.0:
        assert near(a & m, a * m)
    # What one mask lets through the other holds back.
    both = (a & m)(*WHERE) + (a & ~m)(*WHERE)
    assert both == pytest.approx(a(*WHERE) + rest, rel=1e-9, abs=1e-18)
    assert (a & m).quantity == a.quantity


@given(three_alike(), st.lists(places, min_size=2, max_size=2, unique=True))
@laws
def test_sequences_are_what_they_join_and_chain(
    three: tuple[Composable, Composable, Composable], edges: list[float]
) -> None:
    a, b, c = three
    first, second = sorted(edges)
    assume(second - first > 1e-6)
    found = a.then(b, at=first).then(c, at=second)(*WHERE)
    x = WHERE[0]
    wanted = np.where(x < first, a(*WHERE), np.where(x < second, b(*WHERE), c(*WHERE)))
    assert np.array_equal(found, wanted)


@given(widths, duties, phases, st.sampled_from([None, "y", 0.3, 2.0]), st.integers(-9, 9))
@laws
def test_gratings_repeat_along_their_direction_and_not_across(
    period: float, duty: float, phase: float, way: object, n: int
) -> None:
    angle = {None: 0.0, "y": math.pi / 2}.get(way, way)  # type: ignore[call-overload]
    more = {} if way is None else {"along": AlongY() if way == "y" else AlongDirection(way)}
    x, y, v, t = WHERE
    for wave in (SineWave(period, phase, **more), SquareWave(period, duty, phase, **more)):
        here = wave(x, y, v, t)
        step = n * period
        there = wave(x + step * math.cos(angle), y + step * math.sin(angle), v, t)
        across = wave(x - 0.7 * math.sin(angle), y + 0.7 * math.cos(angle), v, t)
        if isinstance(wave, SineWave):
            assert there == pytest.approx(here, abs=1e-9)
            assert across == pytest.approx(here, abs=2e-10 / period)
        else:
            # Rounding may carry a place across an edge; no more than that.
            s = (x * math.cos(angle) + y * math.sin(angle)) / period + phase / (2 * math.pi)
            clear = np.abs(np.mod(s + duty / 2, 1.0) - duty / 2) > 1e-9
            clear &= np.abs(np.mod(s, 1.0) - duty) > 1e-9
            clear &= np.mod(s, 1.0) < 1 - 1e-9
            assert np.array_equal(there[clear], here[clear])
            assert np.array_equal(across[clear], here[clear])


@given(patterns, st.floats(0.01, 0.3))
@laws
def test_a_speed_scaled_pattern_is_itself_at_its_speed(a: Pattern, reference: float) -> None:
    x, y, _, t = WHERE
    scaled = a.scaled_by_speed(reference)
    assert np.array_equal(scaled(x, y, reference, t), a(x, y, reference, t))
    assert np.array_equal(scaled(2.0 * x, 2.0 * y, 2 * reference, t), a(x, y, 2 * reference, t))
