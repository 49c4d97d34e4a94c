"""What the compiled load balance is given, in records."""

from __future__ import annotations

from typing import NamedTuple

from squeezefilm.quantities import FloatArray, IntArray


class CompiledAsperities(NamedTuple):
    """A law of asperities: the number of its kind, its constants, its table."""

    kind: int
    constants: FloatArray
    table: FloatArray


class CompiledFilms(NamedTuple):
    """A table of films: scales, edges of the rows, which panels are solved, their coefficients."""

    scale: FloatArray
    edges: FloatArray
    built: IntArray
    panels: FloatArray
