"""Whether this tree is slower than another revision: `python benchmarks/against.py REVISION`.

Kernels and whole verbs of both, asked in turn in one run. A machine's speed drifts by more than
what is looked for, so a ratio is that of two neighbouring calls: printed are the median of the
`--rounds` of each of `--processes` (whose memory lies elsewhere every time) and the interval that
holds the true median with 95 %. Slower is what has all of its interval above 1.05; a "?" marks
one that reaches beyond. Times are those of the processor, one thread, what was compiled loaded
from the cache. Kernels are the inner calls of this folder's other files, taken from the names that
they import, so that each revision finds its own wherever it keeps them.
"""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["NUMBA_NUM_THREADS"] = "1"

import argparse
import contextlib
import importlib
import json
import math
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

ROOT = Path(__file__).parents[1]
SLOWER = 1.05  # what "slower" means, as a ratio
_LEAST = 0.02  # s that an answer takes; what is quicker is called more than once
VERBS = {
    "analyze the stator": ["analyze", "biet2008-stator", "--json"],
    "analyze the plate": ["analyze", "biet2008-plate", "--json"],
    "friction on the stator": ["friction", "biet2008-stator", "--amplitude", "2 um", "--json"],
    "render a grating": ["render", "biet2008-square-2mm", "--display", "biet2008-stator", "--json"],
    "a film by itself": ["film", "--squeeze-number", "10", "--excursion", "0.5", "--json"],
    "--help": ["--help"],
}


def film_kernels() -> Iterator[tuple[str, Callable[[], object]]]:
    film = importlib.import_module("film")
    # Under its former name where the other revision is older.
    solve_films = getattr(film, "solve_films", None) or film.solve_strips
    rng = np.random.default_rng(1)
    sigma, eps = 10.0 ** rng.uniform(1.0, 3.0, 2000), rng.uniform(0.3, 0.5, 2000)
    for tolerance in (5e-3, 1e-3, 1e-4):
        yield (
            f"2 000 strips at {tolerance:g}",
            lambda tolerance=tolerance: solve_films(sigma, eps, tolerance=tolerance, workers=1),
        )
    waves = {"wavenumber": 20.0 * np.pi / 18.7, "ridge_wavenumber": 20.0 * np.pi / 0.35}
    ridges = film.flexural_profile(0.038, ridge_depth=0.95, **waves)
    yield "a film under 28 ridges", lambda: film.solve_profile(20.4, ridges, tolerance=1e-3)
    if hasattr(film, "ellipse"):
        yield "an ellipse in the plane", lambda: film.ellipse(30.0, 0.4, 1.5, 1e-2)
    else:  # before the two planar shapes became one
        yield "an ellipse in the plane", lambda: film.solve_ellipse(30.0, 0.4, 1.5, tolerance=1e-2)


def contact_kernels() -> Iterator[tuple[str, Callable[[], object]]]:
    contact, sliding = (importlib.import_module(name) for name in ("contact", "sliding"))
    display = contact.load_display("biet2008-stator")
    finger = display.finger
    law = finger.asperity_law(display.surface().roughness)
    points = contact.pad_points(finger)
    met = np.abs(np.cos(np.pi * points.along / contact.HALF_WAVELENGTH))
    pressure = finger.plateau_pressure()
    amplitudes = np.linspace(0.05e-6, 5e-6, 100)

    def curve(table: Any) -> object:
        return contact.pad_friction(table, law, amplitudes, met, points.shares, pressure)

    def fresh() -> Any:
        return contact.FilmTable(contact.FREQUENCY, finger.plateau_width, display.gas)

    table = fresh()
    rng = np.random.default_rng(3)
    a, p = rng.uniform(0.2e-6, 5e-6, 20000), rng.uniform(1e3, 3e4, 20000)
    yield "a friction curve, its film table too", lambda: curve(fresh())
    yield "a friction curve, the table at hand", lambda: curve(table)
    yield "20 000 load balances", lambda: contact.share_load(table, law, a, p)
    yield "25 600 steps of sliding", lambda: sliding.marched(25_600)


def render_kernels() -> Iterator[tuple[str, Callable[[], object]]]:
    render, motion = (importlib.import_module(name) for name in ("render", "motion"))
    arrays = render.samples(200_000)
    for name, texture in render.textures().items():
        program = render.program_of(texture)
        yield (
            f"200 000 samples, {name}",
            lambda program=program: render.evaluate(program, *arrays),
        )
    estimator = motion.MotionEstimator(motion.MotionModel(), 2e-5)
    hand = motion.MinimumJerkStroke(passes=10)
    stamps = np.linspace(0.0, hand.duration, 400_000)
    seen = hand.position(stamps) + 2e-5 * np.random.default_rng(0).standard_normal(stamps.size)
    yield "400 000 estimates of motion", lambda: motion.marched(estimator, stamps, seen)
    envelope = motion.DrivenEnvelope(motion.TAU, motion.TAU, motion.LIMIT, braking=True)
    wanted = np.where(
        (np.arange(20_000) * 0.24 / motion.RATE / 0.4e-3) % 1 < 0.5, 0.8 * motion.LIMIT, 0.0
    )
    ahead = motion.preview_samples(envelope, 1 / motion.RATE)
    yield "20 000 previews", lambda: motion.preview_seconds(envelope, wanted, ahead)


def plate_kernels() -> Iterator[tuple[str, Callable[[], object]]]:
    plate, study = (importlib.import_module(name) for name in ("plate", "study"))
    paper = plate.load_display("biet2008-plate").actuator
    f = np.linspace(32.5e3, 34.5e3, 200)
    yield "the plate's mode (8,0)", lambda: plate.solve_modes(paper, mode=(8, 0))
    yield "200 points of its response", lambda: plate.harmonic_response(paper, f)
    random = np.random.default_rng(1)
    yield "a study of 1 000 simulated", lambda: study.simulated_counts(1000, random)


ROOMS = (film_kernels, contact_kernels, render_kernels, plate_kernels)


def serve(tree: Path) -> None:
    """Answer the number of a kernel by its time, for as long as one is asked."""
    sys.path[:1] = [str(tree / "benchmarks"), str(tree / "src")]
    package = Path(importlib.import_module("squeezefilm").__file__ or "")
    if tree not in package.parents:
        raise SystemExit(f"squeezefilm was taken from {package}, not from {tree}")
    kernels = [kernel for room in ROOMS for kernel in room()]
    calls = []
    for _, run in kernels:
        run()
        start = time.process_time()
        run()
        calls.append(math.ceil(_LEAST / max(time.process_time() - start, 1e-6)))
    print(json.dumps([name for name, _ in kernels]), flush=True)
    for line in sys.stdin:
        run, many = kernels[int(line)][1], calls[int(line)]
        start = time.process_time()
        for _ in range(many):
            run()
        print((time.process_time() - start) / many, flush=True)


class Side:
    """One revision: a process that holds its kernels, and its verbs."""

    def __init__(self, tree: Path) -> None:
        self.environment = {**os.environ, "PYTHONPATH": str(tree / "src")}
        self.process = subprocess.Popen(
            [sys.executable, str(Path(__file__).resolve()), "--serve", str(tree)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=self.environment,
        )  # fmt: skip

    def answer(self) -> Any:
        """What the process says next."""
        assert self.process.stdout is not None
        said = self.process.stdout.readline()
        if not said:
            raise SystemExit("one side ended before it answered; what it said is above")
        return json.loads(said)

    def kernel(self, number: int) -> float:
        """Processor time of one call (s)."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{number}\n")
        self.process.stdin.flush()
        return float(self.answer())

    def verb(self, words: list[str]) -> float:
        """Processor time of one call of the program (s), interpreter and imports included."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [sys.executable, "-c", "from squeezefilm.cli import main; main()", *words],
            env=self.environment, stdout=subprocess.DEVNULL, check=True,
        )  # fmt: skip
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


Times = np.ndarray[tuple[int, int], np.dtype[np.float64]]
Pair = tuple[Side, Side]


def in_turn(pair: Pair, ask: Callable[[Side], float], rounds: int) -> Times:
    """Times of both sides (s), shape (rounds, 2), the first of a round by turns."""
    times = np.empty((rounds, 2))
    for turn in range(rounds):
        for side in (0, 1) if turn % 2 == 0 else (1, 0):
            times[turn, side] = ask(pair[side])
    return times


def median_and_interval(ratios: Any) -> tuple[float, float, float]:
    """The median of a sample, and the two of its values that hold the true one with 95 %."""
    ordered = np.sort(ratios)
    outside = int(stats.binom.ppf(0.025, ordered.size, 0.5))
    least = max(outside - 1, 0)
    return float(np.median(ordered)), float(ordered[least]), float(ordered[-1 - least])


def measure(before: Path, rounds: int, processes: int, only: str) -> Iterator[tuple[str, Times]]:
    """Times of all rounds of what has `only` in its name."""
    pairs: list[Pair] = []
    with contextlib.ExitStack() as stack:
        for _ in range(processes):
            pairs.append((Side(before), Side(ROOT)))
            for side in pairs[-1]:
                stack.callback(side.process.kill)
        kernels = [side.answer() for pair in pairs for side in pair]
        if any(names != kernels[0] for names in kernels):
            raise SystemExit("the two revisions have different kernels")
        asks = {name: lambda side, k=k: side.kernel(k) for k, name in enumerate(kernels[0])}
        for name, ask in asks.items():
            if only in name:
                yield name, np.concatenate([in_turn(pair, ask, rounds) for pair in pairs])
        asks = {name: lambda side, words=words: side.verb(words) for name, words in VERBS.items()}
        for name, ask in asks.items():
            if only in name:
                yield name, in_turn(pairs[0], ask, max(rounds // 3, 1) * processes)


def compare(before: Path, rounds: int, processes: int, only: str) -> int:
    """Print the table of what has `only` in its name; how many became slower than allowed."""
    print("ms of one processor (medians), and after/before of neighbouring calls")
    print(f"{'':40s} {'before':>10s} {'after':>10s} {'ratio':>7s}   95 % of its median")
    slower = 0
    for name, times in measure(before, rounds, processes, only):
        ratio, low, high = median_and_interval(times[:, 1] / times[:, 0])
        slower += low > SLOWER
        mark = "  slower" if low > SLOWER else "  ?" if high > SLOWER else ""
        old, new = 1e3 * np.median(times, axis=0)
        print(
            f"{name:40s} {old:10.2f} {new:10.2f} {ratio:7.3f}   {low:.3f} to {high:.3f}{mark}",
            flush=True,
        )
    return slower


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("revision", nargs="?", help="what to compare with, as git names it")
    parser.add_argument("--rounds", type=int, default=10, help="calls in one process (10)")
    parser.add_argument("--processes", type=int, default=3, help="of either revision (3)")
    parser.add_argument("--only", default="", help="what has this in its name")
    parser.add_argument("--serve", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.serve:
        serve(given.serve)
        return
    if not given.revision:
        parser.error("name the revision to compare with, such as a tag or HEAD~20")
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "before"
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--detach", "--quiet", str(tree), given.revision], check=True)
        try:
            slower = compare(tree, given.rounds, given.processes, given.only)
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)
    print(f"{slower} of these are more than {SLOWER - 1:.0%} slower than at {given.revision}")
    sys.exit(1 if slower else 0)


if __name__ == "__main__":
    main()
