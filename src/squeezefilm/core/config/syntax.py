"""Texts that are no TOML: refused where parsers would take long, explained where they are wrong.

The parser says what it expected; a person wants to know what to write. The line that it stopped at
is looked at for the slips that people make.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import DESCRIPTION_BYTES

_PLACE = re.compile(r"\s*\(at (?:line (\d+), column (\d+)|end of document)\)$")
_CURLY = "“”„‟«»‘’‚′″"
_BLANKS = {
    "\u00a0": "a non-breaking blank",
    "\u202f": "a narrow non-breaking blank",
    "\u2009": "a thin blank",
    "\u200b": "a blank of no width",
    "\ufeff": "a byte order mark",
}
_KEY = r"\s*(?P<key>[A-Za-z_][\w.-]*)\s*"
_LONGEST_SHOWN = 80


@dataclass(frozen=True)
class _Line:
    """A line of a file, and what it seems to say."""

    number: int
    text: str
    file: str | Path | None

    @property
    def key(self) -> str:
        """The key before the sign of equality, "key" where none is to be seen."""
        match = re.match(_KEY + "[=:]", self.text)
        return match["key"] if match else "key"

    @property
    def value(self) -> str:
        """The text after the sign of equality, without a comment."""
        _, _, after = self.text.partition("=")
        return re.sub(r"""^((?:"[^"]*"|'[^']*'|[^"'#])*)#.*$""", r"\1", after).strip()


def explained(text: str, error: ValueError, file: str | Path | None) -> ConfigError:
    """The error of a TOML parser in words that say where, what was written and what to write."""
    message = str(error)
    lines = text.split("\n")
    place = _PLACE.search(message)
    number, column = len(lines), None
    if place is not None and place[1] is not None:
        number, column = int(place[1]), int(place[2])
    said = _PLACE.sub("", message)
    # A line break is what a parser stumbles over where a line is not finished.
    line = _Line(number, lines[number - 1] if number <= len(lines) else "", file)
    if not line.text.strip() and number > 1:
        line = _Line(number - 1, lines[number - 2], file)
    why = (
        _of_repetition(line, said, text)
        or _of_characters(line)
        or _of_the_statement(line)
        or _of_the_value(line)
        or f"is not valid TOML: {said}"
    )
    shown = line.text.strip()
    shown = shown if len(shown) <= _LONGEST_SHOWN else f"{shown[:_LONGEST_SHOWN]}…"
    return ConfigError(f"{shown}: {why}", file=file, line=line.number, column=column)


def _of_repetition(line: _Line, said: str, text: str) -> str | None:
    """A table or a key that stands twice."""
    if match := re.match(r"Cannot declare \((.+)\) twice", said):
        name = ".".join(part.strip(" '\"") for part in match[1].rstrip(",").split(","))
        first = _lines(text, rf"\s*\[\[?\s*{re.escape(name)}\s*\]", line.number)[:1]
        before = f", first in line {first[0]}" if first else ""
        return (
            f"the table [{name}] stands twice{before}; put all its keys below one of the two"
            f" (several of a kind are written [[{name}]])"
        )
    if said.startswith("Cannot overwrite a value"):
        if header := re.match(r"\s*\[\[?([^\]]+)\]", line.text):
            return (
                f"[{header[1]}] stands twice, once as [{header[1]}] and once as [[{header[1]}]] or "
                f"as a value; write [[{header[1]}]] each time, or only once"
            )
        first = _lines(text, rf"\s*{re.escape(line.key)}\s*=", line.number)[-1:]
        before = f", first in line {first[0]}" if first else ""
        return f"the key '{line.key}' stands twice in its table{before}; keep one of them"
    return None


def _lines(text: str, pattern: str, before: int) -> list[int]:
    """The lines that a pattern begins, before a line."""
    lines = text.split("\n")[: before - 1]
    return [n for n, line in enumerate(lines, 1) if re.match(pattern, line)]


def _of_characters(line: _Line) -> str | None:
    """Characters that look like others: typographic quotation marks, blanks that are none."""
    bare = re.sub(r"\"[^\"]*\"|'[^']*'", "", line.text.split("#")[0])
    if found := next((character for character in bare if character in _CURLY), None):
        straight = re.sub(f"[{_CURLY}]+", '"', line.text.split("#")[0]).strip()
        return f"{found} is a typographic quotation mark; write straight ones: {straight}"
    if found := next((character for character in bare if character in _BLANKS), None):
        column = line.text.index(found) + 1
        return f"{_BLANKS[found]} stands in column {column}; write an ordinary blank there"
    if found := next((mark for mark in bare if ord(mark) < 32 and mark != "\t"), None):
        return f"the line holds the control character {found!r}; delete it"
    return None


def _of_the_statement(line: _Line) -> str | None:
    """A line that is neither a table's header nor a key with a value."""
    text = line.text.strip()
    if text.startswith("["):
        name = text.strip("[] ").split("#")[0].strip(" []")
        return f"the header of a table is not closed; write [{name}], or [[{name}]] for several"
    if text.startswith(("//", ";", "--", "/*", "%", "!")):
        return "a comment begins with #"
    if text.startswith(("{", "<")):
        return 'this is no TOML (is it JSON or XML?); write lines like length = "60 mm"'
    if match := re.fullmatch(_KEY + r":\s*(?P<value>.+)", line.text):
        return f"a value follows =, not a colon; write {match['key']} = {_quoted(match['value'])}"
    if match := re.fullmatch(_KEY + r"==\s*(?P<value>.+)", line.text):
        return f"one = stands between key and value; write {match['key']} = {match['value']}"
    if re.fullmatch(_KEY, line.text):
        return f'there is no value; write {line.key if "=" in text else text} = "…"'
    return None


def _quoted(value: str) -> str:
    bare = value.strip().rstrip(",;").strip()
    return bare if bare[:1] in "\"'[{" else f'"{bare}"'


def _of_the_value(line: _Line) -> str | None:
    """A value without quotation marks, or with too few of them, and numbers of another notation."""
    value, key = line.value, line.key
    if "=" not in line.text:
        return None
    if not value:
        return f'there is no value after =; write {key} = "…", or delete the line'
    if value[:1] == "{":
        return _of_a_table(value, key)
    if value[:1] in "\"'" and value.count(value[0]) % 2:
        return f"a quotation mark is missing at the end; write {key} = {value}{value[0]}"
    if "\\" in value:
        return (
            "a backslash has a meaning of its own between double quotation marks; write / in its "
            "place, or single quotation marks: " + f"{key} = '{value.strip(chr(34))}'"
        )
    if match := re.fullmatch(r"([\"'])([^\"']*)\1\s*([^\s,;#].*)", value):
        inside = f"{match[2].strip()} {match[3].strip(' ,;')}"
        return f'the unit belongs between the quotation marks; write {key} = "{inside}"'
    if match := re.fullmatch(r"(([\"']).*\2)\s*[;,]+", value):
        return f"nothing follows a value; write {key} = {match[1]}"
    return _of_a_bare_value(value, key)


def _of_a_bare_value(value: str, key: str) -> str:
    if value in ("True", "TRUE", "False", "FALSE", "yes", "no"):
        word = "true" if value.lower() in ("true", "yes") else "false"
        return f"a truth value is written in small letters; write {key} = {word}"
    if re.fullmatch(r"[+-]?0\d+", value):
        return f"a whole number has no leading zero; write {key} = {int(value)}"
    if re.fullmatch(r"[+-]?(\.\d+|\d+\.)", value):
        number = f"{float(value)!r}"
        return f"digits stand on both sides of the point; write {key} = {number}"
    if re.fullmatch(r"[+-]?\d+,\d+", value):
        return (
            f"decimals stand after a point; write {key} = {value.replace(',', '.')} for a number "
            f'without unit, {key} = "{value.replace(",", ".")} mm" for a quantity'
        )
    return f"a quantity or a word stands between quotation marks; write {key} = {_quoted(value)}"


def _of_a_table(value: str, key: str) -> str | None:
    """A table on one line: { value = "83 mm", source = "…" }."""
    if re.search(r"""(["'\d\]])\s+[A-Za-z_]+\s*=""", value):
        return "a comma is missing between two keys of a table on one line"
    if not value.endswith("}"):
        return f'a table on one line ends with }}; write {key} = {{ value = "…", source = "…" }}'
    for part in re.findall(r"[A-Za-z_]+\s*=\s*[^,}\"'\[{]+", value):
        name, _, inner = part.partition("=")
        if not re.fullmatch(
            r"[+-]?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?|true|false", inner.strip()
        ):
            return _of_a_bare_value(inner.strip(), name.strip())
    return None


_HEADER = re.compile(r"\s*(\[\[?)([^\]]+)\]")
_ASSIGNED = re.compile(
    r"\s*((?:[A-Za-z0-9_-]+|\"[^\"]*\"|'[^']*')(?:\s*\.\s*[A-Za-z0-9_\"'-]+)*)\s*="
)


def _split(dotted: str) -> list[str]:
    return [part.strip().strip("\"'") for part in dotted.split(".")]


def locate(text: str, path: Sequence[str | int]) -> int | None:
    """The 1-based line of the key at `path` (e.g. ``("actuator", "patches", 3, "x")``), or of its
    nearest ancestor that stands on a line of its own; None where none does."""
    wanted = [str(part) for part in path]
    table: list[str] = []
    counts: dict[str, int] = {}
    best, best_depth = None, 0
    for number, line in enumerate(text.splitlines(), 1):
        if header := _HEADER.match(line):
            table = _split(header.group(2))
            if header.group(1) == "[[":
                name = ".".join(table)
                counts[name] = counts.get(name, -1) + 1
                table = [*table, str(counts[name])]
            else:
                table = _with_indices(table, counts)
            here = table
        elif key := _ASSIGNED.match(line):
            here = [*table, *_split(key.group(1))]
        else:
            continue
        depth = len(here)
        if depth > best_depth and here == wanted[:depth]:
            best, best_depth = number, depth
    return best


def _with_indices(table: list[str], counts: dict[str, int]) -> list[str]:
    """[a.b.c] below the last [[a.b]] belongs to that element."""
    for cut in range(len(table), 0, -1):
        name = ".".join(table[:cut])
        if name in counts:
            return [*table[:cut], str(counts[name]), *table[cut:]]
    return table


# Parsers are quadratic in the parts of one key, recurse with each bracket, and make an object of
# every value. None of that is known before they have run, so it is counted here, without them.
DEEPEST = 100
"""Tables and lists within each other, and parts of a key: far past any description."""
MOST_LINES = 50_000
"""Lines of a TOML text, and its keys, tables and lists."""

# Every alternative ends, also where a quote is missing, so that no place is looked at twice.
_STRING_OR_COMMENT = re.compile(
    r'"""(?:[^"\\]++|\\.|"(?!""))*+(?:"{3,5}|\Z|\\\Z)'
    r"|'''(?:[^']++|'(?!''))*+(?:'{3,5}|\Z)"
    r'|"(?:[^"\\\n]++|\\[^\n])*+"?'
    r"|'[^'\n]*+'?"
    r"|#[^\n]*+",
    re.DOTALL,
)
_BETWEEN_KEYS = re.compile(r"[\[\]{}=,\n]")


def require_quick_toml(text: str, file: str | Path | None = None) -> None:
    """Refuse a TOML text that no parser reads in a moment, whatever it says.

    Raises:
        ConfigError: a text that is too long, has too many lines, keys or tables, is nested too
            deeply, or has a key of too many parts.
    """
    most = int(DESCRIPTION_BYTES.most)
    if len(text) > most:
        raise ConfigError(f"is larger than {most} bytes, no configuration", file=file)
    lines = text.count("\n")
    bare = _STRING_OR_COMMENT.sub("s", text)
    parts = bare.count("=") + bare.count("[") + bare.count("{")
    if max(lines, parts) > MOST_LINES:
        raise ConfigError(
            f"has {max(lines, parts)} lines, or keys, tables and lists; at most {MOST_LINES} are "
            "read: leave some out",
            file=file,
        )
    if (longest := 1 + max(key.count(".") for key in _BETWEEN_KEYS.split(bare))) > DEEPEST:
        raise ConfigError(
            f"is nested {longest} deep by one key; at most {DEEPEST} are read", file=file
        )
    depth = deepest = 0
    for bracket in re.findall(r"[\[\]{}]", bare):
        depth = depth + 1 if bracket in "[{" else max(depth - 1, 0)
        deepest = max(deepest, depth)
    if deepest > DEEPEST:
        raise ConfigError(f"is nested {deepest} deep; at most {DEEPEST} are read", file=file)
