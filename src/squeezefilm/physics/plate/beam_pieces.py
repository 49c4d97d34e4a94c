"""A free–free Timoshenko beam that carries ceramic in places: its modes by high-order elements.

Each piece along the beam has the bending and shear stiffness and the inertia of what lies there;
the equations within a piece are those of `physics.plate.beam_modes`. A ceramic counts with its mass
from end to end. No stress passes through its end faces, so that it stiffens and drives from a part
of its thickness further in (`UNSTRESSED`).
"""

from __future__ import annotations

import collections
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.physics.plate.beam_modes import (
    BeamMode,
    require_nodal_lines,
    scaled_mode,
    timoshenko_frequency,
    wave_numbers,
)
from squeezefilm.physics.plate.elements.lobatto import (
    LineMesh,
    apart,
    lagrange_basis,
    line_matrices,
    lobatto_nodes,
)
from squeezefilm.physics.plate.laminate import CrossSection, Laminate, section_with
from squeezefilm.physics.plate.layout import CeramicPatch, Face, RectangularPlate

UNSTRESSED: si.Dimensionless = 0.6
"""Length without stress at each end of a ceramic, in its thicknesses: so that the frequencies of
solved plates are met best (tests/verification/test_beam_beside_solid.py)."""
_ORDER, _LONGEST = 4, 0.4
"""The order of elements, and their length at most in half wavelengths: 2e-5 of a frequency."""
_BAND = 2 * _ORDER + 1
_TURNS, _SETTLED = 12, 1e-8
_RIGID = 1e-6
"""Of the square of a mode's frequency: below, it is a rigid motion's rounding."""
_NEAR = 1e-5
"""Places that are as good as one, over the length of the plate."""
_Strip = tuple[Face, si.Metre, si.Metre, si.Metre]
"""A ceramic across the beam: its face, where it begins, its width and its thickness (m)."""


@dataclass(frozen=True)
class BeamPiece:
    """Piece of a beam from `begin` to `end`: its stiffnesses and its inertia, per unit width."""

    begin: si.Metre
    end: si.Metre
    bending_stiffness: si.NewtonMetre
    shear_stiffness: si.NewtonPerMetre
    mass_per_area: si.KilogramPerSquareMetre
    rotary_inertia: si.Kilogram


def stressed_span(plate: RectangularPlate, patch: CeramicPatch) -> tuple[si.Metre, si.Metre]:
    """Span along a plate (m) on which one of its ceramics stiffens and drives.

    Of a ceramic shorter than 2.4 thicknesses a quarter at each end does not; an end that meets
    another ceramic of the same face passes its stress on and counts whole.
    """
    inset = min(UNSTRESSED * patch.thickness, patch.length / 4)
    begin, end = patch.x, patch.x + patch.length
    beside = [
        other
        for other in plate.patches
        if other.face == patch.face
        and other.y < patch.y + patch.width
        and patch.y < other.y + other.width
    ]
    near = _NEAR * plate.length
    meets_before = any(abs(other.x + other.length - begin) < near for other in beside)
    meets_after = any(abs(other.x - end) < near for other in beside)
    return begin + inset * (not meets_before), end - inset * (not meets_after)


def beam_pieces(plate: RectangularPlate, cross_section: CrossSection) -> tuple[BeamPiece, ...]:
    """The pieces of a plate along its length, for nodal lines across it; what lies side by side
    across the plate bends together."""
    spans = [stressed_span(plate, patch) for patch in plate.patches]
    ends = [e for patch in plate.patches for e in (patch.x, patch.x + patch.length)]
    stops = apart([0.0, plate.length, *ends, *itertools.chain(*spans)], _NEAR * plate.length)
    sections = dict[tuple[_Strip, ...], si.FloatArray]()

    def section(which: Iterable[CeramicPatch]) -> si.FloatArray:
        strips = tuple((patch.face, patch.y, patch.width, patch.thickness) for patch in which)
        if strips not in sections:
            sections[strips] = _mean(plate, cross_section, strips)
        return sections[strips]

    pieces = list[BeamPiece]()
    for begin, end in itertools.pairwise(stops):
        middle = (begin + end) / 2
        lying = [
            (patch, low < middle < high)
            for patch, (low, high) in zip(plate.patches, spans, strict=True)
            if patch.x < middle < patch.x + patch.length
        ]
        g, s, _, j = section(patch for patch, is_stressed in lying if is_stressed)
        m = section(patch for patch, _ in lying)[2]
        pieces.append(BeamPiece(begin, end, float(g), float(s), float(m), float(j)))
    return tuple(pieces)


def _mean(
    plate: RectangularPlate, cross_section: CrossSection, strips: tuple[_Strip, ...]
) -> si.FloatArray:
    """Bending and shear stiffness, mass and rotary inertia per unit width of the plate with strips
    of ceramic, the mean over its width."""
    edges = [e for _, y, width, _ in strips for e in (y, y + width)]
    stops = apart([0.0, plate.width, *edges], _NEAR * plate.width)
    total = np.zeros(4)
    for low, high in itertools.pairwise(stops):
        middle = (low + high) / 2
        there = {face: thick for face, y, width, thick in strips if y < middle < y + width}
        part = section_with(plate, cross_section, there.get("top", 0.0), there.get("bottom", 0.0))
        total += (high - low) * np.array(
            [part.bending_stiffness, part.shear_stiffness, part.mass_per_area, part.rotary_inertia]
        )
    return total / (stops[-1] - stops[0])


def pieced_beam_mode(pieces: Sequence[BeamPiece], nodal_lines: int) -> BeamMode:
    """The bending mode of a free–free Timoshenko beam of pieces with a given number of nodal lines.

    Its frequency to 2e-5 relative, for half wavelengths of up to a few hundred thicknesses. Raises
    `InputError` for a number of lines that no beam has, `OutOfRangeError` above the cut-off
    frequency of any of the pieces.
    """
    require_nodal_lines(nodal_lines)
    cutoff = min(math.sqrt(piece.shear_stiffness / piece.rotary_inertia) for piece in pieces)
    length = pieces[-1].end
    half_wavelength = length / (nodal_lines - 0.5)
    beam = _Elements(pieces, _LONGEST * half_wavelength)
    x = np.linspace(0, length, max(2001, 40 * nodal_lines + 1))
    for omega, vector in beam.candidates(nodal_lines):
        if omega < cutoff:
            half, frequency = beam.half_wavelength(omega), omega / (2 * math.pi)
            mode = scaled_mode("timoshenko", frequency, half, x, *beam.at(x, vector), mass=1.0)
            if mode.nodal_lines == nodal_lines:
                return mode
    raise OutOfRangeError(
        f"a mode with {nodal_lines} nodal lines on {si.format_quantity(length, si.Unit('m'))} "
        "lies above the cut-off frequency of the Timoshenko beam; ask for fewer nodal lines"
    )


class _Elements:
    """The stiffness and the mass of a beam of pieces, of deflection and rotation by turns at each
    node, stored as bands."""

    def __init__(self, pieces: Sequence[BeamPiece], longest: si.Metre) -> None:
        self.pieces = pieces
        shares = [math.ceil((piece.end - piece.begin) / longest) for piece in pieces]
        edges = [
            piece.begin + (piece.end - piece.begin) * k / share
            for piece, share in zip(pieces, shares, strict=True)
            for k in range(share)
        ]
        self.mesh = LineMesh((*edges, pieces[-1].end), (_ORDER,) * len(edges))
        own = [piece for piece, share in zip(pieces, shares, strict=True) for _ in range(share)]
        g, m, s, j = np.array([_constants(piece) for piece in own]).T[:, :, None, None]
        h = np.diff(self.mesh.edges)[:, None, None]
        moving, sliding, bending = line_matrices(1.0, _ORDER)
        size = 2 * (_ORDER + 1)
        stiff, heavy = np.zeros((2, len(edges), size, size))
        stiff[:, ::2, ::2] = s * bending / h
        stiff[:, ::2, 1::2] = -s * sliding
        stiff[:, 1::2, ::2] = -s * sliding.T
        stiff[:, 1::2, 1::2] = s * moving * h + g * bending / h
        heavy[:, ::2, ::2] = m * moving * h
        heavy[:, 1::2, 1::2] = j * moving * h
        self.stiffness, self.mass = self._banded(stiff), self._banded(heavy)

    def _banded(self, each: si.FloatArray) -> sparse.dia_array:
        """The sum of the elements' matrices."""
        place = np.arange(each.shape[1])
        row, column = np.meshgrid(place, place, indexing="ij")
        first = 2 * _ORDER * np.arange(len(each))[:, None, None]
        bands = np.zeros((2 * _BAND + 1, 2 * (_ORDER * len(each) + 1)))
        shape = each.shape
        np.add.at(
            bands,
            (np.broadcast_to(_BAND + row - column, shape), np.broadcast_to(first + column, shape)),
            each,
        )
        size = bands.shape[1]
        return sparse.dia_array((bands, np.arange(_BAND, -_BAND - 1, -1)), shape=(size, size))

    def candidates(self, nodal_lines: int) -> Iterator[tuple[float, si.FloatArray]]:
        """The mode whose shape is nearest to a wave, and then, in case it is another, those around
        that wave's frequency; each of unit modal mass."""
        wave = (nodal_lines - 0.5) * math.pi / self.pieces[-1].end
        guess = 2 * math.pi * float(timoshenko_frequency(math.pi / wave, _even(self.pieces)))
        nearest = self._nearest(wave, guess, nodal_lines % 2 == 0)
        if nearest is not None:
            yield nearest
        yield from self._around(guess, nodal_lines)

    def _nearest(self, wave: float, guess: float, even: bool) -> tuple[float, si.FloatArray] | None:
        """Refine a mode by Rayleigh quotients of ever better shapes, each squared nearer."""
        from scipy.linalg import LinAlgError, solve_banded

        phase = wave * (self.mesh.nodes - self.pieces[-1].end / 2)
        vector = np.zeros(2 * self.mesh.nodes.size)
        vector[::2] = np.cos(phase) if even else np.sin(phase)
        shift = guess**2
        for _ in range(_TURNS):
            try:
                bands = self.stiffness.data - shift * self.mass.data
                vector = solve_banded((_BAND, _BAND), bands, self.mass @ vector)
            except LinAlgError:
                return None  # on the mode to the last digit, of a shape that is not known yet
            vector /= math.sqrt(vector @ (self.mass @ vector))
            before, shift = shift, float(vector @ (self.stiffness @ vector))
            if abs(shift - before) <= _SETTLED * abs(shift):
                return math.sqrt(abs(shift)), vector
        return None

    def _around(self, guess: float, count: int) -> Iterator[tuple[float, si.FloatArray]]:
        """Modes around a frequency, so many and four more."""
        from scipy.sparse.linalg import eigsh

        stiffness, mass = self.stiffness.tocsc(), self.mass.tocsc()
        values, vectors = eigsh(stiffness, k=count + 4, M=mass, sigma=guess**2)
        for value, vector in zip(values, vectors.T, strict=True):
            if value > _RIGID * guess**2:
                yield math.sqrt(float(value)), vector

    def at(self, x: si.MetreArray, vector: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
        """Deflection and rotation at places."""
        lies, local = self.mesh.located(x)
        values, _ = lagrange_basis(lobatto_nodes(_ORDER), local)
        nodes = _ORDER * lies[:, None] + np.arange(_ORDER + 1)
        both = np.einsum("xn,xnk->kx", values, vector.reshape(-1, 2)[nodes])
        return both[0], both[1]

    def half_wavelength(self, omega: float) -> si.Metre:
        """π over the mean wave number of the pieces, of the part that oscillates."""
        lengths = collections.defaultdict[tuple[float, ...], float](float)
        for piece in self.pieces:
            lengths[_constants(piece)] += piece.end - piece.begin
        waves = [extent * wave_numbers(omega, *of)[1] for of, extent in lengths.items()]
        return math.pi * self.pieces[-1].end / math.fsum(waves)


def _even(pieces: Sequence[BeamPiece]) -> Laminate:
    """A uniform section that yields as the pieces do one after the other, and weighs the same."""
    parts = np.array([(piece.end - piece.begin, *_constants(piece)) for piece in pieces])
    share = parts[:, 0] / np.sum(parts[:, 0])
    g, m, s, j = parts[:, 1:].T
    return Laminate(
        neutral_axis=0.0,
        bending_stiffness=float(1 / (share @ (1 / g))),
        mass_per_area=float(share @ m),
        rotary_inertia=float(share @ j),
        shear_stiffness=float(1 / (share @ (1 / s))),
        layers=(),
    )


def _constants(piece: BeamPiece) -> tuple[float, float, float, float]:
    return piece.bending_stiffness, piece.mass_per_area, piece.shear_stiffness, piece.rotary_inertia
