"""Where recordings of others lie that are no part of the project, and how these are read."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core import quantities as si

ROOT = Path(__file__).parents[2]


def measured_file(name: str) -> Path:
    """A file of the folder that SQUEEZEFILM_DATA names, or `../shared/data` beside the checkout;
    where it is not there the test is skipped."""
    folder = Path(os.environ.get("SQUEEZEFILM_DATA", ROOT.parent / "shared" / "data"))
    path = folder / name
    if not path.exists():
        pytest.skip(f"{name} is not there: the folder of measured data is no part of the project")
    return path


def traces_4294a(path: Path) -> tuple[si.HertzArray, si.ComplexArray]:
    """Frequency and impedance of an analyser's export of magnitude and phase."""
    rows = [line.split() for line in path.read_text(encoding="latin-1").splitlines()]
    table = np.array([row for row in rows if len(row) == 3 and row[0][0].isdigit()], dtype=float)
    size, phase = np.split(table, 2)
    assert np.all(size[:, 0] == phase[:, 0])
    return size[:, 0], size[:, 1] * np.exp(1j * np.radians(phase[:, 1]))
