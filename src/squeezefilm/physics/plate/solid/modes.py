"""The modes of a plate: what `solve_modes` returns, with shapes, labels and fields."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import FREQUENCY, require_within
from squeezefilm.physics.plate.elements.nodal_lines import (
    line_counts,
    line_distance,
    profiles,
    zero_crossings,
)
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import COARSE, NORMAL, Resolution
from squeezefilm.physics.plate.solid.symmetry import PlateModel, Symmetry

_SOLVING = threading.RLock()


class SolvedAgain:
    """A result whose `_bulk` attributes stay behind when it is pickled or copied.

    `_again` solves for the same result; it is called at the first use of what stayed behind, and
    takes as long as it took the first time. Without `_again` all is pickled.
    """

    _bulk: ClassVar[tuple[str, ...]] = ()
    _again: Callable[[], Any] | None

    def __getstate__(self) -> dict[str, Any]:
        if self._again is None:
            return dict(vars(self))
        return {name: value for name, value in vars(self).items() if name not in self._bulk}

    if not TYPE_CHECKING:  # A checker would take any misspelt name for one of these.

        def __getattr__(self, name: str) -> Any:
            again = vars(self).get("_again")
            if name not in self._bulk or again is None:
                raise AttributeError(f"{type(self).__name__} has no attribute '{name}'")
            with _SOLVING:
                if name not in vars(self):
                    whole = again()
                    vars(self).update({bulky: getattr(whole, bulky) for bulky in self._bulk})
            return vars(self)[name]


Label = tuple[int, int]
MODEL = "piezoelectric_solid_3d"
# So near to a frequency that is asked for nodal lines still decide which mode is meant.
_NEAR_WANTED = 0.03
COARSE_ERROR: si.Dimensionless = 0.02
"""Error of a frequency on the coarse mesh alone, relative: 1.2 % at most on 32 random plates."""
COARSE_AMPLITUDE_ERROR: si.Dimensionless = 0.05
"""Error of a driven mode's amplitude per volt there, relative: 1.5 % at most on seven of these
plates; of modes that the drive does not move it is of any size."""


@dataclass(frozen=True, eq=False)
class PlateModes(SolvedAgain):
    """Modes of a plate in ascending order, electrodes as the plate describes them.

    `frequencies` are extrapolated to the converged value from two meshes, `errors` the estimated
    distance from it, `mesh_frequencies` those of the finer mesh. `labels` are nodal lines across
    the length and across the width (None for motion in the plane), `parities` the symmetry class.
    `shapes` is w on the upper face over `x` × `y`, shape (modes, x, y), of modes with unit modal
    mass, so in 1/√kg. `modal_forces` (modes × patches) is the force of one volt on each patch's
    electrode on such a mode, in N/(V √kg), and `drive_forces` that of one volt on the drive.
    `open_frequencies` are those with the drive's terminals open (parallel resonances without
    losses) with `open_errors`; `couplings` is the effective coupling coefficient
    √(1 − f_short²/f_open²) of the terminals with `coupling_errors`. `quality_factors` are from the
    materials' losses weighted by their elastic energy, whose shares are in `energy_shares` (modes ×
    `materials`). `left_coarse` says that a deadline left no time for a finer mesh.
    """

    plate: RectangularPlate
    frequencies: si.HertzArray
    errors: si.HertzArray
    mesh_frequencies: si.HertzArray
    labels: tuple[Label | None, ...]
    parities: tuple[Symmetry, ...]
    x: si.MetreArray
    y: si.MetreArray
    shapes: si.FloatArray
    modal_forces: si.FloatArray
    drive_forces: si.FloatArray
    open_frequencies: si.HertzArray
    open_errors: si.HertzArray
    coupling_errors: si.DimensionlessArray
    couplings: si.DimensionlessArray
    quality_factors: si.DimensionlessArray
    materials: tuple[str, ...]
    energy_shares: si.DimensionlessArray
    model: str
    status: str
    unknowns: int
    _fields: tuple[tuple[PlateModel, si.FloatArray], ...] = field(repr=False)
    _again: Callable[[], PlateModes] | None = field(repr=False, default=None)
    left_coarse: bool = False
    _bulk: ClassVar[tuple[str, ...]] = ("_fields",)

    @property
    def count(self) -> int:
        """Number of modes."""
        return self.frequencies.size

    @property
    def resolution(self) -> Resolution:
        """Fineness of the mesh of a response to match these modes."""
        return COARSE if self.left_coarse else NORMAL

    @property
    def coarseness(self) -> str:
        """Sentence on modes that a deadline left on the coarse mesh; empty for others."""
        if not self.left_coarse:
            return ""
        return (
            f"the budget left no time for a finer mesh: frequencies are within "
            f"{100 * COARSE_ERROR:g} %, amplitudes of driven modes within "
            f"{100 * COARSE_AMPLITUDE_ERROR:g} % of the converged ones (bounds measured on other "
            "plates). Allow more time for better ones"
        )

    def _known(self, mode: int) -> int:
        si.require("mode", mode, at_least=-self.count, at_most=self.count - 1)
        return mode

    @si.checked_numbers
    def index(self, label: Label) -> int:
        """The position of the mode with these nodal lines.

        Of several the most strongly driven one is taken. The working mode of a plate with a
        `working_frequency` is the one nearest to that: of those with its nodal lines within 3 % of
        it, and where there is none, of all that are driven. Raises `InputError` where there is
        none.
        """
        numbers = [i for i, own in enumerate(self.labels) if own == tuple(label)]
        wanted = self.plate.working_frequency
        if wanted is not None and tuple(label) == self.plate.working_label:
            away = np.abs(self.frequencies / wanted - 1)
            near = [i for i in numbers if away[i] < _NEAR_WANTED]
            driven = self.drive_forces > 1e-6 * np.max(self.drive_forces)
            return min(near or np.flatnonzero(driven).tolist(), key=away.__getitem__)
        if not numbers:
            known = [str(own) for own in self.labels if own is not None]
            raise InputError(
                f"no mode {label} is among those solved ({', '.join(known)})."
                f"{si.did_you_mean(str(label), known)} Solve near another frequency or a wider "
                "band; squeezefilm modes lists what is driven",
                quantity="label",
            )
        return max(numbers, key=self.drive_forces.__getitem__)

    @si.checked_numbers
    def field(self, mode: int, x: si.FloatArray, y: si.FloatArray, z: si.Metre) -> si.FloatArray:
        """Displacement (u, v, w) of a mode on the grid of `x` × `y` at height `z` above the
        plate's lower face, shape (x, y, 3), in 1/√kg."""
        solved, vector = self._fields[self._known(mode)]
        si.require("x", x, si.Unit("m"), axes=1)
        si.require("y", y, si.Unit("m"), axes=1)
        values: si.FloatArray = solved.field(vector[:, None], x, y, z)[0]
        return values

    @si.checked_numbers
    def nodal_positions(self, mode: int) -> si.MetreArray:
        """Places where w vanishes (m) along the side that more nodal lines cross, of the shape's
        dominant part: along the length, or along the width of a mode such as (0,7)."""
        along, across, _ = profiles(self.shapes[self._known(mode)])
        lines = zero_crossings(self.x, along), zero_crossings(self.y, across)
        return lines[0] if lines[0].size >= lines[1].size else lines[1]

    @si.checked_numbers
    def half_wavelength(self, mode: int) -> si.Metre:
        """The mean distance of nodal lines along the side that more of them cross (m), see
        `line_distance`."""
        return line_distance(self.nodal_positions(mode))


_POINTS = (97, 65)


def surface_shapes(
    solved: PlateModel, vectors: si.FloatArray
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """A grid x, y over the whole plate and the displacements there on its upper face."""
    plate = solved.plate
    x, y = np.linspace(0, plate.length, _POINTS[0]), np.linspace(0, plate.width, _POINTS[1])
    return x, y, solved.field(vectors, x, y, plate.thickness)


def label_of(surface: si.FloatArray, x: si.FloatArray, y: si.FloatArray) -> Label | None:
    """Nodal lines across the length and the width from displacements (x, y, 3) on the upper face;
    None where the motion is mostly in the plane."""
    w = surface[:, :, 2]
    in_plane = float(np.mean(surface[:, :, 0] ** 2 + surface[:, :, 1] ** 2))
    if float(np.mean(w**2)) < 0.3 * in_plane:
        return None
    return line_counts(w, x, y)


@si.checked_numbers
def check_band(band: tuple[si.Hertz, si.Hertz]) -> None:
    """Refuse a band that is none."""
    if not 0 <= band[0] < band[1]:
        raise InputError(
            f"band = {band[0]:.6g} Hz to {band[1]:.6g} Hz is none; give a lower and a higher "
            "frequency",
            quantity="band",
        )
    require_within(FREQUENCY, band[1], "band")
