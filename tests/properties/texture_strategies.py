"""Random patterns and textures, of every class the algebra has."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from squeezefilm.physics.render.texture.composition import (
    Composable,
    Masked,
    Product,
    Scaled,
    Sequence,
    Sum,
)
from squeezefilm.physics.render.texture.image import Image, Noise, NoiseField
from squeezefilm.physics.render.texture.levels import Amplitude, FrictionReduction, RelativeFriction
from squeezefilm.physics.render.texture.pattern import (
    X_AXIS,
    AlongDirection,
    AlongY,
    Complement,
    Coordinate,
    FromPoint,
    Greatest,
    Least,
    Pattern,
    SpeedScaled,
    Times,
)
from squeezefilm.physics.render.texture.shapes import (
    Attack,
    Band,
    Bump,
    Constant,
    Decay,
    Periodic,
    Pulse,
    Ramp,
    SineWave,
    SpeedGate,
    SquareWave,
)

shares = st.floats(0.0, 1.0)
places = st.floats(-0.05, 0.05)
widths = st.floats(1e-4, 0.05)
duties = st.floats(0.05, 0.95)
phases = st.floats(-10.0, 10.0)
seeds = st.integers(0, 2**32 - 1)
octaves = st.integers(1, 4)
persistences = st.floats(0.1, 1.0)
coordinates: st.SearchStrategy[Coordinate] = st.one_of(
    st.just(X_AXIS),
    st.just(AlongY()),
    st.builds(AlongDirection, phases),
    st.builds(FromPoint, places, places),
)


@st.composite
def bands(draw: st.DrawFn) -> Band:
    start, width = draw(places), draw(widths)
    end = start + width
    fade = draw(st.just(0.0) | st.floats(1e-3, 0.99)) * (end - start)
    return Band(start, end, fade, draw(coordinates))


@st.composite
def ramps(draw: st.DrawFn) -> Ramp:
    start, width = draw(places), draw(widths)
    end = start + width * draw(st.sampled_from([-1, 1]))
    return Ramp(start, end, draw(st.sampled_from(["linear", "smooth"])), draw(coordinates))


@st.composite
def images(draw: st.DrawFn) -> Image:
    rows, columns = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    rng = np.random.default_rng(draw(seeds))
    return Image.from_array(
        rng.random((rows, columns)),
        draw(st.floats(1e-4, 0.02)),
        left=draw(places),
        bottom=draw(places),
        outside=draw(st.sampled_from(["hold", "repeat", "zero"])),
    )


@st.composite
def gates(draw: st.DrawFn) -> SpeedGate:
    low = draw(st.none() | st.floats(0.0, 0.3))
    if low is not None and draw(st.booleans()):
        return SpeedGate(above=low)
    return SpeedGate(low, (low or 0.0) + draw(st.floats(0.01, 0.3)))


generators: st.SearchStrategy[Pattern] = st.one_of(
    st.builds(Constant, shares),
    st.builds(SquareWave, widths, duties, phases, coordinates),
    st.builds(SineWave, widths, phases, coordinates),
    st.builds(Pulse, places, widths, st.sampled_from(["gaussian", "raised_cosine"]), coordinates),
    st.builds(Bump, places, widths, st.sampled_from(["bump", "hole"]), coordinates),
    st.builds(Noise, widths, seeds, octaves, persistences, coordinates),
    st.builds(NoiseField, widths, seeds, octaves, persistences),
    st.builds(Attack, st.floats(1e-3, 1.0), st.floats(0.0, 1.0)),
    st.builds(Decay, st.floats(1e-3, 1.0), st.floats(0.0, 1.0)),
    st.builds(Periodic, st.floats(0.5, 100.0), st.sampled_from(["square", "sine"]), duties, phases),
    bands(),
    ramps(),
    images(),
    gates(),
)


def _composites(inner: st.SearchStrategy[Pattern]) -> st.SearchStrategy[Pattern]:
    several = st.lists(inner, min_size=1, max_size=3).map(tuple)
    return st.one_of(
        st.builds(Complement, inner),
        st.builds(Least, several),
        st.builds(Greatest, several),
        st.builds(Times, several),
        st.builds(SpeedScaled, inner, st.floats(0.01, 0.5), st.just(0.005), st.floats(0.1, 1.0)),
    )


patterns: st.SearchStrategy[Pattern] = st.recursive(generators, _composites, max_leaves=5)


@st.composite
def levels(draw: st.DrawFn, quantity: str) -> Composable:
    low, high = sorted([draw(shares), draw(shares)])
    if quantity == "relative_friction":
        return RelativeFriction(draw(patterns), low, high)
    if quantity == "friction_reduction":
        return FrictionReduction(draw(patterns), low, high)
    if draw(st.booleans()):
        return Amplitude(draw(patterns), low * 4e-6, high * 4e-6)
    period, high = draw(widths), 1e-9 + high * 4e-6
    if draw(st.booleans()):
        return Amplitude(SquareWave(period, draw(duties), draw(phases)), low * high * 0.9, high)
    return Amplitude(SineWave(period, draw(phases)), low * high * 0.9, high)


@st.composite
def _sequences(draw: st.DrawFn, inner: st.SearchStrategy[Composable]) -> Sequence:
    parts = draw(st.lists(inner, min_size=1, max_size=3))
    steps = draw(st.lists(widths, min_size=len(parts) - 1, max_size=len(parts) - 1))
    edges = tuple((draw(places) + np.cumsum(steps)).tolist())
    least = float(np.min(np.diff(edges))) if len(edges) > 1 else 0.01
    fade = draw(st.just(0.0) | st.floats(1e-9, least))
    return Sequence(tuple(parts), edges, fade, draw(coordinates))


def textures(
    quantity: str = "relative_friction", max_leaves: int = 5
) -> st.SearchStrategy[Composable]:
    """Random composites of one quantity."""

    def composed(inner: st.SearchStrategy[Composable]) -> st.SearchStrategy[Composable]:
        return st.one_of(
            st.builds(Sum, st.lists(inner, min_size=1, max_size=3).map(tuple)),
            st.builds(Product, inner, patterns),
            st.builds(Scaled, inner, st.floats(0.0, 2.0)),
            st.builds(Masked, inner, patterns),
            _sequences(inner),
        )

    return st.recursive(levels(quantity), composed, max_leaves=max_leaves)


quantities = st.sampled_from(["amplitude", "relative_friction", "friction_reduction"])
any_textures: st.SearchStrategy[Composable] = quantities.flatmap(textures)
