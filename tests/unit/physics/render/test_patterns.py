"""Patterns: values at chosen places, what noise and bumps are, and every refusal."""

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.texture.image import Image, Noise, NoiseField
from squeezefilm.physics.render.texture.pattern import AlongDirection, AlongY, FromPoint, Pattern
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
    speed,
)


def along(pattern: Pattern, x: object, y: object = 0.0, v: float = 0.1, t: object = 0.0) -> list:
    return pattern(np.asarray(x, dtype=float), y, v, t).tolist()


def test_generators_at_chosen_places() -> None:
    assert along(Constant(0.3), [1.0, 2.0]) == [0.3, 0.3]
    assert along(SquareWave(4e-3, duty=0.25), [0.0, 0.9e-3, 1.1e-3, 3.9e-3, -0.1e-3]) == [
        1.0, 1.0, 0.0, 0.0, 0.0,
    ]  # fmt: skip
    assert along(SineWave(4e-3), [0.0, 1e-3, 3e-3]) == pytest.approx([0.5, 1.0, 0.0])
    for shape in ("gaussian", "raised_cosine"):
        pulse = along(Pulse(0.01, 4e-3, shape), [0.008, 0.01, 0.012])
        assert pulse == pytest.approx([0.5, 1.0, 0.5])
    assert along(Pulse(0.0, 4e-3, "raised_cosine"), [-5e-3, 4e-3]) == [0.0, 0.0]
    assert along(Ramp(0.0, 0.01), [-1.0, 0.0, 2.5e-3, 1.0]) == pytest.approx([0, 0, 0.25, 1])
    assert along(Ramp(0.01, 0.0), [-1.0, 2.5e-3, 1.0]) == pytest.approx([1, 0.75, 0])
    assert along(Ramp(0.0, 0.01, "smooth"), [2.5e-3, 5e-3]) == pytest.approx([0.15625, 0.5])


def test_bands_side_by_side_leave_no_seam_and_do_not_overlap() -> None:
    x = np.linspace(-0.01, 0.03, 401)
    first, second = Band(0.0, 0.01), Band(0.01, 0.02)
    total = first(x, 0, 0.1, 0) + second(x, 0, 0.1, 0)
    assert np.array_equal(total, Band(0.0, 0.02)(x, 0, 0.1, 0))
    faded = Band(0.0, 0.01, 2e-3)(x, 0, 0.1, 0) + Band(0.01, 0.02, 2e-3)(x, 0, 0.1, 0)
    inner = (x > 1.1e-3) & (x < 0.0189)
    assert faded[inner] == pytest.approx(np.ones(np.count_nonzero(inner)))
    disc = Band.disc(0.01, 0.02, 5e-3)
    assert along(disc, [0.01, 0.014, 0.016], 0.02) == [1.0, 1.0, 0.0]
    assert along(disc, 0.01, [0.024, 0.026]) == [1.0, 0.0]


def test_coordinates() -> None:
    ramp = [
        Ramp(0.0, 0.1, along=coordinate)
        for coordinate in (AlongY(), AlongDirection(math.pi / 4), FromPoint(0.0, 0.01))
    ]
    found = [float(one(0.03, 0.05, 0.1, 0.0)) for one in ramp]
    assert found == pytest.approx([0.5, 0.8 / math.sqrt(2), 0.5])


def test_a_bump_resists_on_the_way_up_and_helps_on_the_way_down() -> None:
    bump, hole = Bump(0.01, 2e-3), Bump(0.01, 2e-3, "hole")
    x = [-0.09, 0.008, 0.01, 0.012, 0.11]
    assert along(bump, x) == pytest.approx([0.5, 1.0, 0.5, 0.0, 0.5], abs=1e-9)
    assert along(hole, x) == pytest.approx([0.5, 0.0, 0.5, 1.0, 0.5], abs=1e-9)
    # Coming back, what was the way up is the way down.
    assert along(bump, x, v=-0.1) == along(hole, x)
    # It is the slope of a Gaussian: its running integral is that Gaussian.
    fine = np.linspace(0.0, 0.02, 4001)
    rise = np.cumsum(bump(fine, 0, 0.1, 0) - 0.5) * (fine[1] - fine[0])
    gauss = np.exp(-0.5 * ((fine - 0.01) / 2e-3) ** 2)
    assert rise / np.max(rise) == pytest.approx(gauss, abs=2e-3)


def test_noise_is_its_seed_s_and_band_limited() -> None:
    x = np.arange(2**16) * 1e-4
    noise = Noise(1e-3, 11)(x, 0, 0.1, 0)
    assert np.array_equal(noise, Noise(1e-3, 11)(x, 0, 0.1, 0))
    assert not np.array_equal(noise, Noise(1e-3, 12)(x, 0, 0.1, 0))
    assert noise.mean() == pytest.approx(0.5, abs=0.01)
    assert noise.std() == pytest.approx(0.20, abs=0.01)
    power = np.abs(np.fft.rfft((noise - noise.mean()) * np.hanning(x.size))) ** 2
    frequency = np.fft.rfftfreq(x.size, 1e-4)
    assert power[frequency > 1.0 / 1e-3].sum() / power.sum() < 1e-4
    # Neighbouring stretches have nothing to do with each other.
    apart = np.corrcoef(noise[:-50], noise[50:])[0, 1]
    assert abs(apart) < 0.05
    rng = np.random.default_rng(0)
    a, b = rng.uniform(-5, 5, (2, 40_000))
    field = NoiseField(1e-3, 11)(a, b, 0.1, 0)
    assert field.mean() == pytest.approx(0.5, abs=0.005)
    assert field.std() == pytest.approx(0.138, abs=0.005)


def test_these_values_of_the_noise_never_change() -> None:
    # Computed with Python's whole numbers from the definition; a change would change every study.
    x = np.array([-3.7e-3, 0.0, 0.25e-3, 5.0])

    def value(cell: int, seed: int) -> float:
        from squeezefilm.physics.render.opcodes import STEP_ALONG, mixed

        return mixed(mixed(seed) ^ (cell * STEP_ALONG % 2**32)) / 2**32

    for place, found in zip(x, along(Noise(1e-3, 42), x), strict=True):
        u = place / 1e-3
        cell = math.floor(u)
        f = u - cell
        basis = [
            (1 - f) ** 3 / 6, (3 * f**3 - 6 * f**2 + 4) / 6,
            (-3 * f**3 + 3 * f**2 + 3 * f + 1) / 6, f**3 / 6,
        ]  # fmt: skip
        wanted = sum(w * value(cell + k - 1, 42) for k, w in enumerate(basis))
        assert found == pytest.approx(wanted, abs=1e-12)


def test_an_image_is_seen_as_a_picture_is() -> None:
    image = Image(((0.0, 0.2, 0.4), (0.6, 0.8, 1.0)), 1e-3, left=0.01, bottom=0.02)
    centres = np.array([0.0105, 0.0115, 0.0125])
    assert along(image, centres, 0.0215) == pytest.approx([0.0, 0.2, 0.4], abs=1e-12)
    assert along(image, centres, 0.0205) == pytest.approx([0.6, 0.8, 1.0])
    assert along(image, 0.011, 0.021) == pytest.approx(0.4)
    assert along(image, [0.0, 1.0], 0.0205) == pytest.approx([0.6, 1.0])
    tiled = Image(image.values, 1e-3, 0.01, 0.02, "repeat")
    assert along(tiled, centres + 6e-3, 0.0215 - 4e-3) == pytest.approx([0.0, 0.2, 0.4], abs=1e-12)
    assert along(tiled, 0.013, 0.0205) == pytest.approx((1.0 + 0.6) / 2)
    alone = Image(image.values, 1e-3, 0.01, 0.02, "zero")
    assert along(alone, [0.0099, 0.0131, 0.012], 0.0205) == pytest.approx(
        [0.0, 0.0, 0.9], abs=1e-12
    )
    array = np.random.default_rng(1).random((4, 5))
    assert Image.from_array(array, 1e-3).values == tuple(map(tuple, array.tolist()))


def test_gates_of_speed_and_time() -> None:
    v = np.array([-0.3, -0.02, 0.0, 0.05, 0.3])
    assert (speed > 0.02)(0, 0, v, 0).tolist() == [1, 0, 0, 1, 1]
    assert (speed < 0.1)(0, 0, v, 0).tolist() == [0, 1, 1, 1, 0]
    assert ((speed > 0.02) & (speed < 0.1))(0, 0, v, 0).tolist() == [0, 0, 0, 1, 0]
    assert (speed > 0.02) == SpeedGate(above=0.02)
    t = np.array([0.0, 0.5, 1.0, 3.0])
    assert Attack(1.0)(0, 0, 0, t) == pytest.approx([0, 0.5, 1, 1])
    assert Decay(1.0, 0.5)(0, 0, 0, t) == pytest.approx(np.exp([0, 0, -0.5, -2.5]))
    assert Periodic(1.0, duty=0.6)(0, 0, 0, t).tolist() == [1, 1, 1, 1]
    # Each part of the period holds its beginning and not its end.
    assert Periodic(1.0, duty=0.25)(0, 0, 0, t / 2).tolist() == [1, 0, 0, 0]
    assert Periodic(1.0, "sine", phase=math.pi / 2)(0, 0, 0, t) == pytest.approx([1, 0, 1, 1])


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Constant(1.1), "share = 1.1"),
        (lambda: Constant(math.nan), "share = nan"),
        (lambda: SquareWave(0.0), "spatial_period = 0 m"),
        (lambda: SquareWave(400.0), "at most 500 mm"),
        (lambda: SquareWave(1e-3, 1.0), "duty = 1"),
        (lambda: SquareWave(1e-3, along=3.0), "no coordinate"),
        (lambda: SineWave(1e-3, math.inf), "phase = inf"),
        (lambda: Pulse(20.0, 1e-3), "centre = 20 m"),
        (lambda: Pulse(0.0, -1e-3), "width = -1 mm"),
        (lambda: Pulse(0.0, 1e-3, "box"), "Allowed: gaussian, raised_cosine"),
        (lambda: Ramp(0.01, 0.01), "the same"),
        (lambda: Ramp(0.0, 0.01, "steep"), "Allowed: linear, smooth"),
        (lambda: Band(0.01, 0.0), "end = 0 m"),
        (lambda: Band(0.0, 0.01, 0.02), "fade = 20 mm"),
        (lambda: Band(0.0, 0.01, 1e-12), "fade = 1 pm"),
        (lambda: Band.disc(0, 0, 0.0), "radius = 0 m"),
        (lambda: Bump(0.0, 0.0), "width = 0 m"),
        (lambda: Bump(0.0, 1e-3, "dent"), "Allowed: bump, hole"),
        (lambda: Noise(1e-9, 1), "at least 1 µm"),
        (lambda: Noise(1e-3, -1), "seed = -1"),
        (lambda: Noise(1e-3, 2**32), "seed = 4294967296"),
        (lambda: Noise(1e-3, 1.0), "seed = 1.0"),
        (lambda: Noise(1e-3, 1, 9), "octaves = 9"),
        (lambda: NoiseField(1e-3, 1, 2, 0.0), "persistence = 0"),
        (lambda: Image((), 1e-3), "at least one value"),
        (lambda: Image(((0.0, 1.0), (0.0,)), 1e-3), "rows of one length"),
        (lambda: Image(((0.0, 2.0),), 1e-3), "values = 2"),
        (lambda: Image(((0.0, math.nan),), 1e-3), "values = nan"),
        (lambda: Image(((0.0,),), 0.0), "pixel = 0 m"),
        (lambda: Image(((0.0,),), 1e-3, outside="wrap"), "outside = 'wrap'"),
        (lambda: Image.from_array(np.zeros((2000, 2000)), 1e-3), "4000000 pixels"),
        (lambda: Image.from_array(np.zeros((2, 2), np.uint8), 1e-3), "divided by 255"),
        (lambda: Image.from_array(np.zeros(4), 1e-3), "shape \\(4,\\)"),
        (lambda: SpeedGate(), "needs a speed"),
        (lambda: SpeedGate(0.2, 0.1), "below = 100 mm/s"),
        (lambda: Attack(0.0), "duration = 0 s"),
        (lambda: Decay(-1.0), "time_constant = -1 s"),
        (lambda: Periodic(0.0), "frequency = 0 Hz"),
        (lambda: Periodic(5e3), "at most 2 kHz"),
        (lambda: Periodic(1.0, "saw"), "Allowed: square, sine"),
        (lambda: AlongDirection(math.nan), "angle = nan"),
        (lambda: FromPoint(11.0), "x = 11 m"),
        (lambda: SquareWave(1e-3, along="x"), "no coordinate"),
        (lambda: SineWave(1e-3, along="x"), "no coordinate"),
        (lambda: SineWave(11.0), "spatial_period = 11 m"),
        (lambda: SquareWave(1e-10), "spatial_period = 100 pm"),
        (lambda: Constant() & 1.0, "no pattern"),
        (lambda: Constant() + Constant(), "cannot be added"),
        (lambda: ~Constant() | "x", "no pattern"),
        (lambda: SineWave(1e-3).scaled_by_speed(0.0), "reference_speed = 0 m/s"),
        (lambda: SineWave(1e-3).scaled_by_speed(0.1, 0.2, 0.1), "fastest = 100 mm/s"),
    ],
)
def test_what_is_no_pattern_is_refused(make: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()


@pytest.mark.parametrize("place", range(4))
def test_a_finger_that_is_nowhere_is_refused(place: int) -> None:
    where = [np.zeros(2) for _ in range(4)]
    where[place] = np.array([0.0, math.nan])
    with pytest.raises(InputError, match="= nan"):
        Constant()(*where)
    where[place] = np.zeros(3)
    with pytest.raises(InputError, match="do not broadcast"):
        Constant()(*where)
