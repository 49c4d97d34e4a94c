"""A file that grows by a line with every answer, from which a search that was stopped goes on."""

from __future__ import annotations

import json
import os
import re
import warnings
import zlib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from squeezefilm.core.errors import ConfigError, InputError, SqueezefilmWarning
from squeezefilm.core.hard_limits import LINES_BYTES
from squeezefilm.core.regular_file import parsed_json, read_regular, require_regular

SET_ASIDE = ".damaged"
"""Suffix of a file's name for the lines of it that were damaged."""

_CHECK = re.compile(rb',"check":"([0-9a-f]{8})"\}')
_CHECK_SIZE = len(b',"check":"01234567"}')


def _checked_line(values: dict[str, Any]) -> bytes:
    """A JSON object on a line of its own, and in it a checksum of the others of its bytes."""
    text = json.dumps(values, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode()
    return text[:-1] + b',"check":"%08x"}' % zlib.crc32(text)


def _is_damaged(line: bytes) -> bool:
    """True where a line is not what was written: by its checksum, or, without one, no JSON."""
    if (check := _check_of(line)) is not None:
        return check != zlib.crc32(line[:-_CHECK_SIZE] + b"}")
    try:
        parsed_json(line)
    except ValueError:
        return True
    return False


def _check_of(line: bytes) -> int | None:
    """The checksum that a line states; None for one without."""
    match = _CHECK.fullmatch(line[-_CHECK_SIZE:])
    return None if match is None else int(match[1], 16)


class Lines:
    """A file with a JSON object on each line; several programs may append to one.

    Raises `InputError` where the file cannot be read or written, and for what is no regular file.
    """

    def __init__(self, file: Path) -> None:
        self._file = file

    def read(self, take: Callable[[Any], None]) -> None:
        """Give `take` what is on each line.

        A line of another version (without a checksum, or one that it cannot take) is passed over,
        and so is the half of a line that a program left which was killed. A damaged line is
        blanked, and kept in a file beside this one; a `SqueezefilmWarning` names it.
        """
        try:
            self._file.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"cannot use {self._file}: {error.strerror}; choose another folder"
            ) from error
        if not os.path.lexists(self._file):
            return
        data = read_regular(self._file, LINES_BYTES, "a file of answers, or move it away")
        begin, damaged = 0, []
        for number, line in enumerate(data.splitlines(keepends=True), 1):
            begin, here = begin + len(line), begin
            content = line.strip()
            if not content or (content.startswith(b"{") and not content.endswith(b"}")):
                continue
            if _is_damaged(content):
                damaged.append((number, here, content))
                continue
            if _check_of(content) is None:
                continue
            try:
                take(parsed_json(content))
            # Any fault of a value, where another version meant something else by it.
            except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError):
                continue
        if damaged:
            self._set_aside(data, damaged)

    def _set_aside(self, data: bytes, damaged: list[tuple[int, int, bytes]]) -> None:
        """Keep damaged lines beside the file, and put blanks in their place.

        Other programs append meanwhile: nothing of the file is moved, nor its end touched.
        """
        place = self._file.with_name(self._file.name + SET_ASIDE)
        try:
            require_regular(place, "a file of damaged lines")
            with place.open("ab") as beside:
                beside.write(b"".join(line + b"\n" for _, _, line in damaged))
            with self._file.open("rb+") as file:
                for _, begin, line in damaged:
                    start = data.index(line, begin)
                    file.seek(start)
                    file.write(b" " * len(line))
            kept = f"set aside in {place.name}"
        except (OSError, ConfigError) as error:
            kept = f"skipped (they could not be saved: {error})"
        numbers = [str(number) for number, _, _ in damaged]
        which = ", ".join(numbers[:5]) + (f" and {len(numbers) - 5} more" if numbers[5:] else "")
        warnings.warn(
            f"{self._file}: damaged lines ({which}) are {kept}; what they held is computed again",
            SqueezefilmWarning,
            stacklevel=2,
        )

    def append(self, values: Iterable[dict[str, Any]]) -> None:
        """Add a line for each value, all in one write, so that lines of several programs do not
        mix; a line that was cut off before ends first, and swallows none of these."""
        lines = [_checked_line(value) for value in values]
        if not lines:
            return
        try:
            with self._file.open("ab") as file:
                file.write(b"\n" + b"\n".join(lines) + b"\n")
        except OSError as error:
            raise InputError(
                f"cannot write {self._file}: {error.strerror}; free space or choose another "
                "folder, and it goes on from there"
            ) from error
