"""How fast textures are rendered, and against what; run `python benchmarks/render.py`.

Prints, on one core: nanoseconds a tick of the compiled interpreter takes, called from compiled
code as a loop does and from Python; samples a second over arrays; the same texture evaluated by
plain NumPy and by a tick of plain Python (the same interpreter, not compiled), in the same run;
and what the time of the deep texture goes into, opcode by opcode.
"""

from __future__ import annotations

import os

# One core for all that is timed; has to be set before NumPy loads its linear algebra.
os.environ["OMP_NUM_THREADS"] = "1"

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from squeezefilm.physics.render import interpret, opcodes
from squeezefilm.physics.render.program import interpreter
from squeezefilm.physics.render.program.inverse import FrictionInverse, FrictionTable
from squeezefilm.physics.render.program.lowering import Program, _instructions, lower
from squeezefilm.physics.render.program.renderer import Renderer, evaluate, new_state
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.image import Noise, NoiseField
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.physics.render.texture.shapes import (
    Attack,
    Band,
    Bump,
    Pulse,
    SineWave,
    SquareWave,
    speed,
)

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.numpy_textures import numpy_values

INVERSE = FrictionInverse.from_function(lambda a: 0.3 + 0.7 * np.exp(-((a / 2e-6) ** 2)), 4e-6)


def law(amplitude: np.ndarray, speed: np.ndarray) -> np.ndarray:
    return 0.3 + 0.7 * np.exp(-((amplitude / 2e-6) ** 2) / (0.5 + 5.0 * speed[:, None]))


# As many as a display's friction has.
KNOTS, SPEEDS = 4e-6 * np.linspace(0.0, 1.0, 65) ** 2, np.geomspace(1e-3, 2.0, 47)
SPEEDY = FrictionTable(KNOTS, SPEEDS, law(KNOTS, SPEEDS), 0.08).inverse(law, 4e-6)


def textures() -> dict[str, Composable]:
    """From one grating to composites of five and more."""
    grating = RelativeFriction(SquareWave(2e-3), 0.5, 0.9)
    noise = RelativeFriction(Noise(1e-3, 7), 0.5, 0.9)
    five = (
        (RelativeFriction(SineWave(3e-3) * Pulse(0.02, 0.01), 0.4, 0.9) & Band(0.0, 0.08, 1e-3))
        .then(noise, at=0.04)
        .when(speed > 0.02)
    )
    deep = (
        five.then(RelativeFriction(Bump(0.06, 2e-3) | NoiseField(2e-3, 3), 0.4, 1.0), at=0.05)
        & Attack(0.1)
        & (Band.disc(0.04, 0.0, 0.05) | SquareWave(1e-3).scaled_by_speed(0.05))
    )
    return {
        "square grating, amplitude": Amplitude(SquareWave(2e-3), 0.0, 2e-6),
        "sine grating, amplitude": Amplitude(SineWave(2e-3), 0.0, 2e-6),
        "square grating, friction": grating,
        "noise along x, friction": noise,
        "noise in the plane, friction": RelativeFriction(NoiseField(1e-3, 7), 0.5, 0.9),
        "composite of five": five,
        "composite of ten": deep,
    }


def program_of(texture: Composable, inverse: FrictionInverse = INVERSE) -> Program:
    if texture.quantity == "amplitude":
        return lower(texture, largest_amplitude=4e-6)
    return lower(texture, inverse=inverse)


def programs() -> dict[str, tuple[Composable, Program]]:
    """The textures lowered, two of them again for a law that depends on the finger's speed."""
    found = {name: (one, program_of(one)) for name, one in textures().items()}
    for name in ("square grating, friction", "composite of ten"):
        one = textures()[name]
        found[f"{name}, by speed"] = one, program_of(one, SPEEDY)
    return found


def best_time(run: Callable[[], object], repeats: int = 5) -> float:
    """The shortest of some runs, in seconds of this process on its core."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


def samples(count: int) -> tuple[np.ndarray, ...]:
    """A finger to and fro over 8 cm at a speed that changes, a kilohertz."""
    t = np.arange(count) * 1e-3
    x = 0.04 - 0.04 * np.cos(2.0 * t)
    return x, 0.01 * np.sin(0.7 * t), 0.08 * np.sin(2.0 * t), t


def plain_python() -> Callable[..., float]:
    """The tick with nothing compiled: the same functions as Python runs them."""
    space = {**vars(opcodes), **vars(interpret), **vars(interpreter)}
    for name, one in list(space.items()):
        if hasattr(one, "py_func"):
            function = one.py_func
            space[name] = type(function)(function.__code__, space, name)
    return space["tick"]


def table(count: int) -> None:
    slow_tick = plain_python()
    print("                                  instr.   tick, ns   from Python   array     NumPy")
    print("texture                           a sample (compiled)   tick, µs   Msample/s Msample/s"
          "   NumPy÷array   Python tick÷tick")  # fmt: skip
    arrays = samples(count)
    few = [tuple(map(float, row)) for row in zip(*(one[:2000] for one in arrays), strict=True)]
    for name, (texture, program) in programs().items():
        state, out = new_state(program), np.empty(count)
        flags = np.empty(count, dtype=np.int64)

        def ticks(program=program, state=state, out=out, flags=flags) -> None:
            state[:] = 0.0
            interpreter.tick_march(program.array, state, arrays, out, flags)

        def from_python(program=program) -> None:
            renderer = Renderer(program)
            for row in few:
                renderer.tick(*row)

        def uncompiled(program=program) -> None:
            state, numbers = [0.0] * 100, program.array.tolist()
            for row in few[:500]:
                slow_tick(numbers, state, *row)

        ticks()
        compiled = best_time(ticks) / count
        wrapped = best_time(from_python) / len(few)
        offline = best_time(lambda p=program: evaluate(p, *arrays)) / count
        plain = best_time(lambda t=texture: numpy_values(t, *arrays), 3) / count
        python = best_time(uncompiled, 3) / 500
        print(
            f"{name:32s}  {len(_instructions(program.array)):6d}   {1e9 * compiled:8.0f}"
            f"   {1e6 * wrapped:10.2f}"
            f"   {1e-6 / offline:9.1f} {1e-6 / plain:9.1f}   {plain / offline:11.1f}"
            f"   {python / compiled:16.0f}"
        )


def opcode_costs(count: int) -> None:
    """What one further instruction adds: the slope between programs with 1 and 33 of it."""
    print("\nWhat one instruction takes, ns (the slope between 8 and 40 in a row)")
    from squeezefilm.physics.render.program import layout as at

    arrays = samples(count)
    head = program_of(Amplitude(SineWave(1e-3), 0.0, 1e-6)).array[: at.HEADER]
    pieces = {
        "COMPLEMENT": [opcodes.COMPLEMENT],
        "TIME ADD": [opcodes.TIME, opcodes.ADD],
        "BETWEEN": [opcodes.BETWEEN, 0.1, 0.9],
        "SQUARE": [opcodes.SQUARE, 1e-3, 0.1, 0.5],
        "BAND": [opcodes.BAND, 0.1, 0.9, 0.05],
        "SINE": [opcodes.SINE, 1e-3, 0.1],
        "GAUSSIAN": [opcodes.GAUSSIAN, 0.5, 0.2],
        "BUMP": [opcodes.BUMP, 0.5, 0.2, 1.0],
        "NOISE": [opcodes.NOISE, 1e-3, 12345.0],
        "NOISE_FIELD ADD": [opcodes.NOISE_FIELD, 1e-3, 12345.0, opcodes.ADD],
    }
    for name, piece in pieces.items():
        times = []
        for many in (8, 40):
            code = [opcodes.ALONG, 1.0, 0.0, 0.0, *piece * many, opcodes.END]
            whole = np.concatenate([head, code])
            whole[[at.H_LENGTH, at.H_TABLES, at.H_INVERSE, at.H_WAVE]] = whole.size
            whole[at.H_STACK] = 4
            program = Program(whole)
            times.append(best_time(lambda p=program: evaluate(p, *arrays)) / count)
        print(f"  {name:16s} {1e9 * (times[1] - times[0]) / 32:7.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=500_000)
    count = parser.parse_args().samples
    print(f"Opcodes of version {opcodes.VERSION}; {count} samples; one core\n")
    table(count)
    opcode_costs(min(count, 200_000))


if __name__ == "__main__":
    main()
