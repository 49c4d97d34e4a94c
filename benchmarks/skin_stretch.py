"""Sixty voltages to the strain of the skin, and its peer; run `python benchmarks/skin_stretch.py`.

A pattern at 1 kHz on the preset's array, one core: for each instant voltages by the texture
algebra, then strains of all cells by one product with a matrix (all contactors stick), and with
contactors that slip. The peer is the same product by NumPy alone on a matrix of the same size, in
the same run: what is above it is the package's own checks and copies. Prints medians, the ratio to
the peer, and how many times real time a pattern of 1 kHz is.
"""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = "1"

import time
from collections.abc import Callable

import numpy as np

from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.skin_stretch.array import SkinStretchArray
from squeezefilm.actuators.skin_stretch.cradle import pattern_voltages
from squeezefilm.physics.render.texture.shapes import SineWave

RATE, SPEED, REPEATS = 1e3, 0.05, 300


def median(run: Callable[[], object], repeats: int = REPEATS) -> float:
    """Seconds of processor time."""
    run()
    taken = []
    for _ in range(repeats):
        begun = time.process_time()
        run()
        taken.append(time.process_time() - begun)
    return float(np.median(taken))


def main() -> None:
    """Measure and print."""
    array: SkinStretchArray = load_actuator("biet2008-skin-stretch").skin_stretch  # type: ignore[attr-defined]
    volts, wave = array.actuator.largest_voltage, SineWave(4.8e-3)
    per_volt = array.strain_per_force()[2] @ array.force_per_volt
    matrix = np.ascontiguousarray(per_volt.reshape(-1, array.cradle.count))
    times = np.arange(100) / RATE
    rows = pattern_voltages(wave, array.cradle, times, (SPEED, 0.0), volts)

    def pattern() -> np.ndarray:
        return pattern_voltages(wave, array.cradle, times, (SPEED, 0.0), volts)

    peer = median(lambda: matrix @ rows[0])
    all_of_them = matrix.shape[0]
    said = {
        "plain product, one instant (peer)": peer,
        "voltages of an instant, 100 at once": median(pattern) / times.size,
        "strain of an instant": median(lambda: per_volt @ rows[0]),
        "strain of an instant, 100 at once": median(lambda: per_volt @ rows.T, 50) / times.size,
        "forces with slip, an instant": median(lambda: array.answers(rows), 5) / times.size,
    }
    print(f"{all_of_them} strains of {array.cradle.count} voltages, {matrix.nbytes / 1e6:.1f} MB")
    for name, taken in said.items():
        print(
            f"{name:38s} {1e6 * taken:8.1f} µs {taken / peer:6.2f} × peer "
            f"{1 / RATE / taken:7.0f} × real time at {RATE / 1e3:g} kHz"
        )
    print(
        "The product reads its matrix once, so the memory limits it; many instants at once read it "
        "once for all of them. Slip takes a least-squares problem with bounds at each instant."
    )


if __name__ == "__main__":
    main()
