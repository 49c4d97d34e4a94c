"""One program, three interpreters: NumPy, the compiled one and the page's say the same."""

import dataclasses
import json
import math
import os
import shutil
import subprocess
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, example, given, settings
from hypothesis import strategies as st
from tests.friction_tables import inverse_over_speeds
from tests.numpy_textures import numpy_values

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render import opcodes
from squeezefilm.physics.render.opcodes import mixed
from squeezefilm.physics.render.program.inverse import FrictionInverse, WaveCompensation
from squeezefilm.physics.render.program.lowering import Program, lower
from squeezefilm.physics.render.program.renderer import evaluate, render
from squeezefilm.physics.render.texture.composition import Composable, Product
from squeezefilm.physics.render.texture.image import Image
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.physics.render.texture.shapes import SineWave

from .texture_strategies import any_textures

RUNNER = Path(__file__).with_name("run_renderer.mjs")
MODULE = files("squeezefilm.physics.render").joinpath("static/renderer.js")
INVERSE = FrictionInverse.from_function(lambda a: 0.3 + 0.7 * np.exp(-((a / 2e-6) ** 2)), 4e-6)


def quickening(amplitude: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Friction that falls with amplitude, and less so under a faster finger; flat at 1 for the
    smallest amplitudes of the fastest, as where ridges do not slip."""
    reached = np.maximum(amplitude - 0.4e-6 * np.maximum(speed[:, None] - 0.2, 0.0), 0.0) / 2e-6
    return 0.3 + 0.7 * np.exp(-(reached**2) / (0.2 + speed[:, None]))


SPEEDY = inverse_over_speeds(
    quickening, 4e-6 * np.linspace(0, 1, 33) ** 2, np.geomspace(1e-3, 2.0, 12), 0.08
)
INVERSES = (INVERSE, SPEEDY)
WAVE = WaveCompensation(8e-3, tuple(0.7 + 0.3 * np.cos(np.linspace(0, 2 * np.pi, 256, False))))


@pytest.fixture(scope="module")
def node() -> str:
    """The JavaScript engine. Without one the test is skipped, but fails where CI=true."""
    path = shutil.which("node")
    if path is None:
        reason = "no node found to run the page's renderer; install the package nodejs"
        if os.environ.get("CI") == "true":
            pytest.fail(f"CI=true must not skip this: {reason}")
        pytest.skip(reason)
    return path


def samples(seed: int, count: int = 40) -> np.ndarray:
    """Places, velocities and rising times, shape (4, count); some places on round numbers."""
    rng = np.random.default_rng(seed)
    place = rng.uniform(-0.06, 0.06, (2, count))
    place[:, ::5] = np.round(place[:, ::5], 3)
    speed = rng.uniform(-0.4, 0.4, count)
    return np.vstack([place, speed, np.cumsum(rng.uniform(1e-3, 0.1, count))])


def program_of(
    texture: Composable, compensated: bool = False, inverse: FrictionInverse = INVERSE
) -> Program:
    compensation = WAVE if compensated else None
    if texture.quantity == "amplitude":
        return lower(texture, largest_amplitude=4e-6, compensation=compensation, hold_ticks=3)
    coefficient = 0.8 if texture.quantity == "friction_reduction" else None
    return lower(
        texture,
        inverse=inverse,
        friction_coefficient=coefficient,
        compensation=compensation,
        hold_ticks=3,
        fade_ticks=4,
    )


@given(any_textures, st.integers(0, 2**32 - 1))
def test_the_compiled_interpreter_is_the_texture_itself(texture: Composable, seed: int) -> None:
    where = samples(seed)
    scale = 1e-6 if texture.quantity == "amplitude" else 1.0
    found = evaluate(program_of(texture), *where)
    assert found == pytest.approx(numpy_values(texture, *where), rel=1e-10, abs=1e-12 * scale)
    assert np.array_equal(texture(*where), found)


def damaged(where: np.ndarray, seed: int) -> np.ndarray:
    """Samples as a failing sensor gives them: not-a-numbers, repeats, a clock set back."""
    rng = np.random.default_rng(seed)
    where = where.copy()
    for row in range(4):
        where[row, rng.integers(0, where.shape[1], 2)] = [math.nan, math.inf]
    stalled = int(rng.integers(5, 25))
    where[3, stalled : stalled + 12] = where[3, stalled]
    where[3, 35:] -= 0.5
    return where


def as_json(value: float) -> float | str:
    if math.isfinite(value):
        return float(value)
    return "NaN" if math.isnan(value) else ("Infinity" if value > 0 else "-Infinity")


def run_page(node: str, cases: list[dict]) -> list[dict]:
    """What the page's renderer answers to programs and samples."""
    done = subprocess.run(
        [node, str(RUNNER), str(MODULE)],
        input=json.dumps(cases),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: list[dict] = json.loads(done.stdout)
    return found


def golden() -> list[dict]:
    """Programs of versions 1 and 2 with samples and what they give, for every interpreter to come.

    Made once. A change that makes them fail changes what stored programs mean: raise the version.
    """
    stored = json.loads(Path(__file__).with_name("golden_programs.json").read_text("utf-8"))
    cases: list[dict] = stored["cases"]
    return cases


def test_golden_programs_use_every_opcode() -> None:
    used = set()
    for case in golden():
        code, place = case["program"], 24
        while place < code[4]:
            used.add(int(code[place]))
            place += 1 + opcodes.SHAPES[int(code[place])][0]
    assert used == set(range(len(opcodes.SHAPES)))


def test_an_operand_that_divides_is_never_zero() -> None:
    """Every operand of every opcode in turn: refused as zero, or nothing is divided by it."""
    place = np.array([-3e-3, 0.0, 1.7e-3, 20e-3])
    for case in golden():
        whole = np.array(case["program"], dtype=float)
        at = 24
        while at < whole[4]:
            operands = opcodes.SHAPES[int(whole[at])][0]
            for operand in range(at + 1, at + 1 + operands):
                changed = whole.copy()
                changed[operand] = 0.0
                try:
                    program = Program(changed)
                except InputError:
                    continue
                found = evaluate(program, place, place, np.full(4, 0.08), np.full(4, 0.1))
                assert np.all(np.isfinite(found)), (whole[at], operand - at - 1)
            at += 1 + operands


def test_golden_programs_mean_what_they_meant() -> None:
    for case in golden():
        where = np.array([[float(one) for one in sample] for sample in case["samples"]]).T
        found = render(Program(np.array(case["program"])), *where)
        assert found.amplitude == pytest.approx(np.array(case["amplitude"]), rel=1e-9, abs=1e-18)
        assert found.flags.tolist() == case["flags"]


def test_golden_programs_mean_the_same_on_a_page(node: str) -> None:
    cases = golden()
    for case, answer in zip(cases, run_page(node, cases), strict=True):
        assert answer["amplitude"] == pytest.approx(case["amplitude"], rel=1e-6, abs=1e-15)
        assert answer["flags"] == case["flags"]


@pytest.mark.slow
def test_the_page_says_what_the_compiled_interpreter_says(node: str) -> None:
    cases: list[tuple[Composable, Program, np.ndarray]] = []

    # Without shrinking: every drawn texture is kept, and one call of node runs them all.
    @given(any_textures, st.integers(0, 2**32 - 1), st.booleans(), st.sampled_from(INVERSES))
    @settings(
        max_examples=200,
        deadline=None,
        database=None,
        derandomize=True,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    def draw(texture: Composable, seed: int, compensated: bool, inverse: FrictionInverse) -> None:
        where = samples(seed)
        if seed % 2:
            where = damaged(where, seed)
        cases.append((texture, program_of(texture, compensated, inverse), where))

    draw()
    # What random textures may not meet: friction out of reach either way, too large an amplitude.
    for texture in (
        RelativeFriction.constant(0.9) * 2.0,
        RelativeFriction.constant(0.1),
        RelativeFriction.constant(1.0),
        Amplitude.constant(1e-5),
    ):
        cases += [(texture, program_of(texture, inverse=one), samples(1)) for one in INVERSES]
    asked = [
        {
            "program": program.array.tolist(),
            "samples": [[as_json(one) for one in column] for column in where.T.tolist()],
        }
        for _, program, where in cases
    ]
    seen_flags = 0
    for (texture, program, where), answer in zip(cases, run_page(node, asked), strict=True):
        wanted = render(program, *where)
        found = np.array([float(one) for one in answer["amplitude"]])
        assert found == pytest.approx(wanted.amplitude, rel=1e-6, abs=1e-15), texture
        assert answer["flags"] == wanted.flags.tolist(), texture
        counted = dataclasses.asdict(wanted.counters)
        assert list(answer["counters"].values()) == list(counted.values())
        good = np.all(np.isfinite(where), axis=0)
        values = np.array([float(one) for one in answer["value"]])[good]
        scale = 1e-6 if texture.quantity == "amplitude" else 1.0
        assert values == pytest.approx(
            evaluate(program, *where[:, good]), rel=1e-6, abs=1e-9 * scale
        )
        seen_flags |= int(np.bitwise_or.reduce(wanted.flags))
    # All but a texture without a finite value and one below zero, which the algebra cannot make.
    assert seen_flags == 1 | 2 | 4 | 8 | 32 | 64 | 128 | 512


def test_the_noise_s_numbers_are_these_for_ever() -> None:
    # lowbias32 of 0 to 3, computed by hand with whole numbers of any size.
    def by_hand(value: int) -> int:
        value = value ^ (value >> 16)
        value = value * 0x7FEB352D % 2**32
        value = value ^ (value >> 15)
        value = value * 0x846CA68B % 2**32
        return value ^ (value >> 16)

    assert [mixed(one) for one in range(4)] == [by_hand(one) for one in range(4)]
    assert mixed(1) == 1753845952


@given(st.floats(0.0, 1.0), st.integers(0, 2**32 - 1))
def test_a_wanted_friction_becomes_the_inverses_own_amplitude_at_each_speed(
    share: float, seed: int
) -> None:
    """The compiled bisection against the one in NumPy, at any speed there may be."""
    rng = np.random.default_rng(seed)
    speed = np.append(rng.uniform(-2.5, 2.5, 20), rng.choice(SPEEDY.speed, 6))
    for one, v in zip(share * np.ones(speed.size), speed, strict=True):
        least = float(SPEEDY.least_friction_at(v))
        wanted = least + one * (1.0 - least)
        program = lower(RelativeFriction.constant(wanted), inverse=SPEEDY)
        found = render(program, 0.0, 0.0, np.array([v]), np.zeros(1))
        assert found.counters.unreachable == 0
        amplitude = SPEEDY.amplitude_for(wanted, v)
        assert found.amplitude[0] == pytest.approx(float(amplitude), rel=1e-12, abs=1e-20)
        assert float(SPEEDY.friction_at(amplitude, v)) == pytest.approx(wanted, abs=1e-13)


# Weighed with itself, an image's one row moved by its last digit.
ONE_ROW = Product(
    Amplitude(SineWave(0.03125), 0.0, 1e-9),
    Image(((0.6369616873214543, 0.2697867137638703),), pixel=0.015625, outside="repeat"),
)


@example(ONE_ROW, 0)
@given(any_textures, st.integers(0, 2**32 - 1))
@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_what_a_program_does_not_name_has_no_influence(texture: Composable, seed: int) -> None:
    frictional = texture.quantity != "amplitude"
    program = lower(
        texture,
        largest_amplitude=None if frictional else 4e-6,
        inverse=INVERSE if frictional else None,
        friction_coefficient=0.6 if texture.quantity == "friction_reduction" else None,
    )
    x, y, v, t = samples(seed)
    base = evaluate(program, x, y, v, t)
    others = {
        "x": (x + 0.0123, y, v, t),
        "y": (x, y + 0.0123, v, t),
        "speed": (x, y, 3.7 * v, t),
        "direction": (x, y, -v, t),
        "time": (x, y, v, t + 0.123),
    }
    for name in others.keys() - program.wanted_depends_on:
        assert np.array_equal(evaluate(program, *others[name]), base), name
