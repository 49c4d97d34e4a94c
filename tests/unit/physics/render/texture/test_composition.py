"""Textures: values, quantities, polarity, and every mixture that is refused."""

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.texture.composition import Masked, Sequence, Sum
from squeezefilm.physics.render.texture.levels import Amplitude, FrictionReduction, RelativeFriction
from squeezefilm.physics.render.texture.shapes import (
    Band,
    Constant,
    Ramp,
    SineWave,
    SquareWave,
    speed,
)

GRATING = RelativeFriction(SquareWave(2e-3), 0.4, 0.9)


def at(texture: object, x: object, v: float = 0.1) -> list:
    return texture(np.asarray(x, dtype=float), 0.0, v, 0.0).tolist()


def test_levels_stand_where_the_pattern_is_0_and_1() -> None:
    assert at(GRATING, [0.5e-3, 1.5e-3]) == [0.9, 0.4]
    assert at(Amplitude(Ramp(0, 1e-2), 1e-6, 3e-6), [0, 5e-3, 1e-2]) == pytest.approx(
        [1e-6, 2e-6, 3e-6]
    )
    assert at(FrictionReduction.constant(0.2), [1.0]) == [0.2]


def test_the_quantity_is_known_of_every_composite() -> None:
    reduction = FrictionReduction(SquareWave(2e-3), 0.1, 0.3)
    for made in (GRATING, GRATING * 0.5, GRATING & Band(0, 0.01), GRATING.then(GRATING, at=0.1)):
        assert made.quantity == "relative_friction"
    assert (reduction + reduction).quantity == "friction_reduction"
    assert Amplitude(SineWave(2e-3), 0.0, 1e-6).quantity == "amplitude"


def test_what_is_masked_is_the_plate_at_rest() -> None:
    band = Band(0.0, 0.01)
    assert at(GRATING & band, [-0.5e-3, 0.5e-3, 1.5e-3, 0.0205]) == [1.0, 0.9, 0.4, 1.0]
    assert at(GRATING * band, [-0.5e-3, 0.5e-3]) == [0.0, 0.9]
    assert at(Amplitude(SquareWave(2e-3), 1e-6, 2e-6) & band, [-0.5e-3, 0.5e-3]) == [0.0, 2e-6]
    fast = GRATING.when(speed > 0.05)
    assert at(fast, [1.5e-3], v=0.1) == [0.4]
    assert at(fast, [1.5e-3], v=-0.01) == [1.0]


def test_one_after_another() -> None:
    a, b, c = (RelativeFriction.constant(value) for value in (0.2, 0.4, 0.8))
    chain = a.then(b, at=0.01).then(c, at=0.02)
    assert chain == Sequence((a, b, c), (0.01, 0.02))
    assert at(chain, [0.0, 0.01, 0.015, 0.02]) == [0.2, 0.4, 0.4, 0.8]
    faded = a.then(b, at=0.01, fade=2e-3)
    assert at(faded, [0.009, 0.01, 0.0105]) == pytest.approx([0.2, 0.3, 0.35])
    # Cutting off before an edge that is there already.
    assert at(chain.then(a, at=0.015), [0.0, 0.012, 0.016, 0.03]) == [0.2, 0.4, 0.2, 0.2]


def test_sums_add_values() -> None:
    total = (
        Amplitude.constant(1e-6)
        + Amplitude(SquareWave(2e-3), 0.0, 1e-6)
        + Amplitude.constant(0.5e-6)
    )
    assert at(total, [0.5e-3, 1.5e-3]) == pytest.approx([2.5e-6, 1.5e-6])
    assert len(total.textures) == 3


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (
            lambda: GRATING + Amplitude.constant(1e-6),
            "a sum cannot mix relative_friction and amplitude",
        ),
        (lambda: GRATING.then(Amplitude(SquareWave(1e-3), 0, 1e-6), at=0), "sequence cannot mix"),
        (lambda: GRATING + FrictionReduction.constant(0.1), "and friction_reduction"),
        (lambda: GRATING + 0.1, "has no quantity"),
        (lambda: 0.1 + GRATING, "has no quantity"),
        (lambda: GRATING + Constant(), "has no quantity"),
        (lambda: Constant() + GRATING, "cannot be added"),
        (lambda: GRATING * GRATING, "has no quantity"),
        (lambda: GRATING * -1.0, "factor = -1"),
        (lambda: GRATING & GRATING, "can be no mask"),
        (lambda: Masked(Constant(), Constant()), "no texture with a quantity"),
        (lambda: Sum(()), "sum of 0 textures"),
        (lambda: Sum((GRATING,) * 65), "sum of 65 textures"),
        (lambda: Sequence((GRATING,), (0.1,)), "needs 0 edges"),
        (lambda: Sequence((GRATING,) * 3, (0.1, 0.1)), "must rise"),
        (lambda: Sequence((GRATING,) * 2, (11.0,)), "at most 10 m"),
        (lambda: Sequence((GRATING,) * 3, (0.1, 0.11), fade=0.02), "fade = 20 mm"),
        (lambda: RelativeFriction(SquareWave(1e-3), 0.4, 1.1), "high = 1.1"),
        (lambda: RelativeFriction(SquareWave(1e-3), -0.1, 1.0), "low = -0.1"),
        (lambda: RelativeFriction(GRATING, 0.1, 1.0), "is no pattern"),
        (lambda: Amplitude(SquareWave(1e-3), 0.0, 2.0), "at most 1 mm"),
        (lambda: Amplitude(SquareWave(1e-3), 2e-6, 1e-6), "complement the pattern"),
        (lambda: FrictionReduction.constant(11.0), "low = 11"),
    ],
)
def test_what_makes_no_texture_is_refused(make: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()
    with pytest.raises(TypeError):
        _ = GRATING * "twice"
