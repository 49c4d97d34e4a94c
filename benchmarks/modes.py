# ruff: noqa: E402 (threads are set before NumPy is imported)
"""How long `squeezefilm modes` takes for a plate, beside the full solution of the same modes.

One thread, processor time, what is compiled compiled before: twenty random plates of metal and
glass, the glass presets and a large glass plate, 20 to 60 kHz. The aim is 2 s each. The ratio is
that of `solve_modes` in the classes that are driven, for the first plates and the presets.
"""

from __future__ import annotations

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"

import dataclasses
import sys
import time
from pathlib import Path

from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.solid.resonances import screened_modes
from squeezefilm.physics.plate.solid.solve import solve_modes

BAND = 20e3, 60e3
AIM = 2.0  # s


def plates() -> dict[str, tuple[RectangularPlate, bool]]:
    """Plates by name, and whether they are solved too."""
    sys.path[:0] = [str(Path(__file__).parents[1])]
    from tests.verification.random_plates import screened_plate

    found = {f"random plate {seed}": (screened_plate(seed), seed < 4) for seed in range(20)}
    for preset in ("biet2008-plate", "basdogan2020-glass", "touchpad-glass"):
        plate = load_display(preset).actuator
        assert isinstance(plate, RectangularPlate)
        found[preset] = plate, preset != "touchpad-glass"
    edges = tuple(CeramicPatch(0.0, y, 120e-3, 5e-3, 0.5e-3) for y in (0.0, 75e-3))
    large = dataclasses.replace(
        plate, length=120e-3, width=80e-3, thickness=0.7e-3, patches=edges, supports=()
    )
    found["glass, 120 × 80 × 0.7 mm"] = large, False
    return found


def main() -> None:
    """Measure and print."""
    every = plates()
    screened_modes(every["biet2008-plate"][0], BAND)
    longest = 0.0
    print(f"{'plate':28s} {'modes':>5s} {'screened':>10s} {'solved':>10s} {'ratio':>6s}")
    for name, (plate, solved_too) in every.items():
        start = time.process_time()
        modes = screened_modes(plate, BAND)
        took = time.process_time() - start
        longest = max(longest, took)
        beside = ""
        if solved_too:
            start = time.process_time()
            solve_modes(plate, band=BAND, driven_only=True)
            full = time.process_time() - start
            beside = f"{full:8.2f} s {full / took:6.0f}"
        print(f"{name:28s} {len(modes):5d} {took:8.2f} s {beside}", flush=True)
    print(
        f"longest {longest:.2f} s of processor, {'within' if longest <= AIM else 'above'} {AIM:g} s"
    )


if __name__ == "__main__":
    main()
