"""How fast `study simulate` is, and how fast identification trials are analysed; what limits it.

Run `python benchmarks/study.py` (some 60 s). The verb is timed as it is typed, in processes of its
own: with nothing felt on disk (but compiled), with it there, with pages, and for a thousand people;
beside each its processor time and the ratio to a Python that only loads
what every verb needs. Then 10 000 simulated participants with 60 trials each are analysed with
everything `analyze_identification` does, 1 000 resamples of people included; and the same confusion
matrix, information transfer and participant bootstrap in plain pandas (rows of drawn people put
together, `crosstab`, the jackknife trial by trial), of which as many resamples are made as show its
rate. These in one process, on one core.
"""

from __future__ import annotations

import os

# One core for all that is timed; has to be set before NumPy loads its linear algebra.
os.environ["OMP_NUM_THREADS"] = "1"
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas
from scipy.special import ndtr

from squeezefilm.study.identification.analysis import analyze_identification

LABELS = ("0.4 mm", "2 mm", "4 mm", "8 mm", "10 mm")
PEOPLE, TRIALS_PER_STIMULUS, RESAMPLES = 10_000, 12, 1000
PEER_RESAMPLES = 10


def simulated_counts(people: int, random: np.random.Generator) -> np.ndarray:
    """Matrices (people, answers, stimuli) of people who vary about an unbiased observer of ordered
    stimuli 1.5 d′ apart."""
    place = 1.5 * np.arange(len(LABELS))
    criteria = np.concatenate([[-np.inf], 0.5 * (place[1:] + place[:-1]), [np.inf]])
    shares = np.diff(ndtr(criteria[:, None] - place), axis=0)
    own = [random.dirichlet(20.0 * column, people) for column in shares.T]
    return np.stack([random.multinomial(TRIALS_PER_STIMULUS, one) for one in own], axis=-1)


def trials() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Participant, stimulus, choice and response time (s), one row a trial, in random order."""
    random = np.random.default_rng(1)
    counts = simulated_counts(PEOPLE, random)
    who, choice, stimulus = (
        np.repeat(index, counts.ravel()) for index in np.indices(counts.shape).reshape(3, -1)
    )
    order = random.permutation(who.size)
    return who[order], stimulus[order], choice[order], random.gamma(4.0, 0.4, who.size) + 0.2


def plain_transfer(table: np.ndarray) -> float:
    """Plug-in transfer (bit), the stimuli's shares as they are."""
    share = table.sum(axis=0) / table.sum()
    p = table / table.sum(axis=0)
    answer = (p * share).sum(axis=1)
    some = p > 0
    ratio = np.where(some, p, 1.0) / np.where(answer > 0, answer, 1.0)[:, None]
    return float((share * p * np.log2(np.where(some, ratio, 1.0))).sum())


def plain_jackknife(table: np.ndarray) -> float:
    """The same, jackknifed by stimulus, one left-out cell at a time."""
    share, whole = table.sum(axis=0) / table.sum(), plain_transfer(table)
    estimate = whole
    for i in range(table.shape[0]):
        for j in range(table.shape[1]):
            if table[i, j] == 0:
                continue
            less = table.astype(float)
            less[i, j] -= 1
            # Columns weighted by their shares in the whole table.
            less *= share / (less.sum(axis=0) / table.sum())
            many = table[:, j].sum()
            estimate += (many - 1) / many * table[i, j] * (whole - plain_transfer(less))
    return estimate


VERB = ["-m", "squeezefilm", "study", "simulate", "biet2008-gratings", "--seed", "7"]
LEAST = ["-c", "import numpy, pydantic, typer, rich.console, tomlkit"]


def timed(arguments: list[str], cache: str) -> tuple[float, float]:
    """Seconds on the wall and of processors that a Python takes."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    environment = {**os.environ, "SQUEEZEFILM_CACHE": cache}
    subprocess.run([sys.executable, *arguments], env=environment, check=True, capture_output=True)
    wall, after = time.perf_counter() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def verbs() -> None:
    """Print what the verb takes, and what limits it."""
    with tempfile.TemporaryDirectory() as folder:
        pages = ["--out", str(Path(folder) / "pages")]
        # Compiles what is not compiled yet, which is not timed.
        timed([*VERB, *pages], str(Path(folder) / "compiling"))
        least, _ = min(timed(LEAST, folder) for _ in range(3))
        kept = str(Path(folder) / "kept")
        print(f"least: {least:.2f} s for a Python with NumPy and what reads files")
        for said, more in (
            ("12 people, nothing felt on disk", ["--participants", "12"]),
            ("12 people, all on disk", ["--participants", "12"]),
            ("12 people, with pages", ["--participants", "12", *pages]),
            ("1000 people", ["--participants", "1000"]),
        ):
            wall, busy = timed([*VERB, *more], kept)
            print(f"  {said:32s} {wall:6.2f} s, {busy:5.2f} s of processors, {wall / least:4.1f} ×")
    print(
        "What limits it: at first the chain from plate to skin for 60 surfaces under 6 fingers, "
        "half of it predictions; on disk, loading modules; with pages, drawing 14 figures."
    )


def main() -> None:
    """Print times, what limits them, and the ratio to the peer at equal numbers."""
    verbs()
    who, stimulus, choice, times = trials()
    stages: list[tuple[str, float]] = []

    def note(stage: str) -> None:
        stages.append((stage, time.perf_counter()))

    start = time.perf_counter()
    found = analyze_identification(
        who, stimulus, choice, LABELS, response_time=times, resamples=RESAMPLES, progress=note,
        exploration={"mean_speed_m_per_s": np.full(who.size, 0.08)},
    )  # fmt: skip
    end = time.perf_counter()
    took = end - start
    print(f"{PEOPLE} participants, {who.size} trials, {RESAMPLES} resamples: {took:.2f} s")
    ends = [moment for _, moment in stages[1:]] + [end]
    for (stage, begun), over in sorted(
        zip(stages, ends, strict=True), key=lambda pair: pair[0][1] - pair[1]
    ):
        print(f"  {stage:32s} {over - begun:6.3f} s  {100 * (over - begun) / took:3.0f} %")

    print(
        "What limits it: drawing people again (one index a person and resample) and sorting the "
        "trials by participant; all estimators of all resamples together cost less."
    )

    table = pandas.DataFrame({"who": who, "stimulus": stimulus, "choice": choice})
    start = time.perf_counter()
    people = dict(tuple(table.groupby("who")))
    split = time.perf_counter() - start
    random = np.random.default_rng(0)
    start = time.perf_counter()
    values = []
    for _ in range(PEER_RESAMPLES):
        drawn = pandas.concat([people[k] for k in random.integers(PEOPLE, size=PEOPLE)])
        counts = pandas.crosstab(drawn["choice"], drawn["stimulus"]).to_numpy()
        values.append(plain_jackknife(counts))
    each = (time.perf_counter() - start) / PEER_RESAMPLES
    peer = split + each * RESAMPLES
    whole = pandas.crosstab(table["choice"], table["stimulus"]).to_numpy()
    error = abs(plain_jackknife(whole) - found.information.estimate)
    print(
        f"pandas, jackknife and its bootstrap only: {split:.2f} s to split, {each:.3f} s a "
        f"resample ({PEER_RESAMPLES} made), {peer:.0f} s for {RESAMPLES}"
    )
    print(f"ratio {peer / took:.0f}; the transfers differ by {error:.1e} bit")


if __name__ == "__main__":
    main()
