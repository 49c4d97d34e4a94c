"""A look at text before it is parsed: what would take a parser long is refused in linear time.

Parsers are quadratic in the parts of one key, recurse with each bracket, and make an object of
every value. None of that is known before they have run, so it is counted here, without them.
"""

from __future__ import annotations

import re
from pathlib import Path

from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import DESCRIPTION_BYTES

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
    _require_flat(bare, file)


def _require_flat(bare: str, file: str | Path | None = None) -> None:
    """Refuse a text with too many brackets open at once."""
    depth = deepest = 0
    for bracket in re.findall(r"[\[\]{}]", bare):
        depth = depth + 1 if bracket in "[{" else max(depth - 1, 0)
        deepest = max(deepest, depth)
    if deepest > DEEPEST:
        raise ConfigError(f"is nested {deepest} deep; at most {DEEPEST} are read", file=file)
