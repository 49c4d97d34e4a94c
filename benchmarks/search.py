"""What asking costs: a task through processes and through Dask, a million designs, a question.

    python benchmarks/search.py [questions] [screening]

Starts a scheduler and workers on this machine and ends them. `questions` times the commands of the
how-to pages too, each with an empty cache; `screening` screens 10 000 designs of the paper's
requirements. Say with every figure which machine and what else ran.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT)]
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from tests.cluster import local_cluster  # noqa: E402
from tests.counted_tasks import busy, whose  # noqa: E402

from squeezefilm.design.sweep.workers import workers  # noqa: E402

SMALL, MANY, SECONDS = 1000, 60, 0.1
# Beside the files that they name.
OWN, FOLDER = "own_plate.toml", ROOT / "examples"
QUESTIONS = (
    ("which thickness gives most friction change at 40 kHz?",
     ["design", "forty_kilohertz.toml", "--screened", "150", "--solved", "10"]),
    ("how thick must my plate be for 40 kHz?",
     ["sweep", OWN, "--vary", "actuator.thickness=1.5 mm..2.5 mm:5",
      "--ask", "resonance_frequency,amplitude_per_volt,relative_friction"]),
    ("what do 10 µm more glue cost?",
     ["sweep", OWN, "--vary", "actuator.glue.thickness=20 um, 30 um",
      "--ask", "resonance_frequency,amplitude_per_volt,relative_friction"]),
    ("can I feel 1 mm at 150 mm/s?",
     ["analyze", "biet2008-plate", "--speed", "150 mm/s"]),
)  # fmt: skip


def timed(act: Callable[[], Any]) -> float:
    began = time.perf_counter()
    act()
    return time.perf_counter() - began


@contextmanager
def pools() -> Iterator[dict[str, Any]]:
    """One and two workers, of processes and of a cluster."""
    with local_cluster(1) as one, local_cluster(2) as two:
        # A pool of processes that has one.
        from squeezefilm.design.sweep.workers import Processes

        with (
            Processes(1) as process,
            workers(2) as processes,
            workers(scheduler=one.address) as dask_one,
            workers(scheduler=two.address) as dask_two,
        ):
            yield {
                "1 process": process, "2 processes": processes,
                "Dask, 1 worker": dask_one, "Dask, 2 workers": dask_two,
            }  # fmt: skip


def costs() -> float:
    """Prints overhead and scaling; the overhead (s) of a task through the cluster of two."""
    overhead = 0.0
    print(f"{MANY} tasks of {SECONDS} s: that wait (whatever else runs here), and that compute")
    print(f"{'who answers':18}{'overhead a task':>18}{'wait':>10}{'compute':>10}")
    with pools() as found:
        for name, pool in found.items():
            list(pool.answers(whose, {k: (k,) for k in range(8)}))

            def took(function: Any, tasks: Any, pool: Any = pool) -> float:
                return timed(lambda: list(pool.answers(function, tasks)))

            overhead = took(whose, {k: (k,) for k in range(SMALL)}) / SMALL
            wait = took(whose, {k: (k, SECONDS) for k in range(MANY)})
            compute = took(busy, dict.fromkeys(range(MANY), (SECONDS,)))
            print(f"{name:18}{1e3 * overhead:15.2f} ms{wait:8.2f} s{compute:8.2f} s")
    return overhead


def seconds_a_design() -> float:
    """Seconds of one process for a plate nobody has solved: resonance, amplitude and friction."""
    from squeezefilm.design.sweep.points import Point, answer_of
    from squeezefilm.physics.display import load_display
    from squeezefilm.physics.uncertainty.parameters import with_values

    display = load_display("biet2008-plate")
    answer_of(Point(display, {}, "predict"))
    found = [
        answer_of(Point(with_values(display, {"actuator.thickness": t}), {}, "predict")).seconds
        for t in (1.91e-3, 1.96e-3, 2.03e-3)
    ]
    return sorted(found)[1]


def million(seconds: float, overhead: float) -> None:
    """Prints what a million designs cost, each solved."""
    hours = 1e6 * seconds / 3600
    most = seconds / overhead
    print(f"\na plate solved: {seconds:.2f} s of one core; a million: {hours:.0f} core hours")
    for count in (2, 64, 512):
        print(f"  {count:4} workers: {1e6 * max(seconds / count, overhead) / 86400:.1f} days")
    print(f"one scheduler keeps some {most:.0f} workers busy at {1e3 * overhead:.1f} ms a task")


def questions() -> None:
    """Prints how long everyday questions take from the command line, with an empty cache."""
    for question, command in QUESTIONS:
        whole = [sys.executable, "-m", "squeezefilm", *command]
        with tempfile.TemporaryDirectory() as folder:
            there = os.environ | {"SQUEEZEFILM_CACHE": folder, "PYTHONPATH": sys.path[0]}
            began = time.perf_counter()
            subprocess.run(whole, env=there, check=True, capture_output=True, cwd=FOLDER)
            took = time.perf_counter() - began
        print(f"{took:6.1f} s  {question}\n          squeezefilm {' '.join(command)}")


def screening() -> None:
    """Prints how long 10 000 designs take to be proposed, screened and ranked, on two cores."""
    from squeezefilm.design.search.run import search_designs

    found = search_designs("biet2008-plate", screened=10_000, solved=0, jobs=2)
    busy_for = sum(one.seconds for one in found.screened)
    print(
        f"\n10 000 designs, {len(found.screened)} of them different: {found.seconds:.0f} s "
        f"on two cores; {1e3 * busy_for / len(found.screened):.1f} ms of one core each, which "
        f"takes {100 * busy_for / 2 / found.seconds:.0f} % of the time of both"
    )


if __name__ == "__main__":
    print(f"{os.cpu_count()} cores; load before: {os.getloadavg()[0]:.1f}")
    a_task = costs()
    million(seconds_a_design(), a_task)
    if "screening" in sys.argv[1:]:
        screening()
    if "questions" in sys.argv[1:]:
        questions()
