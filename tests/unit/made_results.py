"""A result that nothing computed: it is what a test says, and what follows from that."""

from __future__ import annotations

from types import FunctionType
from typing import Any

from squeezefilm.physics.plate.heat_states import WarmState
from squeezefilm.physics.plate.warming import Warming


def made_result(kind: type, **values: Any) -> Any:
    """An instance of `kind` whose fields and properties are these; functions take no self."""
    own = {k: staticmethod(v) if isinstance(v, FunctionType) else v for k, v in values.items()}
    return type(kind.__name__, (kind,), {**own, "__init__": lambda _: None})()


WARM = Warming(
    frequency=33.58e3, half_bandwidth=279.8, cold_amplitude=2.449e-6, cold_power=7.86,
    thermal_resistance=9.418, heat_capacity=40.0, thermal_time=376.6,
    tracked=WarmState(73.51, -246.8, 2.446e-6, 7.8), fixed=WarmState(55.1, -185.2, 2.037e-6, 5.4),
    other_fixed=(), time_to_fall=309.0, speed=0.366, field=15e3, assumed=("still air", "linear"),
    doubts=("it is hot",),
)  # fmt: skip
"""What a plate's losses do to it."""

WARM_LINES = [
    "Temperature rise +73.5 K if the drive follows; +55.1 K if fixed",
    "Drift of the resonance −247 Hz −185 Hz if fixed; half-bandwidth 280 Hz",
    "Amplitude warm 2.45 µm if the drive follows the resonance, without a finger",
    "2.04 µm at a fixed 33.58 kHz, of 2.45 µm cold; a tenth is gone after 310 s",
    "Thermal resistance 9.42 K/W time constant 380 s; assumed: still air; linear",
]
"""How `WARM` is said."""
