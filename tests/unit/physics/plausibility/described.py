"""Displays to describe wrongly: every number of one, and the same display with one changed."""

import dataclasses
from typing import Any

import numpy as np
from tests.verification.random_plates import SUBSTRATES, random_plate

from squeezefilm.core import presets
from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plausibility.checks import described_numbers

Path = tuple[str | int, ...]
# Signs and places are no sizes.
_NO_SIZE = ("polarity", "poling", "x", "y")


def numbers(display: Display) -> list[tuple[Path, float]]:
    """Every number of a description that has a size, with its path."""
    return [
        (path, value)
        for _, path, value in described_numbers(display)
        if value != 0 and path[-1] not in _NO_SIZE
    ]


def changed(owner: Any, path: Path, value: float) -> Any:
    """The same description with another value at a path. Raises what its parts raise."""
    if not path:
        return value
    first, *rest = path
    if isinstance(first, int):
        return tuple(
            changed(item, tuple(rest), value) if n == first else item
            for n, item in enumerate(owner)
        )
    own = getattr(owner, first)
    if not rest and isinstance(own, int):
        value = int(value)
    return dataclasses.replace(owner, **{first: changed(own, tuple(rest), value)})


def displays() -> list[Display]:
    """All presets."""
    return [load_display(name) for name in presets.display_names()]


def plausible_display(rng: np.random.Generator) -> Display:
    """A preset's surroundings with a plate such as is built: strips of one size, one or two faces,
    of metal or glass, glued or not, working above what is heard, and driven to a few µm with no
    more than 20 V per mm of ceramic, as far as a beam says so."""
    base = load_display("biet2008-plate")
    while True:
        try:
            plate = random_plate(int(rng.integers(1_000_000)))
            plate = dataclasses.replace(
                plate,
                substrate=SUBSTRATES[int(rng.integers(len(SUBSTRATES)))],
                quality_factor=float(rng.uniform(20, 400)),
            )
            beam = beam_response(plate)
        except InputError:
            continue
        # Strips that lie so that they do not drive the mode move it by rounding alone.
        most = 20e3 * plate.ceramic_thickness
        if not 25e3 < beam.mode.frequency < 150e3 or most * beam.amplitude_per_volt < 0.2e-6:
            continue
        enough = rng.uniform(0.5e-6, 3e-6) / beam.amplitude_per_volt
        drive = dataclasses.replace(base.drive, voltage=float(np.clip(enough, 1.0, most)))
        return dataclasses.replace(base, actuator=plate, drive=drive)
