"""The whole verb `analyze` with its report: what an engineer waits for, and what takes the time.

Peer: the same answer without report and interval, `predict` alone, in the same process. Times are
those of the processor, one thread, of the process that computes (another draws the figures
meanwhile), what was compiled loaded from the cache; the verb is run once before it is measured.
"asked again" finds the films that the run before it solved and kept on disk, "first" solves them.
A step takes all until the next one is told.
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
from pathlib import Path

ROUNDS = 2
DISPLAYS = ("biet2008-plate", "biet2008-stator", "touchpad-glass")
PREDICT = ("resonance, amplitude and friction", "solve")

# Its own process, as a person starts it: imports are waited for too.
STEPS = """
import json, sys, time
took, last = {}, ["imports", 0.0]
def tell(text):
    name, began = last
    now = time.process_time()
    name = "what figures show" if name.startswith("figure") else name
    name = "solve" if name.startswith(("coarse", "fine", "reducing")) else name
    took[name] = took.get(name, 0.0) + now - began
    last[:] = [text, now]
from pathlib import Path
from squeezefilm.analysis.analyze import analyze
from squeezefilm.display import load_display
from squeezefilm.report.display.figures import drawing, prepare
from squeezefilm.report.display.page import write_analysis
from squeezefilm.report.kit.drawing_process import drawing_process
with drawing_process(True, prepare, drawing) as aside:
    found = analyze(load_display(sys.argv[1]), progress=tell)
    tell("summary")
    write_analysis(found, Path(sys.argv[2]), tell, aside)
tell("end")
print(json.dumps(took))
"""


def steps(display: str, folder: Path, kept: str) -> dict[str, float]:
    """Processor time (s) of each step of one run; `kept` is where films are kept, or "off"."""
    command = [sys.executable, "-c", STEPS, display, str(folder / "report")]
    environment = os.environ | {"SQUEEZEFILM_CACHE": kept}
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def main() -> None:
    """Print the least of some rounds for each display, and what limits it."""
    print(f"{'display':<16}{'first':>8}{'asked again':>13}{'over predict':>14}   what takes it")
    for display in sys.argv[1:] or DISPLAYS:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            rounds = [steps(display, folder, str(folder / "kept")) for _ in range(ROUNDS + 1)][1:]
            first = sum(steps(display, folder, "off").values())
        best = min(rounds, key=lambda one: sum(one.values()))
        whole = sum(best.values())
        predicted = sum(best[step] for step in PREDICT if step in best)
        ranked = sorted(best.items(), key=lambda item: -item[1])[:5]
        most = ", ".join(f"{name} {100 * took / whole:.0f} %" for name, took in ranked)
        times = f"{first:>6.1f} s{whole:>11.1f} s{whole / predicted:>14.1f}"
        print(f"{display:<16}{times}   {most}", flush=True)


if __name__ == "__main__":
    main()
