"""A box model as a row of slices along x: its unknowns, operators and electrodes; and its size,
counted before any matrix of it is made.

Unknowns are ordered slice by slice (x node by x node). Operators are applied through the slice
matrices, never assembled.
"""

from __future__ import annotations

import dataclasses
import functools
from typing import Any

import numpy as np
from scipy import sparse

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import SOLID_MEMORY, require_within
from squeezefilm.physics.plate.elements.box_model import BoxModel, held_components, kept_products
from squeezefilm.physics.plate.elements.cross_section import (
    CrossSection,
    Springs,
    Weight,
    code_parts,
    cross_section,
    potential_base,
    slice_codes,
)
from squeezefilm.physics.plate.elements.lobatto import LineMesh, line_matrices

# Vectors that operators are applied to at once: of more, what lies between outgrows the caches.
_TOGETHER = 32
_FLOAT = 8.0
# Matrices of a slice's size that an element of its own kind takes (a number, and one for each
# order), and vectors over all unknowns that the modes' search keeps. Fitted to peaks of resident
# memory on four plates of metal and glass, 0.07 to 1.7 GB: within 10 % of all.
_OF_A_KIND, _OF_AN_ORDER, _VECTORS = 3.0, 2.0, 120.0
# A slice has this share at least of the squares of a full box's: the rest is air beside ceramics.
# Meshes of gigahertz are refused by it; to count their unknowns would take hours.
_FEWEST = 0.05


class Slabs:
    """The discretised model: `codes` of the unknowns of each slice (x node), of `element_codes` of
    the slices that each x element is made of, and the slice matrices."""

    def __init__(self, model: BoxModel) -> None:
        self.model = model
        self._number()

    @functools.cached_property
    def element_codes(self) -> list[si.IntArray]:
        """The codes of the unknowns of every element's slices."""
        model = self.model
        known: dict[bytes, si.IntArray] = {}
        codes: list[si.IntArray] = []
        for e in range(model.x.elements):
            pattern = model.medium[e].tobytes() + model.ceramic[e].tobytes()
            if pattern not in known:
                known[pattern] = slice_codes(model, e)
            codes.append(known[pattern])
        return codes

    @property
    def products(self) -> float:
        """The cubes of the elements' slices, to which the time of a factorisation goes."""
        return float(sum(codes.size**3 for codes in self.element_codes))

    @property
    def squares(self) -> float:
        """The squares of the elements' slices: entries of the factors."""
        return float(sum(codes.size**2 for codes in self.element_codes))

    @property
    def memory(self) -> float:
        """The bytes that the factors, what is made on the way to them and the modes take: within a
        tenth of the resident memory measured on four plates."""
        x = self.model.x
        kinds: dict[tuple[bytes, int, int], float] = {}
        for e, order in enumerate(x.orders):
            length = round((x.edges[e + 1] - x.edges[e]) * 1e12)
            matrices = _OF_A_KIND + _OF_AN_ORDER * order
            square = matrices * self.element_codes[e].size ** 2
            kinds.setdefault((self.model.medium[e].tobytes(), length, order), square)
        return _FLOAT * (2 * self.squares + sum(kinds.values()) + _VECTORS * self.unknowns)

    def require_memory(self) -> None:
        """Refuse a model whose factors would not fit into memory, before any matrix is made.

        Raises `InputError`.
        """
        _require_memory(len(self.sizes), max(self.sizes), self.memory)

    @functools.cached_property
    def sections(self) -> list[CrossSection]:
        """The matrices of every slice: those that differ only in the numbers of their ceramics
        share them."""
        shapes: dict[bytes, CrossSection] = {}
        made: list[CrossSection] = []
        for e in range(self.model.x.elements):
            shape = _shape(self.model, e)
            if shape not in shapes:
                shapes[shape] = cross_section(self.model, e)
            made.append(_renumbered(self.model, shapes[shape], e))
        return made

    def __getstate__(self) -> dict[str, Any]:
        # Megabytes that are made anew in milliseconds, where anybody multiplies by them.
        made_anew = ("sections", "_alike")
        return {name: value for name, value in vars(self).items() if name not in made_anew}

    def _number(self) -> None:
        x = self.model.x
        count = x.nodes.size
        parts: list[list[si.IntArray]] = [[] for _ in range(count)]
        for e, codes in enumerate(self.element_codes):
            for a in range(x.orders[e] + 1):
                parts[x.first_node[e] + a].append(codes)
        self.codes: list[si.IntArray] = []
        for some in parts:
            self.codes.append(functools.reduce(np.union1d, some) if len(some) > 1 else some[0])
        self.sizes = [codes.size for codes in self.codes]
        self.offsets = [int(k) for k in np.concatenate([[0], np.cumsum(self.sizes)])]
        self.unknowns = self.offsets[-1]
        # Unknowns that the conditions on x− and x+ hold at zero stay in the count, so that cells
        # at the ends of the plate are like any other.
        self.held = np.zeros(self.unknowns, dtype=bool)
        for n, condition in ((0, self.model.ends[0]), (count - 1, self.model.ends[1])):
            component = self.parts[n][0]
            at = slice(self.offsets[n], self.offsets[n + 1])
            self.held[at] |= np.isin(component, held_components(condition, 0))

    def places(self, element: int, local: int) -> si.IntArray:
        """Indices of the unknowns of an element's section in the slice of its node `local`."""
        codes = self.codes[self.model.x.first_node[element] + local]
        mine = self.element_codes[element]
        return np.arange(mine.size) if codes.size == mine.size else np.searchsorted(codes, mine)

    @functools.cached_property
    def components(self) -> si.IntArray:
        """The component (0–2 displacement, 3 potential) of every unknown."""
        return np.concatenate([part for part, _, _ in self.parts])

    @functools.cached_property
    def parts(self) -> list[tuple[si.IntArray, si.IntArray, si.IntArray]]:
        """Component, y function and z function of every slice's unknowns."""
        known: dict[int, tuple[si.IntArray, si.IntArray, si.IntArray]] = {}
        return [known.setdefault(id(codes), code_parts(self.model, codes)) for codes in self.codes]

    @functools.cached_property
    def _element_places(self) -> list[list[si.IntArray]]:
        x = self.model.x
        return [
            [self.offsets[x.first_node[e] + a] + self.places(e, a) for a in range(x.orders[e] + 1)]
            for e in range(x.elements)
        ]

    @functools.cached_property
    def electrode_columns(self) -> tuple[si.FloatArray, si.FloatArray]:
        """G (unknowns × electrodes) and C (electrodes²): the force of one volt on the unknowns is
        −G, and the charge on the electrodes is −(Gᵀ x + C V)."""
        number = len(self.model.electrodes)
        G, C = np.zeros((self.unknowns, number)), np.zeros((number, number))
        for e, section in enumerate(self.sections):
            if not section.electrodes:
                continue
            M, D, _ = self._lines(e)
            columns = np.array(section.electrodes, dtype=np.int64)
            for a in range(M.shape[0]):
                start = self.offsets[self.model.x.first_node[e] + a]
                part = M[a].sum() * section.g0 + D[a].sum() * section.g1
                G[np.ix_(start + self.places(e, a), columns)] += part
            C[np.ix_(columns, columns)] += M.sum() * section.c0
        G[self.held] = 0
        return G, C

    def _lines(self, element: int) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
        x = self.model.x
        return line_matrices(x.edges[element + 1] - x.edges[element], x.orders[element])

    def mass_times(self, U: si.FloatArray) -> si.FloatArray:
        """M U for U of shape (unknowns, vectors); potentials have no mass."""
        return self._apply(U, self.sections, mass=True)

    def stiffness_times(
        self, U: si.FloatArray, sections: list[CrossSection] | None = None
    ) -> si.FloatArray:
        """K U, or with other slice matrices (see `weighted_sections`)."""
        return self._apply(U, sections or self.sections, mass=False)

    def weighted_sections(self, weight: Weight, springs: Springs) -> list[CrossSection]:
        """Slice matrices with scaled constants, for energy shares and losses; their codes are those
        of one slice of each kind."""
        made: dict[int, CrossSection] = {}
        out = []
        for e, section in enumerate(self.sections):
            if id(section.P2) not in made:
                made[id(section.P2)] = cross_section(self.model, e, weight, springs=springs)
            out.append(made[id(section.P2)])
        return out

    def _apply(self, U: si.FloatArray, sections: list[CrossSection], mass: bool) -> si.FloatArray:
        if U.shape[1] > _TOGETHER:
            some = [U[:, k : k + _TOGETHER] for k in range(0, U.shape[1], _TOGETHER)]
            return np.concatenate([self._apply(part, sections, mass) for part in some], axis=1)
        U = np.where(self.held[:, None], 0, U)
        out = np.zeros_like(U)
        for elements, places, lines in self._alike:
            # All elements that share a slice and an order at once.
            part = self._group_times(lines, sections[elements[0]], U[places], mass)
            for number in range(len(elements)):
                for a in range(places.shape[1]):
                    out[places[number, a]] += part[:, number, a]
        out[self.held] = 0
        return out

    @functools.cached_property
    def _alike(self) -> list[tuple[list[int], si.IntArray, tuple[si.FloatArray, ...]]]:
        """Elements that share a slice and an order: which, the places of their unknowns (elements,
        nodes, unknowns of the slice), and their integrals along x."""
        groups: dict[tuple[int, int], list[int]] = {}
        for e, section in enumerate(self.sections):
            groups.setdefault((id(section.P2), self.model.x.orders[e]), []).append(e)
        joined: list[tuple[list[int], si.IntArray, tuple[si.FloatArray, ...]]] = []
        for elements in groups.values():
            places = np.stack([np.stack(self._element_places[e]) for e in elements])
            M, D, S = (np.stack(some) for some in zip(*map(self._lines, elements), strict=True))
            joined.append((elements, places, (M, D, S)))
        return joined

    def _group_times(
        self,
        lines: tuple[si.FloatArray, ...],
        section: CrossSection,
        local: si.FloatArray,
        mass: bool,
    ) -> si.FloatArray:
        """The mass or stiffness of elements of one slice and order times their own unknowns, which
        come as (elements, nodes, unknowns of the slice, vectors) and go with the third first."""
        M, D, S = lines
        count, nodes, n, vectors = local.shape
        flat = local.reshape(count, nodes, n * vectors)

        def term(line: si.FloatArray, matrix: sparse.csr_array | sparse.csc_array) -> si.FloatArray:
            along = (line @ flat).reshape(count * nodes, n, vectors).transpose(1, 0, 2)
            return np.asarray(matrix @ along.reshape(n, -1))

        if mass:
            out = term(M, section.inertia)
        else:
            P2, P1, P0 = section.stiffnesses
            out = term(S, P2)
            out += term(D, P1)
            out += term(D.transpose(0, 2, 1), P1.T)
            out += term(M, P0)
        return out.reshape(n, count, nodes, vectors)

    def grid(self, vector: si.FloatArray) -> si.FloatArray:
        """A vector's displacements: values at the x nodes, hierarchic coefficients along y and z;
        shape (x nodes, y functions, z functions, 3), zero where empty."""
        model = self.model
        shape = (model.x.nodes.size, model.y.nodes.size, model.z.nodes.size, 3)
        out = np.zeros(shape, dtype=vector.dtype)
        for n, (component, iy, iz) in enumerate(self.parts):
            moving = component < 3
            part = vector[self.offsets[n] : self.offsets[n + 1]][moving]
            out[n, iy[moving], iz[moving], component[moving]] = part
        return out


def _shape(model: BoxModel, e: int) -> bytes:
    """What a slice's matrices come from, with its ceramics numbered by themselves."""
    springs = [f for f in model.foundations if f.x_elements[0] <= e < f.x_elements[1]]
    numbers, ranks = np.unique(model.ceramic[e], return_inverse=True)
    planes = [model.electrodes[n] for n in numbers if n >= 0]
    shape: bytes = model.medium[e].tobytes() + ranks.tobytes()
    return shape + repr((planes, springs)).encode()


def _renumbered(model: BoxModel, section: CrossSection, element: int) -> CrossSection:
    """The slice of `element`, from one that differs only in the numbers of its ceramics: these are
    in ascending order the same ones."""
    numbers = np.unique(model.ceramic[element])
    numbers = numbers[numbers >= 0]
    if numbers.tolist() == list(section.electrodes):
        return section
    component, iy, iz = code_parts(model, section.codes)
    electric, base, ceramics = component == 3, potential_base(model), len(model.electrodes)
    rank = np.searchsorted(section.electrodes, (section.codes[electric] - base) % ceramics)
    codes = section.codes.copy()
    node = (iy * model.z.nodes.size + iz)[electric]
    codes[electric] = base + node * ceramics + numbers[rank]
    return dataclasses.replace(section, codes=codes, electrodes=tuple(numbers.tolist()))


def require_countable(x: LineMesh, y: LineMesh, z: LineMesh, trunk: float) -> None:
    """Refuse meshes that are far too fine for memory, before a model is made of them.

    Raises `InputError`.
    """
    full = int(np.count_nonzero(kept_products(y, z, trunk)))
    _require_memory(x.nodes.size, full, _FEWEST * _FLOAT * x.elements * full**2)


def _require_memory(slices: int, most: int, memory: float) -> None:
    enough = (
        f"{slices} slices of up to {most} unknowns are too many; "
        "ask for fewer nodal lines or a lower frequency, or take a beam (theory timoshenko)"
    )
    require_within(SOLID_MEMORY, memory, enough=enough)
