"""The whole verb `analyze` with its report: what an engineer waits for, and what takes the time.

Wall-clock times and, in brackets, processor times (user and system, all processes of the verb),
imports included, what was compiled loaded from the cache, the least of some runs.
"first" solves the plate and the films under the finger, "again" finds what the run before it kept
on disk, "changed" is again with a force that no run had, whose draws are drawn anew. The peer is
`predict` alone in the same process. Steps are processor time; one takes all until the next is told.
The speed of a machine drifts: compare within one run only.
Run: python benchmarks/analyze.py [DISPLAY …]
"""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["NUMBA_NUM_THREADS"] = "1"

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROUNDS = 3
DISPLAYS = ("biet2008-plate", "biet2008-stator", "touchpad-glass")
PREDICT = ("resonance, amplitude and friction", "solve")

# Its own process, as a person starts it: imports are waited for too.
STEPS = """
import json, sys, time
took, last = {}, ["imports", 0.0]
def tell(text):
    name, began = last
    now = time.process_time()
    name = "draws" if " draw " in name else name
    name = "solve" if name.startswith(("coarse", "fine", "reducing", "response")) else name
    took[name] = took.get(name, 0.0) + now - began
    last[:] = [text, now]
from pathlib import Path
from squeezefilm.design.analysis.analyze import analyze
from squeezefilm.physics.display import load_display
from squeezefilm.design.analysis.report.page import write_analysis
display = load_display(sys.argv[1])
force = float(sys.argv[3]) * display.finger.normal_force
analysis = analyze(display, normal_force=force, progress=tell)
tell("summary")
write_analysis(analysis, Path(sys.argv[2]), tell)
tell("end")
print(json.dumps(took))
"""


class Run(NamedTuple):
    """What one run took: on the clock (s), of processors (s), and its steps by name, processor
    time (s) of the first process."""

    wall: float
    processor: float
    steps: dict[str, float]


def run(display: str, folder: Path, kept: str, force: float = 1.0) -> Run:
    """Run the verb with a force over the display's own; `kept` is where films, plates and draws are
    kept, or "off"."""
    command = [sys.executable, "-c", STEPS, display, str(folder / "report"), str(force)]
    environment = os.environ | {"SQUEEZEFILM_CACHE": kept}
    began, before = time.perf_counter(), os.times()
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    wall, after = time.perf_counter() - began, os.times()
    processor = sum(after[2:4]) - sum(before[2:4])
    return Run(wall, processor, json.loads(done.stdout))


def main() -> None:
    """Print for each display how long its analysis takes, over its peers, and what limits it."""
    head = "".join(f"{name:>18}" for name in ("first", "again", "changed"))
    head += f"{'over predict':>14}"
    print(f"{'display':<16}{head}   what takes it")
    for display in sys.argv[1:] or DISPLAYS:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            kept = str(folder / "kept")
            first = run(display, folder, kept)
            # In turn, so that all meet the same machine.
            turns = [
                (
                    run(display, folder, kept),
                    run(display, folder, kept, 1.01 + 0.001 * number),
                )
                for number in range(ROUNDS)
            ]
        again, changed = (
            min(runs, key=lambda each: each.processor) for runs in zip(*turns, strict=True)
        )
        whole = sum(again.steps.values())
        predicted = sum(again.steps[step] for step in PREDICT if step in again.steps)
        ranked = sorted(again.steps.items(), key=lambda item: -item[1])[:5]
        most = ", ".join(f"{name} {100 * took / whole:.0f} %" for name, took in ranked)
        times = "".join(
            f"{each.wall:>8.1f} s ({each.processor:.1f} s)" for each in (first, again, changed)
        )
        print(f"{display:<16}{times}{whole / predicted:>14.1f}   {most}", flush=True)


if __name__ == "__main__":
    main()
