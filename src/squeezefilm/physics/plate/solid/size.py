"""Size of the three-dimensional solve of a plate, and how long it may take.

Counted on the meshes that would be made, before anything is assembled.
"""

from __future__ import annotations

from typing import NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfTimeError
from squeezefilm.core.progress import Deadline
from squeezefilm.physics.plate.elements.slab_count import SlabCount, slab_count
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.coarse_modes import class_fits
from squeezefilm.physics.plate.solid.layers import COARSE, NORMAL, Resolution
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.model import PlateModel
from squeezefilm.physics.plate.solid.modes import Label
from squeezefilm.physics.plate.solid.reduced import resolved_frequency
from squeezefilm.physics.plate.solid.symmetry import all_classes, drive_classes

# Processor time of one thread of the machine that this was written on, fitted to 14 plates of metal
# and glass (see `benchmarks/size.py`): cubes of elements' slices that are worked off in a second to
# factorise and search a mesh, and squares to go on to the response.
_RATE, _RESPONSE_RATE = 2.0e9, 6.5e6
# Around what a mesh takes besides (s).
_BESIDES = 0.15


class SolveSize(NamedTuple):
    """Size of the solve of a plate's working mode: unknowns of its largest mesh, and seconds of the
    coarse meshes, of the finer ones, and of the response on either."""

    unknowns: int
    coarse: si.Second
    refined: si.Second
    coarse_response: si.Second
    response: si.Second

    @property
    def seconds(self) -> si.Second:
        """Time of all that a working mode takes (s): within a factor of 2 of the processor time on
        14 plates, and by how fast the machine is and what else it does."""
        return self.coarse + self.refined + self.response

    def require_within(self, deadline: Deadline, budget: si.Second, instead: str = "") -> None:
        """Raise `OutOfTimeError` where a deadline, that of a budget (s), does not allow the coarse
        meshes; `instead` follows what is said."""
        least = self.coarse + self.coarse_response
        if not deadline.allows(least):
            raise OutOfTimeError(
                f"the coarsest three-dimensional mesh takes about {least:.2g} s, more than the "
                f"budget of {budget:.3g} s; allow more{instead}",
                quantity="budget",
            )


def expected_seconds(solved: PlateModel) -> si.Second:
    """Time that a mesh takes to be factorised and searched (s): elements times the cube of their
    slices' unknowns, as `SolveSize.seconds` is right."""
    return _seconds(slab_count(solved.model))


def _seconds(count: SlabCount) -> si.Second:
    return _BESIDES + count.products / _RATE


@si.checked_numbers
def solve_size(plate: RectangularPlate, label: Label, frequency: si.Hertz) -> SolveSize:
    """The size of a solve for the mode with the nodal lines of `label`, expected near a frequency
    (Hz).

    Raises what `plate_model` raises: `OutOfRangeError` for a plate too thin for solid elements,
    `InputError` for one too large.
    """
    fitting = [one for one in all_classes(plate) if class_fits(one, label)]
    driven = drive_classes(plate)
    highest, band = 1.15 * frequency, resolved_frequency((frequency, frequency))

    def searched(resolution: Resolution) -> si.Second:
        return sum(
            expected_seconds(plate_model(plate, highest, resolution, one)) for one in fitting
        )

    def answered(resolution: Resolution) -> tuple[si.Second, int]:
        """The response's seconds and largest mesh: a mode's own mesh and factors serve again."""
        seconds, most = 0.0, 0
        for parity in driven:
            mesh = plate_model(plate, band, resolution, parity)
            count = slab_count(mesh.model)
            seconds += _BESIDES + count.squares / _RESPONSE_RATE
            seconds += 0.0 if parity in fitting else _seconds(count)
            most = max(most, count.unknowns)
        return seconds, most

    response, unknowns = answered(NORMAL)
    return SolveSize(unknowns, searched(COARSE), searched(NORMAL), answered(COARSE)[0], response)


@si.checked_numbers
def band_seconds(plate: RectangularPlate, highest: si.Hertz) -> si.Second:
    """Time that the coarse meshes of all classes of symmetry take up to a frequency (Hz), each
    counted twice more to know how many modes there are (s).

    Raises what `solve_size` raises.
    """
    meshes = [plate_model(plate, highest, COARSE, parity) for parity in all_classes(plate)]
    return 3 * sum(expected_seconds(mesh) for mesh in meshes)
