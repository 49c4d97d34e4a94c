"""Solve the panels of the film table that come with the package, in about four minutes.

    python tools/film_panels.py

writes `physics/contact/sharing/film_panels.npz`. After a change of the film solver or of the
table's nodes tests compare the file with solved films and ask for this.
"""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.contact.sharing.gas_table import (
    SHIPPED,
    SHIPPED_OCTAVES,
    SHIPPED_PANELS,
    SMOOTH_LAWS,
    START,
    Panel,
    default_tolerance,
)


def solved_octaves(slip: str, number: int) -> tuple[si.FloatArray, si.FloatArray]:
    """Coefficients of a panel by its number at the nodes of all shipped octaves, each once, and the
    bound on the error in every octave."""
    panel = Panel(slip, default_tolerance(slip), START, number)
    octaves = np.array([panel.octave_solved(octave) for octave in SHIPPED_OCTAVES])
    values = 3 * START[0] * START[1]
    rows = octaves[:, :-1].reshape(len(octaves), -1, values)
    # An octave begins where the one before it ends.
    once = np.concatenate([rows[:, :-1].reshape(-1, values), rows[-1, -1:]])
    # Decimals of logarithms: a hundredth of what the films and their interpolation err by.
    return np.round(once, 7 if slip in SMOOTH_LAWS else 5), octaves[:, -1]


def main() -> None:
    """Solve all of them and write the file."""
    arrays = {}
    for slip, numbers in SHIPPED_PANELS.items():
        found = [solved_octaves(slip, number) for number in numbers]
        arrays[f"{slip}_rows"] = np.array([rows for rows, _ in found])
        arrays[f"{slip}_bounds"] = np.array([bounds for _, bounds in found])
    np.savez_compressed(SHIPPED, **arrays)


if __name__ == "__main__":
    main()
