# ruff: noqa: E402 (threads are set before NumPy is imported)
"""The time that a plate's solve is expected to take against the processor time that it takes.

Plates of metal and of glass, thick and thin, small and large, by one thread; by these
`physics/plate/solid/forecast.py` is calibrated.
"""

from __future__ import annotations

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"

import dataclasses
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.forecast import estimated_frequency, solve_size
from squeezefilm.physics.plate.solid.working import solid_mode


def plates() -> Iterator[tuple[str, RectangularPlate]]:
    """Plates by what they are."""
    sys.path.insert(0, str(Path(__file__).parent))
    from plate import large_sheet

    changed = dataclasses.replace
    own = Path(__file__).parents[1] / "examples" / "own_plate.toml"
    metal, glass, pad, mine = (
        load_display(one).actuator
        for one in ("biet2008-plate", "basdogan2020-glass", "touchpad-glass", str(own))
    )
    for plate in (metal, glass, pad, mine):
        assert isinstance(plate, RectangularPlate)
    steel = changed(metal.substrate, young_modulus=193e9, density=8000.0)
    yield "copper-beryllium", metal
    yield "of steel", changed(metal, substrate=steel)
    yield "1 mm thick", changed(metal, thickness=1e-3)
    yield "3 mm thick", changed(metal, thickness=3e-3)
    yield "12 nodal lines", changed(metal, nodal_lines=12)
    yield "one ceramic of all", changed(metal, patches=metal.patches[:1])
    yield "a first plate of one's own", mine
    yield "glass with two strips", glass
    yield "touch pad", pad
    yield "touch pad, 1.5 mm thick", changed(pad, thickness=1.5e-3)
    yield "touch pad without a gasket", changed(pad, supports=())
    yield "touch pad with one strip", changed(pad, patches=pad.patches[:1])
    yield "large sheet", large_sheet()
    yield "large sheet, 1.1 mm thick", changed(large_sheet(), thickness=1.1e-3)


def main() -> None:
    """Measure and print."""
    print(f"{'plate':28s} {'unknowns':>9s} {'expected':>9s} {'took':>8s} {'ratio':>6s}")
    ratios = []
    for what, plate in plates():
        label = plate.working_label
        size = solve_size(plate, label, estimated_frequency(plate, label))
        clock = time.process_time()
        solid_mode(plate)
        took = time.process_time() - clock
        ratios.append(size.seconds / took)
        print(
            f"{what:28s} {size.unknowns:9d} {size.seconds:7.2f} s {took:6.2f} s {ratios[-1]:6.2f}"
        )
    print(f"from {min(ratios):.2f} to {max(ratios):.2f} times the processor time")


if __name__ == "__main__":
    main()
