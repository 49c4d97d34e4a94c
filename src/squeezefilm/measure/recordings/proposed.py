"""The description of a file as its instrument and its columns' names propose it."""

from __future__ import annotations

import json
from dataclasses import dataclass

from squeezefilm.measure.recordings.files.raw_table import RawTable


@dataclass(frozen=True)
class Proposal:
    """A description in TOML of a recording of this `kind`; `to_confirm` is what the file does not
    say itself, empty where it says all."""

    kind: str
    text: str
    to_confirm: str


def proposed(table: RawTable) -> Proposal | None:
    """The description that a table proposes; None where its columns' names say nothing.

    A frequency with a pair that makes an impedance is one; times with one signal are proposed as a
    ring-down, with more as raw signals of which the first is the drive.
    """
    held = list(table.described)
    quantities = [quantity for quantity, _, _ in held]
    if "frequency" in quantities:
        kind, to_confirm = "impedance", "" if table.sure else "that the columns hold this"
        if "gain" in quantities:
            to_confirm = "the resistor that the gain was taken over: write its value"
    elif quantities[:1] == ["time"] and len(held) > 1:
        drive, *moved = held[1:]
        kind, to_confirm = "ring-down", "that this is a ring-down, and which column holds it"
        held = [held[0], ("signal", *drive[1:])]
        if moved:
            kind = "raw signals"
            to_confirm = (
                "which column is the drive and which the motion, and what one unit of its signal "
                "stands for: write its scale"
            )
            held = [held[0], ("voltage", *drive[1:]), ("displacement", *moved[0][1:])]
    else:
        return None
    lines = [f"kind = {_quoted(kind)}", f"name = {_quoted(table.file.stem)}",
             f"instrument = {_quoted(table.format.split(',')[0])}"]  # fmt: skip
    lines += ['shunt = "… ohm"'] if "gain" in quantities else []
    lines.append("\n[columns]")
    for quantity, column, unit in held:
        scale = ', scale = "… nm/V"' if quantity == "displacement" else ""
        said = _quoted(column) if isinstance(column, str) else str(column)
        lines.append(f"{quantity} = {{ column = {said}, unit = {_quoted(unit)}{scale} }}")
    return Proposal(kind, "\n".join([*lines, ""]), to_confirm)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
