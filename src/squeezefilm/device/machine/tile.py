"""A texture tile: amplitudes (µV) over position (µm), read linearly, zero outside."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class Tile:
    """A table of amplitudes, filled in order; it plays once it is full. Not thread-safe."""

    origin: int = 0
    pitch: int = 1
    size: int = 0
    levels: list[int] = field(default_factory=list)

    @property
    def ready(self) -> bool:
        """Whether every amplitude has arrived."""
        return self.size > 0 and len(self.levels) == self.size

    def fits(self, first: int, count: int) -> bool:
        """Whether `count` amplitudes from number `first` are the next ones and find room."""
        return first == len(self.levels) and first + count <= self.size

    def level(self, x: int) -> int:
        """The amplitude (µV) at `x` µm; towards the table's own value where division rounds."""
        along = x - self.origin
        if not self.ready or along < 0:
            return 0
        index, rest = divmod(along, self.pitch)
        if index >= self.size - 1:
            return self.levels[-1] if index == self.size - 1 and rest == 0 else 0
        here, there = self.levels[index], self.levels[index + 1]
        if there >= here:
            return here + (there - here) * rest // self.pitch
        return here - (here - there) * rest // self.pitch
