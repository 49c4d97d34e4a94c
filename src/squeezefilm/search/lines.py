"""A file that grows by a line with every answer, from which a search that was stopped goes on."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from squeezefilm.errors import InputError


class Lines:
    """A file with a JSON object on each line; several programs may append to one.

    Raises `InputError` where the file cannot be read or written.
    """

    def __init__(self, file: Path) -> None:
        self._file = file

    def read(self, take: Callable[[Any], None]) -> None:
        """Give `take` what is on each line; what it cannot take is passed over: the end of a line
        that was cut off when its program was killed, or a line of another version."""
        try:
            self._file.parent.mkdir(parents=True, exist_ok=True)
            lines = self._file.read_bytes().splitlines() if self._file.exists() else []
        except OSError as error:
            raise InputError(
                f"cannot use {self._file}: {error.strerror}; choose another folder"
            ) from error
        for line in lines:
            try:
                take(json.loads(line))
            except (ValueError, KeyError, TypeError, AttributeError):
                continue

    def append(self, values: Iterable[Any]) -> None:
        """Add a line for each value, all in one write, so that lines of several programs do not
        mix; a line that was cut off before ends first, and swallows none of these."""
        lines = [
            json.dumps(one, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
            for one in values
        ]
        if not lines:
            return
        try:
            with self._file.open("ab") as file:
                file.write(("\n" + "\n".join(lines) + "\n").encode())
        except OSError as error:
            raise InputError(
                f"cannot write {self._file}: {error.strerror}; free space or choose another "
                "folder, and it goes on from there"
            ) from error
