"""What really happened in a twin: rows of truth in memory, the newest, and in a file, all."""

from __future__ import annotations

from pathlib import Path
from typing import TextIO

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.twin.plant_kernel import COLUMNS


class TruthRecord:
    """Rows of the truth, their columns named in `COLUMNS`. Memory is bounded; the file is not.

    The file is a CSV that grows by whole lines and is flushed with each block of them; numbers
    read back exactly.
    """

    def __init__(self, rows: int, file: Path | None = None) -> None:
        """Keep the newest `rows`; append all to `file`. Raises `InputError` if it can't be."""
        self._rows = np.empty((rows, len(COLUMNS)))
        self._written = 0
        self._file: TextIO | None = None
        if file is not None:
            try:
                self._file = file.open("w", encoding="utf-8", newline="")
            except OSError as error:
                raise InputError(
                    f"cannot write the truth to {file}: {error.strerror}; give another file"
                ) from error
            self._file.write(",".join(COLUMNS) + "\n")

    def append(self, rows: si.FloatArray) -> None:
        """Add rows, shape (n, columns)."""
        if self._file is not None:
            lines = (",".join(repr(float(v)) for v in row) for row in rows)
            self._file.write("".join(line + "\n" for line in lines))
            self._file.flush()
        size = self._rows.shape[0]
        newest = rows[-size:]
        first = self._written + len(rows) - len(newest)
        self._rows[(first + np.arange(len(newest))) % size] = newest
        self._written += len(rows)

    @property
    def written(self) -> int:
        """How many rows there have been."""
        return self._written

    @property
    def rows(self) -> si.FloatArray:
        """The rows kept, oldest first, shape (n, columns); a copy."""
        size = self._rows.shape[0]
        if self._written <= size:
            return self._rows[: self._written].copy()
        return np.roll(self._rows, -(self._written % size), axis=0)

    def column(self, name: str) -> si.FloatArray:
        """One column of the rows kept. Raises `InputError` for another name."""
        if name not in COLUMNS:
            raise InputError(f"the truth has no column '{name}'; it has {', '.join(COLUMNS)}")
        return self.rows[:, COLUMNS.index(name)]

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()
            self._file = None
