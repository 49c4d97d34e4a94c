"""Ticks: what is asked for, what is counted, and what a failing sensor gets."""

import inspect
import math
import subprocess
import sys

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys
from scipy.interpolate import RegularGridInterpolator

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render import interpret, opcodes
from squeezefilm.physics.render.program import interpreter, layout
from squeezefilm.physics.render.program.inverse import FrictionInverse
from squeezefilm.physics.render.program.lowering import Program, checked, lower
from squeezefilm.physics.render.program.renderer import Renderer, evaluate, render
from squeezefilm.physics.render.texture.image import Image, Noise
from squeezefilm.physics.render.texture.levels import Amplitude, FrictionReduction, RelativeFriction
from squeezefilm.physics.render.texture.pattern import FromPoint
from squeezefilm.physics.render.texture.shapes import Constant, Ramp, SquareWave

INVERSE = FrictionInverse.from_function(lambda a: 1 - 0.5 * a / 4e-6, 4e-6)
GRATING = Amplitude(SquareWave(2e-3), 1e-6, 2e-6)
PROGRAM = lower(GRATING, largest_amplitude=3e-6, hold_ticks=3, fade_ticks=4)


def steady(program: Program, count: int = 5) -> Renderer:
    """A renderer after some good ticks in a groove."""
    renderer = Renderer(program)
    for k in range(count):
        assert renderer.tick(0.5e-3, 0.0, 0.1, k * 1e-3) == 2e-6
    return renderer


def test_a_grating_is_played_as_it_is_wanted() -> None:
    x = np.linspace(0.0, 0.01, 1001)
    found = render(PROGRAM, x, 0.0, 0.1, x / 0.1)
    assert np.array_equal(found.amplitude, GRATING(x, 0.0, 0.1, 0.0))
    assert found.counters.ticks == 1001
    assert found.counters.faults == found.counters.unreachable == 0
    assert not np.any(found.flags)


def test_a_finger_may_go_anywhere_in_the_plane() -> None:
    angle = np.linspace(0.0, 4 * math.pi, 2001)
    radius = np.linspace(5e-3, 20e-3, angle.size)
    x, y = 0.03 + radius * np.cos(angle), 0.02 + radius * np.sin(angle)
    t = np.arange(angle.size) * 1e-3
    rings = Amplitude(SquareWave(4e-3, along=FromPoint(0.03, 0.02)), 0.0, 2e-6)
    found = render(lower(rings, largest_amplitude=2e-6), x, y, 0.1, t).amplitude
    # A spiral crosses the rings as a straight stroke of its radius would.
    clear = np.abs(np.mod(radius / 2e-3 + 0.5, 1.0) - 0.5) > 1e-6
    straight = np.where(np.mod(radius, 4e-3) < 2e-3, 2e-6, 0.0)
    assert np.array_equal(found[clear], straight[clear])
    grid = np.random.default_rng(2).random((8, 9))
    map_of = Image.from_array(grid, 5e-3, left=0.01, bottom=0.0)
    played = render(lower(Amplitude(map_of, 0.0, 2e-6), largest_amplitude=2e-6), x, y, 0.1, t)
    across, up = 0.01 + 5e-3 * (np.arange(9) + 0.5), 5e-3 * (np.arange(8) + 0.5)
    oracle = RegularGridInterpolator((up, across), grid[::-1])
    # Beyond the outermost centres an image holds.
    where = np.stack([np.clip(y, up[0], up[-1]), np.clip(x, across[0], across[-1])], axis=-1)
    assert played.amplitude == pytest.approx(2e-6 * oracle(where), abs=1e-18)


def test_friction_becomes_the_amplitude_that_makes_it() -> None:
    wanted = RelativeFriction(Ramp(0.0, 0.01), 0.5, 1.0)
    x = np.linspace(0.0, 0.01, 101)
    found = render(lower(wanted, inverse=INVERSE), x, 0.0, 0.1, x)
    assert found.amplitude == pytest.approx(8e-6 * (1 - wanted(x, 0, 0.1, 0)), abs=1e-18)
    reduced = FrictionReduction(Ramp(0.0, 0.01), 0.0, 0.4)
    program = lower(reduced, inverse=INVERSE, friction_coefficient=0.8)
    again = render(program, x, 0.0, 0.1, x)
    assert again.amplitude == pytest.approx(8e-6 * reduced(x, 0, 0.1, 0) / 0.8, abs=1e-18)
    assert found.counters.unreachable == again.counters.unreachable == 0


@pytest.mark.parametrize(
    ("texture", "options", "amplitude", "flag", "counter"),
    [
        (RelativeFriction.constant(0.4), {"inverse": INVERSE}, 4e-6, 128, "too_slippery"),
        (RelativeFriction.constant(0.9) * 1.2, {"inverse": INVERSE}, 0.0, 64, "too_sticky"),
        (Amplitude.constant(5e-6), {"largest_amplitude": 4e-6}, 4e-6, 512, "saturated"),
        (
            RelativeFriction.constant(0.5),
            {"inverse": INVERSE, "largest_amplitude": 3e-6},
            3e-6,
            512,
            "saturated",
        ),
        (
            FrictionReduction.constant(0.5),
            {"inverse": INVERSE, "friction_coefficient": 0.4},
            4e-6,
            128,
            "too_slippery",
        ),
    ],
)
def test_what_cannot_be_reached_is_counted_on_every_tick(
    texture: object, options: dict, amplitude: float, flag: int, counter: str
) -> None:
    renderer = Renderer(lower(texture, **options))
    for k in range(3):
        assert renderer.tick(0.0, 0.0, 0.1, k * 1e-3) == amplitude
        assert renderer.flags == flag
    counters = renderer.counters
    assert getattr(counters, counter) == counters.unreachable == 3
    assert counters.faults == 0
    renderer.reset()
    assert renderer.counters.ticks == 0


@pytest.mark.parametrize(
    ("sample", "flag", "counter"),
    [
        ((math.nan, 0.0, 0.1, 1.0), 1, "bad_place"),
        ((0.0, math.inf, 0.1, 1.0), 1, "bad_place"),
        ((0.0, 0.0, math.nan, 1.0), 1, "bad_place"),
        ((10.1, 0.0, 0.1, 1.0), 1, "bad_place"),
        ((0.0, 0.0, 2e3, 1.0), 1, "bad_place"),
        ((0.5e-3, 0.0, 0.1, math.nan), 2, "bad_time"),
        ((0.5e-3, 0.0, 0.1, -math.inf), 2, "bad_time"),
        ((0.5e-3, 0.0, 0.1, 0.0035), 4, "backwards"),
        ((0.5e-3, 0.0, 0.1, 0.004), 8, "repeated"),
    ],
)
def test_a_bad_sample_holds_then_fades_and_a_good_one_resumes(
    sample: tuple, flag: int, counter: str
) -> None:
    renderer = steady(PROGRAM)
    found = [renderer.tick(*sample) for _ in range(9)]
    assert found == pytest.approx([2e-6] * 3 + [1.5e-6, 1e-6, 0.5e-6, 0.0, 0.0, 0.0])
    assert renderer.flags == flag | 32
    counters = renderer.counters
    assert getattr(counters, counter) == 9
    assert counters.stalls == 1
    assert renderer.tick(1.5e-3, 0.0, 0.1, 2.0) == 1e-6
    assert renderer.flags == 0
    renderer.tick(math.nan, 0.0, 0.1, 2.1)
    assert renderer.counters.stalls == 1


def test_nothing_is_given_out_before_the_first_good_sample() -> None:
    renderer = Renderer(PROGRAM)
    assert [renderer.tick(math.nan, 0.0, 0.0, 0.0) for _ in range(5)] == [0.0] * 5
    assert renderer.tick(0.5e-3, 0.0, 0.1, -5.0) == 2e-6


def test_a_value_without_a_number_is_a_fault() -> None:
    # No texture makes one; a program made elsewhere may.
    code = [
        *[opcodes.ALONG, 1e308, 0.0, 1e308], *[opcodes.CONSTANT, 1e308], opcodes.MULTIPLY,
        *[opcodes.CONSTANT, 0.0], opcodes.MULTIPLY, opcodes.END,
    ]  # fmt: skip
    head = lower(Amplitude.constant(0.0), largest_amplitude=1e-6).array[:24].copy()
    whole = np.concatenate([head, code])
    end = whole.size
    whole[[2, 4, 9, 13]] = end
    whole[5] = 2
    renderer = Renderer(Program(whole))
    assert [renderer.tick(1.0, 0.0, 0.0, k) for k in range(3)] == [0.0] * 3
    assert renderer.counters.bad_value == 3
    assert renderer.flags == 16


def test_a_tick_releases_the_lock_allocates_nothing_and_is_cached() -> None:
    assert interpreter.tick.targetoptions["nogil"] is True
    assert interpreter.tick.stats.cache_path is not None

    def allocations(count: int) -> int:
        t = np.arange(float(count))
        render(PROGRAM, t * 1e-6, 0.0, 0.1, t)
        before = rtsys.get_allocation_stats().mi_alloc
        render(PROGRAM, t * 1e-6, 0.0, 0.1, t)
        return rtsys.get_allocation_stats().mi_alloc - before

    _nrt_python.memsys_enable_stats()
    try:
        # The arrays handed over count once a call, however many ticks are made of them.
        assert allocations(5000) == allocations(5) > 0
    finally:
        _nrt_python.memsys_disable_stats()


def test_one_number_for_every_opcode_and_all_of_them_in_the_table() -> None:
    names = {
        name: value
        for name, value in vars(opcodes).items()
        if name.isupper() and isinstance(value, int) and value < len(opcodes.SHAPES)
        and name not in ("VERSION",)
    }  # fmt: skip
    assert sorted(names.values()) == list(range(len(opcodes.SHAPES)))
    for name, value in names.items():
        assert f"{value:2d}  {name}" in (opcodes.__doc__ or "")
    source = inspect.getsource(interpret.interpret.py_func)
    assert all(f"op.{name}:" in source for name in names)
    for name, place in vars(layout).items():
        if name.startswith("H_") and name not in ("H_WAVE_P", "H_WAVE_Q", "H_WAVE_R"):
            assert f"{place} {name[2:]} " in (layout.__doc__ or ""), name
        if name.startswith("S_"):
            assert f"{place} {name[2:]} " in (layout.__doc__ or ""), name


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: lower(RelativeFriction.constant(0.5)), "needs the display's friction curve"),
        (lambda: lower(GRATING), "largest_amplitude"),
        (lambda: lower(GRATING, inverse=INVERSE), "needs no inverse"),
        (lambda: lower(GRATING, largest_amplitude=0.0), "largest amplitude = 0|largest_amplitude"),
        (lambda: lower(GRATING, largest_amplitude=1e-6, hold_ticks=-1), "hold_ticks = -1"),
        (lambda: lower(GRATING, largest_amplitude=1e-6, fade_ticks=0), "fade_ticks = 0"),
        (
            lambda: lower(FrictionReduction.constant(0.5), inverse=INVERSE),
            "friction coefficient at rest",
        ),
        (
            lambda: lower(RelativeFriction.constant(1), inverse=INVERSE, friction_coefficient=1),
            "takes no friction_coefficient",
        ),
        (lambda: lower(Constant()), "no texture with a quantity"),
        (lambda: render(PROGRAM, np.zeros((2, 2)), 0, 0, 0), "one axis"),
        (lambda: render(PROGRAM, np.zeros(2), np.zeros(3), 0, 0), "do not broadcast"),
        (lambda: evaluate(PROGRAM, math.nan, 0, 0, 0), "x = nan"),
    ],
)
def test_what_cannot_be_rendered_is_refused(make: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()


def test_a_texture_too_deep_or_with_too_many_pixels_is_refused() -> None:
    texture = GRATING
    for _ in range(70):
        texture = Amplitude.constant(0.0).then(texture, at=0.1)
    with pytest.raises(InputError, match="nest less"):
        lower(texture, largest_amplitude=1e-6)
    image = Image.from_array(np.zeros((1024, 1024)), 1e-4)
    many = sum((Amplitude(image, 0.0, 1e-7),) * 3, start=Amplitude(image, 0.0, 1e-7))
    with pytest.raises(InputError, match="4194304 pixels"):
        lower(many, largest_amplitude=1e-6)


def _altered(place: int, value: float) -> np.ndarray:
    texture = RelativeFriction(Image(((0.5,),), 1e-3) * Noise(1e-3, 5), 0.5, 1.0)
    array = lower(texture, inverse=INVERSE).array.copy()
    array[place] = value
    return array


def test_any_single_damage_to_a_program_is_refused_or_harmless() -> None:
    whole = _altered(0, layout.MAGIC)
    assert np.array_equal(checked(whole), whole)
    x = np.linspace(-0.1, 0.1, 11)
    refused = 0
    for place in range(60):
        for value in (-1.0, 0.5, 7.0, 1e9, 1e300, math.nan):
            try:
                program = Program(_altered(place, value))
            except InputError:
                refused += 1
                continue
            amplitude = render(program, x, 0.0, 0.1, np.arange(11.0)).amplitude
            assert np.all(np.isfinite(amplitude))
            assert np.all((amplitude >= 0) & (amplitude <= program.largest_amplitude))
    assert refused > 150
    for cut in (0, 5, 24, 40, whole.size - 1):
        with pytest.raises(InputError):
            checked(whole[:cut])


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ([opcodes.ADD, opcodes.END], "more from the stack"),
        ([opcodes.TIME, opcodes.TIME, opcodes.END], "one value"),
        ([opcodes.TIME], "last instruction"),
        ([opcodes.TIME, opcodes.END, opcodes.TIME], "last instruction"),
        ([99, opcodes.END], "unknown opcode 99"),
        ([opcodes.CONSTANT], "ends within"),
        ([opcodes.TIME, opcodes.SINE, 0.0, 0.0, opcodes.END], "divides by 0"),
        ([opcodes.TIME, opcodes.RAMP, 1.0, 1.0, opcodes.END], "ramp of no length"),
        ([opcodes.TIME, opcodes.NOISE, 1.0, 0.5, opcodes.END], "seed 0.5"),
        ([opcodes.IMAGE, 0, 1, 1, 0, 0, 1, 0, opcodes.END], "past the tables"),
        ([opcodes.IMAGE, 0, 0, 1, 0, 0, 1, 0, opcodes.END], "without a shape"),
        ([opcodes.TIME, opcodes.TIME, opcodes.TIME, opcodes.LEAVE_SCALE, opcodes.END], "leaves"),
        (
            [opcodes.ENTER_SCALE, 1, 1, 1, opcodes.ADD, opcodes.TIME, opcodes.LEAVE_SCALE, 0],
            "more from the stack",
        ),
        ([*[opcodes.TIME] * 60, *[opcodes.ADD] * 59, opcodes.END], "larger stack"),
    ],
)
def test_code_that_would_run_away_is_refused(code: list[float], said: str) -> None:
    head = lower(Amplitude.constant(0.0), largest_amplitude=1e-6).array[:24].copy()
    whole = np.concatenate([head, code])
    whole[[2, 4, 9, 13]] = whole.size
    whole[5] = 50
    with pytest.raises(InputError, match=said):
        checked(whole)


@pytest.mark.slow
def test_a_first_render_of_broadcast_arrays_warns_of_nothing() -> None:
    """NumPy warns only when a type is compiled for the first time, so in a process."""
    code = (
        "import numpy as np\n"
        "from squeezefilm.physics.render.program.lowering import lower\n"
        "from squeezefilm.physics.render.program.renderer import evaluate, render\n"
        "from squeezefilm.physics.render.texture.levels import Amplitude\n"
        "program = lower(Amplitude.constant(1e-6), largest_amplitude=4e-6)\n"
        "evaluate(program, 0.0, 0.0, np.array([0.1]), 0.0)\n"
        "render(program, 0.0, 0.0, np.array([0.1]), np.zeros(1))\n"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)
