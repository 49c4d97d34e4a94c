"""Files as they come out of accidents and attacks: presets with a few things done to them."""

from __future__ import annotations

import json
import os
import random
import re
from collections.abc import Callable
from pathlib import Path

from squeezefilm.core import presets

_NUMBER = re.compile(r"(?<![\w.\"'-])[+-]?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?(?![\w.])")
# A value of a line: a number at the beginning of a text, or a bare one after an equal sign.
_VALUE = re.compile(
    r"(?:(?<==\s)|(?<=\"))[+-]?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?(?=[\s\",}\]]|$)", re.M
)
_KEY = re.compile(r"^([A-Za-z_][\w-]*)(\s*=\s*)(.+)$", re.M)

_NUMBERS = (
    "0", "-0.0", "-1", "1", "2", "1e308", "-1e308", "1e-308", "5e-324", "1e400", "nan", "inf",
    "-inf", "1e9", "1e-9", "1000000", "99999999999999999999", "0.5", "1e99999999999999999999",
)  # fmt: skip
_OTHERS = (
    '""', '" "', "true", "[]", "{}", "[[[]]]", "1979-05-27", '"NaN m"', '"1e400 m"', '"-1 mm"',
    '"0 Hz"', '"∞ m"', '"１ mm"', '"1 mm\\u0000"', '"\\u202e1 mm"', "'''\n'''", '"1 m99"',
    '"1 m-99"', '"2 um um um"', '"9e9 GPa"', '"1e-30 m"', "[1, 2]", '{ value = "1 mm" }',
    '{ value = 1, uncertainty = "500 %" }', "0x7fffffffffffffff", "-9223372036854775808",
)  # fmt: skip
_STROKES = (
    "60 mm/s over 4 cm", "60 mm/s over 4 cm, 3 passes", "4 cm in 0.5 s, 2 passes",
    "60 mm/s over 4 cm, from 5 mm", "60 mm/s over 2 cm, at 30 deg, y 2 mm", "80 mm/s over 3 cm",
)  # fmt: skip


def preset_files() -> dict[str, list[Path]]:
    """The preset files by what they describe: displays, textures, studies."""
    return {
        "display": [presets.path(name) for name in presets.display_names()],
        "texture": [presets.resolve(name, "texture") for name in presets.texture_names()],
        "study": [presets.resolve(name, "study") for name in presets.study_names()],
    }


def mutated(text: str, chance: random.Random) -> bytes:
    """A file's text with one to three things done to it."""
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        text = chance.choice(_CHANGES)(text, chance)
    data = text.encode("utf-8", "surrogatepass")
    if chance.random() < 0.08:
        data = _flipped(data, chance)
    return data


def mutated_stroke(chance: random.Random) -> str:
    """A finger's motion in words with one or two of its numbers changed."""
    text = chance.choice(_STROKES)
    for _ in range(chance.choice((1, 1, 2))):
        text = chance.choice((_scaled, _scaled, _replaced, _odd_text))(text, chance)
    return text


def _pick(pattern: re.Pattern[str], text: str, chance: random.Random) -> re.Match[str] | None:
    found = list(pattern.finditer(text))
    return chance.choice(found) if found else None


def _put(text: str, match: re.Match[str], new: str) -> str:
    return text[: match.start()] + new + text[match.end() :]


def _number(text: str, chance: random.Random) -> re.Match[str] | None:
    return _pick(_VALUE, text, chance) or _pick(_NUMBER, text, chance)


def _scaled(text: str, chance: random.Random) -> str:
    """A value times a power of ten: near ones often, since those are nearly accepted."""
    match = _number(text, chance)
    power = chance.choice((1, 1, 1, 2, 2, 3, 3, 4, 6, 9, 15, 40, 300)) * chance.choice((-1, 1))
    if match is None:
        return text
    new = float(match[0]) * 10.0**power if abs(power) < 300 else f"{match[0]}e{power}"
    if re.fullmatch(r"[+-]?\d+", match[0]) and isinstance(new, float) and new.is_integer():
        new = int(new)
    return _put(text, match, str(new))


def _replaced(text: str, chance: random.Random) -> str:
    match = _number(text, chance)
    return text if match is None else _put(text, match, chance.choice(_NUMBERS))


def _negated(text: str, chance: random.Random) -> str:
    match = _number(text, chance)
    return text if match is None else _put(text, match, f"-{match[0].lstrip('+-')}")


def _nearby(text: str, chance: random.Random) -> str:
    """A value a little, or some times, larger or smaller: most of these are good displays."""
    match = _number(text, chance)
    if match is None:
        return text
    return _put(text, match, f"{float(match[0]) * chance.uniform(0.3, 3.0):.6g}")


def _retyped(text: str, chance: random.Random) -> str:
    match = _pick(_KEY, text, chance)
    return (
        text if match is None else _put(text, match, match[1] + match[2] + chance.choice(_OTHERS))
    )


def _swapped(text: str, chance: random.Random) -> str:
    one, other = _pick(_KEY, text, chance), _pick(_KEY, text, chance)
    if one is None or other is None or one.start() >= other.start():
        return text
    text = _put(text, other, other[1] + other[2] + one[3])
    return _put(text, one, one[1] + one[2] + other[3])


def _line_gone(text: str, chance: random.Random) -> str:
    lines = text.splitlines(keepends=True)
    at = chance.randrange(len(lines))
    return "".join(lines[:at] + lines[at + chance.choice((1, 1, 3)) :])


def _line_twice(text: str, chance: random.Random) -> str:
    lines = text.splitlines(keepends=True)
    at = chance.randrange(len(lines))
    return "".join(lines[: at + 1] * chance.choice((1, 1, 1, 30)) + lines[at:])


def _odd_text(text: str, chance: random.Random) -> str:
    at = chance.randrange(len(text) + 1)
    new = chance.choice(("\0", "é", "\u202e", "𝟏", "\ufeff", '"', "\\", "\n", "[", "]]", "=", "#",
                         "e" * 50, "9" * 400, " " * 3000, "m*" * 500, "\ud800"))  # fmt: skip
    return text[:at] + new + text[at:]


def _renamed(text: str, chance: random.Random) -> str:
    match = _pick(_KEY, text, chance)
    if match is None:
        return text
    return _put(text, match, match[1][:-1] + chance.choice(("", "s", "é")) + match[2] + match[3])


def _long(text: str, chance: random.Random) -> str:
    match = _pick(_KEY, text, chance)
    long = chance.choice((json.dumps("x" * 20_000), "[" * 150 + "]" * 150, "1" * 6000, '"1 m*m*m"'))
    return text if match is None else _put(text, match, match[1] + match[2] + long)


def _flipped(data: bytes, chance: random.Random) -> bytes:
    flipped = bytearray(data)
    for _ in range(chance.choice((1, 2, 20))):
        if flipped:
            flipped[chance.randrange(len(flipped))] ^= 1 << chance.randrange(8)
    return bytes(flipped)


_CHANGES = (
    _scaled, _scaled, _scaled, _scaled, _replaced, _replaced, _negated, _nearby, _nearby, _nearby,
    _retyped, _retyped, _swapped, _line_gone, _line_twice, _odd_text, _renamed, _long,
)  # fmt: skip


def damage_file(file: Path, chance: random.Random) -> str:
    """Do to a file what an accident or an attacker does to one of this program; says what.

    One to three bits turned, a cut, zeros, a line of 200 000 brackets, a line twice or gone, or in
    its place a pipe, a link to a device that has no end, or a folder.
    """
    data = file.read_bytes()
    kind = chance.choice(
        ("bits", "bits", "bits", "bits", "cut", "zeros", "brackets", "lines", *_NO_FILES)
    )
    if kind in _NO_FILES:
        file.unlink()
        _NO_FILES[kind](file)
        return kind
    where = chance.randrange(len(data) + 1)
    if kind == "bits":
        changed = bytearray(data)
        for _ in range(chance.choice((1, 1, 3)) if data else 0):
            changed[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
        file.write_bytes(changed)
    elif kind == "cut":
        file.write_bytes(data[:where])
    elif kind == "zeros":
        file.write_bytes(data[:where] + bytes(40) + data[where + 40 :])
    elif kind == "brackets":
        begin = data.rfind(b"\n", 0, where) + 1
        bracket = chance.choice((b"[", b'{"a":', b"[{"))
        file.write_bytes(data[:begin] + bracket * 200_000 + b"\n" + data[begin:])
    else:
        lines = data.splitlines(keepends=True) or [b""]
        number = chance.randrange(len(lines))
        lines[number : number + 1] = [lines[number]] * chance.choice((0, 2))
        file.write_bytes(b"".join(lines))
    return kind


_NO_FILES: dict[str, Callable[[Path], None]] = {
    "pipe": lambda file: os.mkfifo(file),
    "device": lambda file: file.symlink_to("/dev/zero"),
    "folder": lambda file: file.mkdir(),
}
