"""What the compiled load balance is given, in records."""

from __future__ import annotations

from typing import NamedTuple

from squeezefilm import quantities as si


class CompiledAsperities(NamedTuple):
    """A law of asperities: the number of its kind, its constants, its table."""

    kind: int
    constants: si.FloatArray
    table: si.FloatArray


class CompiledFilms(NamedTuple):
    """A table of films: scales, edges of the rows, which panels are solved, their coefficients."""

    scale: si.FloatArray
    edges: si.FloatArray
    built: si.IntArray
    panels: si.FloatArray
