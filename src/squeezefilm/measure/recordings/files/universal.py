"""Universal Files (UFF, UNV): functions (type 58), data at nodes (55), the nodes' places (15,
2411) and the units of all (164)."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, optional
from squeezefilm.core.hard_limits import RECORDING_BYTES
from squeezefilm.core.isolated_reading import Read, read_isolated
from squeezefilm.core.regular_file import read_regular
from squeezefilm.measure.recordings.files.raw_table import RawTable

SUFFIXES = (".uff", ".unv", ".uf")
_NODES = (15, 2411)
_READ = (*_NODES, 55, 58, 164)
# By how many of the file's lengths are a metre, as its data set of units says.
_LENGTHS = {1: "m", 1e2: "cm", 1e3: "mm", 1e6: "um"}
_DIRECTIONS = ("r1", "r2", "r3")
# By the specific data type of an ordinate, and the axis of a direction.
_MOTIONS = {8: "displacement", 11: "velocity", 12: "acceleration"}
_AXES = {1: "x", 2: "y", 3: "z", 4: "rotation x", 5: "rotation y", 6: "rotation z"}
_OVER_ANOTHER = 4  # the type of a function that is a frequency response

_Column = tuple[str, si.FloatArray]  # with its name


@dataclass(frozen=True)
class _Block:
    """A data set: its type, the line of the file in which it begins, and the file's unit of
    lengths ("" where it has none)."""

    type: int
    line: int
    content: Mapping[str, Any]
    length: str = ""


def read_universal(path: Path, at: si.Hertz | None = None) -> RawTable:
    """The table in a Universal File.

    Functions (type 58) over one abscissa become the column ``x`` and, of each, ``58.1 real`` and
    ``58.1 imaginary`` (``58.1`` where it is real); with the places of their nodes (15) and a
    frequency `at` (Hz), or as data at nodes (55), the columns are ``x``, ``y``, ``z`` and the
    values at each node, those recorded nearest to it: ``58 real``, or ``r3 real`` for the third
    direction. The name ends with the function's own unit in brackets, where its head says that;
    `moved` of the table has its own quantity, for descriptions to be checked against.

    Raises `ConfigError`, with the line at which its data set begins, for one that is not closed,
    has fewer values than it says or cannot be read, and for functions over different abscissas.
    """
    # Looked at here, since a pipe must not be waited for there.
    read_regular(path, RECORDING_BYTES, "a Universal File")
    (format, names, moved, notes), (values,) = read_isolated(_table, str(path), at, file=path)
    return RawTable(path, format, tuple(names), values, notes=tuple(notes), moved=tuple(moved))


def _table(_: bytes, file: str, at: si.Hertz | None) -> Read:
    """Format, names of the columns, the motions they hold by the file's own words, and notes; and
    the columns' values (read in the child)."""
    blocks = _blocks(Path(file))
    nodes: dict[int, list[float]] = {}
    a_metre = [float(block.content["length"]) for block in blocks if block.type == 164]
    length = _LENGTHS.get(round(a_metre[-1], 6), "") if a_metre else ""
    blocks = [replace(block, length=length) for block in blocks]
    for c in (block.content for block in blocks if block.type in _NODES):
        nodes |= {
            int(n): place for n, *place in zip(c["node_nums"], c["x"], c["y"], c["z"], strict=True)
        }
    functions, fields = ([block for block in blocks if block.type == of] for of in (58, 55))
    if fields and nodes:
        pairs = _data_at_nodes(fields[0], nodes)
        own = dict.fromkeys(_DIRECTIONS, _motion(fields[0], "spec_data_type"))
    elif functions and nodes and at is not None:
        pairs = _functions_at_nodes(functions, nodes, at)
        own = {"58": _motion(functions[0])}
    elif functions:
        pairs = _functions(functions)
        own = {f"58.{k}": _motion(block) for k, block in enumerate(functions, 1)}
    else:
        kinds = ", ".join(sorted({str(block.type) for block in blocks})) or "none"
        raise ConfigError(
            f"holds no functions (type 58) and no data at nodes (55 with 15); its data sets are of "
            f"the types {kinds}"
        )
    names = [name for name, _ in pairs]
    moved = [own.get(name.split(" ")[0], "") for name in names]
    notes = [_said(block, nodes) for block in functions[:3]]
    if length and nodes and names[:3] == ["x", "y", "z"]:
        names = [*(f"{name} ({length})" for name in "xyz"), *names[3:]]
    notes += [f"its units (type 164): {count:g} lengths a metre" for count in a_metre[-1:]]
    said = f"Universal File of {len(blocks)} data sets", names, moved, notes
    return said, [np.stack([column for _, column in pairs], axis=1)]


def _blocks(path: Path) -> list[_Block]:
    """The data sets that are read, each looked at before and after."""
    with optional("measure", "a Universal File"):
        import pyuff

    data = read_regular(path, RECORDING_BYTES, "a Universal File")
    # As the reader finds them; behind binary values a mark does not begin its line.
    places = [match.start() for match in re.finditer(rb"    -1(?=[\r\n]| {60}|\Z)", data)]
    marks = [data.count(b"\n", 0, place) + 1 for place in places]
    if len(marks) < 2:
        raise ConfigError(
            "is no Universal File: its data sets stand between lines with -1 in columns 5 and 6"
        )
    if len(marks) % 2:
        raise ConfigError(
            "the data set that begins here is not closed: the file is cut short; export it again",
            line=marks[-1],
        )
    blocks = []
    reader = pyuff.UFF(str(path))
    for number, (line, place) in enumerate(zip(marks[::2], places[::2], strict=True)):
        kind = data[place : place + 200].decode("latin-1").partition("\n")[2][:6].strip()
        if not kind.isdigit():
            raise ConfigError(f"'{kind}' is no type of a data set", line=line + 1)
        if int(kind) not in _READ:
            continue
        try:
            content = reader.read_sets(number)
        except MemoryError:
            raise
        # The reader raises bare exceptions of any type for whatever is malformed.
        except Exception as error:
            why = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise ConfigError(
                f"the data set of type {kind} that begins here cannot be read: {why}", line=line
            ) from error
        blocks.append(_Block(int(kind), line, content))
        _require_whole(blocks[-1])
    return blocks


def _require_whole(block: _Block) -> None:
    """Refuse a function of another count of values than its head says, and nodes with parts
    missing."""
    c = block.content
    if block.type == 58:
        count, said = np.size(c["data"]), int(c["num_pts"])
        if not count == np.size(c["x"]) == said:
            raise ConfigError(
                f"the function that begins here has {count} values, and its head says {said}: the "
                "file is cut short or was changed",
                line=block.line,
            )
    elif block.type == 164:
        if not c.get("length", 0) > 0:
            raise ConfigError("the units that begin here have parts missing")
    elif block.type in _NODES:
        if len({len(c[key]) for key in ("node_nums", "x", "y", "z")}) > 1:
            raise ConfigError("the nodes that begin here have parts missing", line=block.line)
    elif np.size(c.get("r3", [])) != np.size(c["node_nums"]):
        raise ConfigError(
            "the data at nodes that begin here have no value for every node", line=block.line
        )


def _words(block: _Block, key: str) -> str:
    """What a data set says under a key; empty where it says nothing."""
    word = str(block.content.get(key) or "").strip()
    return "" if word.upper() == "NONE" else word


def _unit(block: _Block) -> str:
    """The unit of a function, of a frequency response over that of its drive; empty where neither
    its head nor the file's unit of lengths says all of it."""
    above, below = (_words(block, f"{part}_axis_units_lab") for part in ("ordinate", "orddenom"))
    if block.length and not above:
        # A drive whose unit is not told is a voltage: the units of a file hold no volts.
        moved = _motion(block)
        above = {"displacement": block.length, "velocity": f"{block.length}/s"}.get(moved, "")
        below = below or "V"
    if int(block.content.get("func_type") or 0) != _OVER_ANOTHER:
        return above
    return f"{above}/{below}" if above and below else ""


def _motion(block: _Block, key: str = "ordinate_spec_data_type") -> str:
    return _MOTIONS.get(int(block.content.get(key) or 0), "")


def _said(block: _Block, nodes: Mapping[int, Sequence[float]]) -> str:
    """Words of a function on itself: its name, quantity, unit and point."""
    names = [_words(block, key) for key in ("id1", "ordinate_axis_lab")]
    names.append(_motion(block))
    told = ", ".join(dict.fromkeys(name for name in names if name))
    unit = _unit(block)
    node, axis = (int(block.content.get(key) or 0) for key in ("rsp_node", "rsp_dir"))
    at = f", at node {node}" + (f" along {_AXES[abs(axis)]}" if abs(axis) in _AXES else "")
    if node in nodes:
        at += " ({:.6g}, {:.6g}, {:.6g} in ".format(*nodes[node])
        at += (block.length or "the file's unit") + ")"
    return (
        f"the function in line {block.line} says: {told or 'nothing'}, "
        + (f"unit {unit}" if unit else "no unit")
        + at
    )


def _parts(name: str, values: Any, unit: str = "") -> list[_Column]:
    """Columns of values that may be complex."""
    array = np.asarray(values)
    end = f" ({unit})" if unit else ""
    if not np.iscomplexobj(array):
        return [(f"{name}{end}", array.astype(float))]
    return [
        (f"{name} real{end}", array.real.astype(float)),
        (f"{name} imaginary{end}", array.imag.astype(float)),
    ]


def _functions(functions: Sequence[_Block]) -> list[_Column]:
    x = np.asarray(functions[0].content["x"], dtype=float)
    pairs = [("x", x)]
    for number, block in enumerate(functions, 1):
        other = np.asarray(block.content["x"], dtype=float)
        if other.shape != x.shape or not np.allclose(other, x, rtol=1e-9, atol=0):
            raise ConfigError(
                "the function that begins here stands over another abscissa than the first; save "
                "functions of one abscissa in a file",
                line=block.line,
            )
        pairs += _parts(f"58.{number}", block.content["data"], _unit(block))
    return pairs


def _data_at_nodes(block: _Block, nodes: Mapping[int, Sequence[float]]) -> list[_Column]:
    places = _places([int(node) for node in block.content["node_nums"]], nodes, block)
    pairs = list(zip("xyz", places.T, strict=True))
    for direction in _DIRECTIONS:
        pairs += _parts(direction, block.content[direction])
    return pairs


def _functions_at_nodes(
    functions: Sequence[_Block], nodes: Mapping[int, Sequence[float]], at: si.Hertz
) -> list[_Column]:
    places, values = [], []
    for block in functions:
        x, data = np.asarray(block.content["x"]), np.asarray(block.content["data"])
        nearest = int(np.argmin(np.abs(x - at)))
        if not x[0] <= at <= x[-1]:
            shown = ", ".join(
                si.format_quantity(value, si.Unit("Hz")) for value in (at, x[0], x[-1])
            )
            raise ConfigError(
                f"the function that begins here does not reach the frequency told (asked, first, "
                f"last: {shown})",
                line=block.line,
            )
        places.append(_places([int(block.content["rsp_node"])], nodes, block)[0])
        values.append(data[nearest])
    kinds = {(_unit(block), _motion(block)) for block in functions}
    if len(kinds) > 1:
        raise ConfigError(
            "its functions are of several quantities or units, and a scan is of one; save those of "
            "one quantity in a file"
        )
    columns = _parts("58", np.array(values), _unit(functions[0]))
    return [*zip("xyz", np.array(places).T, strict=True), *columns]


def _places(
    numbers: Sequence[int], nodes: Mapping[int, Sequence[float]], block: _Block
) -> si.FloatArray:
    lacking = [number for number in numbers if number not in nodes]
    if lacking:
        raise ConfigError(
            f"the data that begin here are of node {lacking[0]}, whose place no data set of type "
            "15 gives",
            line=block.line,
        )
    return np.array([nodes[number] for number in numbers], dtype=float)
