"""The order of rows: what must rise from one to the next, and which two say the same."""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings.quantities_read import QUANTITIES, Reading, quantity, words


def rising_order(reading: Reading, name: str, values: si.FloatArray) -> slice:
    """The rows in which a quantity rises: as they are, or turned around where all of them fall."""
    if name != "time" and np.all(np.diff(values) < 0):
        reading.facts.append((words(name), "swept downwards; the rows were turned around"))
        return slice(None, None, -1)
    require_rising(reading, name, values)
    return slice(None)


def require_rising(reading: Reading, name: str, values: si.FloatArray) -> None:
    """Refuse values that do not rise from row to row, with the row."""
    still = np.flatnonzero(np.diff(values) <= 0)
    if not still.size:
        return
    row, unit = int(still[0]) + 1, QUANTITIES[name].unit
    now, before = (quantity(values[k], unit) for k in (row, row - 1))
    if values[row] == values[row - 1]:
        raise reading.refuse(
            name, f"{now} stands twice, in {both_rows(reading, row - 1, row)}; delete one row", row
        )
    table = reading.table.values
    others = [
        k
        for k in range(table.shape[1])
        if np.all(np.diff(table[:, k]) > 0) and not np.array_equal(table[:, k], values)
    ]
    hint = "give the rows in order"
    if others:
        called = reading.table.names[others[0]]
        hint = f"column {others[0] + 1} '{called}' does: are columns swapped in the description?"
    raise reading.refuse(
        name, f"{now} follows {before}, and must rise from row to row; {hint}", row
    )


def both_rows(reading: Reading, first: int, second: int) -> str:
    """Two rows by their lines."""
    lines = reading.table.lines
    if lines is None:
        return f"values {first + 1} and {second + 1}"
    return f"lines {lines[first]} and {lines[second]}"
