"""Store of a search in a folder: every evaluated design, kept as it comes, by all that it depends
on. A search that was stopped asks none of them again, and several hosts may write into one file."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, get_args

from squeezefilm.core.kept.computed_by import computed_by
from squeezefilm.core.results import config_hash, to_json
from squeezefilm.design.search.candidate import Design, Evaluated, Level
from squeezefilm.design.search.criteria import breaches
from squeezefilm.design.search.limits import DRAWS, Made
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.design.sweep.points import Lines

FILE = "designs.jsonl"
"""Name of the file in the folder of a search: a line for every evaluated design."""


def asked_hash(requirements: Requirements, level: Level) -> str:
    """A hash of all that a design's numbers depend on beside the design: code, display,
    materials and shapes, and what is computed of solved plates only where a limit asks for it. That
    the limits are kept is judged anew."""
    limits = requirements.limits
    asked = [
        computed_by(),
        config_hash(requirements.base),
        requirements.shapes,
        requirements.workspace,
        requirements.assembly_quality,
        limits.press,
    ]
    if level == "solved":
        asked += [
            limits.most_relative_friction,
            limits.confidence,
            limits.least_area is None,
            limits.most_sound_level is None,
        ]
    return config_hash(asked)[:16]


def _made_hash(requirements: Requirements) -> str:
    """A hash of all that plates as made depend on beside the design and its solved numbers."""
    also = [requirements.limits, requirements.tolerances, requirements.objectives, DRAWS]
    return config_hash([asked_hash(requirements, "solved"), also])[:16]


class DesignStore:
    """Evaluated designs by design and level; without a folder in memory only. `member` tells hosts
    apart that search in one folder.

    Raises `InputError` where the folder's file cannot be read or written.
    """

    def __init__(self, requirements: Requirements, folder: Path | None, member: int = 0) -> None:
        self._requirements, self._member = requirements, member
        self._hashes = {level: asked_hash(requirements, level) for level in get_args(Level)}
        self._lines = Lines(folder and folder / FILE)
        self._known: dict[tuple[Design, Level], Evaluated] = {}
        self._made: dict[Design, Made] = {}
        self._made_hash = _made_hash(requirements)
        self.computed = 0
        self._members: dict[tuple[Design, Level], int] = {}
        self._lines.read(self._take)

    def _take(self, read: Any) -> None:
        if "kept" in read:
            self._take_made(read)
        elif (known := self._evaluated(read)) is not None:
            self._known[known.design, known.level] = known
            self._members[known.design, known.level] = int(read["member"])

    def of_others(self, shape: int, level: Level) -> list[Evaluated]:
        """Results of other hosts that search in the same folder, of a shape at a level."""
        self._lines.read(self._take)
        return [
            self._known[design, at]
            for (design, at), member in self._members.items()
            if design.shape == shape and at == level and member != self._member
        ]

    def __len__(self) -> int:
        return len(self._known)

    def get(self, design: Design, level: Level) -> Evaluated | None:
        """Result of a design at a level; None where nothing is."""
        return self._known.get((design, level))

    def add(self, candidates: Iterable[Evaluated]) -> None:
        """Keep evaluated designs, together on the disk. What might be another one another time is
        kept in memory only."""
        lines = list[dict[str, Any]]()
        for candidate in candidates:
            self._known[candidate.design, candidate.level] = candidate
            self.computed += 1
            if not candidate.lasting:
                continue
            # JSON has no infinity; `float` reads it from text.
            numbers = {
                key: value if math.isfinite(value) else str(value)
                for key, value in candidate.numbers.items()
            }
            line = {
                "asked": self._hashes[candidate.level],
                "shape": candidate.design.shape,
                "values": candidate.design.settings,
                "level": candidate.level,
                "member": self._member,
                "numbers": numbers,
                "reason": candidate.reason,
                "seconds": round(candidate.seconds, 4),
                "warnings": list(candidate.warnings),
            }
            lines.append(line)
        self._lines.append(lines)

    def made(self, design: Design) -> Made | None:
        """Result of making a design's drawing; None where it was not drawn."""
        return self._made.get(design)

    def add_made(self, design: Design, made: Made) -> None:
        """Keep what is made of a design's drawing."""
        self._made[design] = made
        head = {"asked": self._made_hash, "shape": design.shape, "values": design.settings}
        self._lines.append([head | to_json(made)])

    def _take_made(self, read: Mapping[str, Any]) -> None:
        if read["asked"] != self._made_hash:
            return
        design = Design(int(read["shape"]), tuple(read["values"].items()))
        intervals = {key: (low, high) for key, (low, high) in read["intervals"].items()}
        self._made[design] = Made(
            read["draws"], read["kept"], read["broken"], intervals, read["effects"], read["failed"]
        )

    def _evaluated(self, read: Mapping[str, Any]) -> Evaluated | None:
        if read["asked"] != self._hashes[read["level"]]:
            return None
        names = {
            variable.name for variable in self._requirements.spaces[int(read["shape"])].variables
        }
        if set(read["values"]) != names:
            return None
        numbers = {str(key): float(value) for key, value in read["numbers"].items()}
        return Evaluated(
            Design(int(read["shape"]), tuple(read["values"].items())),
            read["level"],
            numbers,
            () if read["reason"] else breaches(numbers, self._requirements.limits),
            read["reason"],
            float(read["seconds"]),
            tuple(read["warnings"]),
        )
