# ruff: noqa: E402 (threads are set before NumPy is imported)
"""The paper's plate, mode (8,0): error and time of the solver against its peers, in one run.

One thread. Peers run in the same process where they are installed: scikit-fem with the largest
uniform quadratic mesh that fits, assembled on the quarter plate as ours (a favour to it), and
NGSolve graded on a quarter. Prints errors against the converged value, times, ratios and memory.
"""

from __future__ import annotations

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"

import dataclasses
import importlib.util
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from squeezefilm.display import load_display
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.plate_response import harmonic_response
from squeezefilm.plate.solve_modes import solve_modes

CONVERGED = {"from_d31": 33574.0, "printed_e31": 33422.0}


def memory() -> float:
    """Peak memory of this process so far (GB)."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def best(run: Callable[[], float], repeats: int) -> tuple[float, float, float]:
    """The run's value, its best wall time and its best processor time (s)."""
    value, wall, cpu = run(), np.inf, np.inf
    for _ in range(repeats):
        w, c = time.perf_counter(), time.process_time()
        value = run()
        wall, cpu = min(wall, time.perf_counter() - w), min(cpu, time.process_time() - c)
    return value, wall, cpu


def main() -> None:
    """Measure and print."""
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    base = memory()
    print(f"{'solver':46s} {'data set':12s} {'f (Hz)':>9s} {'error':>8s} {'wall':>8s} {'cpu':>8s}")
    ours: dict[str, tuple[float, float]] = {}

    def row(name: str, data: str, value: float, wall: float, cpu: float) -> float:
        error = value / CONVERGED[data] - 1
        print(f"{name:46s} {data:12s} {value:9.1f} {error:+8.3%} {wall:7.3f}s {cpu:7.3f}s")
        return abs(error)

    for data in CONVERGED:
        one = dataclasses.replace(plate, ceramic=dataclasses.replace(plate.ceramic, data_set=data))

        def frequency(one: RectangularPlate = one) -> float:
            return float(solve_modes(one, mode=(8, 0)).frequencies[0])

        value, wall, cpu = best(frequency, 5)
        ours[data] = row("squeezefilm solve_modes", data, value, wall, cpu), wall
    f = np.linspace(32.5e3, 34.5e3, 200)

    def sweep() -> float:
        return float(harmonic_response(plate, f).maximum.max())

    amplitude, wall, cpu = best(sweep, 3)
    print(f"200-point response with admittance: {wall:.3f} s wall, {cpu:.3f} s cpu; "
          f"largest amplitude {amplitude * 1e9:.1f} nm/V")  # fmt: skip
    print(f"peak memory so far {memory():.2f} GB (of which {base:.2f} GB before solving)")
    if importlib.util.find_spec("skfem") is None:
        print("scikit-fem is not installed: not compared")
    else:
        _against_skfem(row, ours)
    if importlib.util.find_spec("ngsolve") is None:
        print(
            "NGSolve is not installed: not compared (PLATES.md: quarter, graded, 3.95 s, 0.104 %)"
        )


def _against_skfem(
    row: Callable[[str, str, float, float, float], float], ours: dict[str, tuple[float, float]]
) -> None:
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from tests.verification.skfem_plate import skfem_frequencies
    from tests.verification.test_solid_elements import monomorph_on_a_uniform_mesh

    for strip, across in ((4, 12), (8, 16)):
        model = monomorph_on_a_uniform_mesh(strip, across)
        whole = dataclasses.replace(model)
        w, c = time.perf_counter(), time.process_time()
        found = skfem_frequencies(whole, 33.9e3, 6)
        wall, cpu = time.perf_counter() - w, time.process_time() - c
        value = float(found[np.argmin(np.abs(found - 33.75e3))])
        error = row(f"scikit-fem quarter, {strip}/{across}/1/1", "printed_e31", value, wall, cpu)
        mine = ours["printed_e31"]
        slower, worse = wall / mine[1], error / mine[0]
        print(f"  ratio: {slower:.0f} times our time at {worse:.0f} times our error; ", end="")
        print(f"peak memory {memory():.2f} GB")


if __name__ == "__main__":
    main()
