"""`solve_modes`: the modes of a plate near a frequency, in a band, or with given nodal lines.

Two meshes are solved. The coarse one finds the modes, counts them (Sylvester), and gives what needs
few digits: coupling and energy shares. The finer one starts from these shapes. Its frequency and
the difference between the two give the extrapolated frequency and its estimated error.
"""

from __future__ import annotations

import dataclasses
import functools
import time
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import FREQUENCY
from squeezefilm.core.progress import Deadline, ShareProgress
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.coarse_modes import (
    CoarseModes,
    chosen_modes,
    class_fits,
    coarse_modes,
)
from squeezefilm.physics.plate.solid.guess import estimated_frequency
from squeezefilm.physics.plate.solid.mode_table import collected_modes
from squeezefilm.physics.plate.solid.modes import Label, PlateModes, check_band
from squeezefilm.physics.plate.solid.refined_modes import RefinedModes, refined_modes, with_label
from squeezefilm.physics.plate.solid.size import expected_seconds
from squeezefilm.physics.plate.solid.symmetry import all_classes, drive_classes, told_of

# So many modes of a class are looked at around the guess of a mode that is asked for by its lines.
_WIDTHS = (8, 24)
# So many around the frequency that a plate's description asks for: one of them is meant.
_BY_FREQUENCY = 4
# The share of the time that the coarse meshes take: an eighth to a third, measured on the presets.
_COARSE = 0.2


@si.checked_numbers
def solve_modes(
    plate: RectangularPlate,
    *,
    near: si.Hertz | None = None,
    band: tuple[si.Hertz, si.Hertz] | None = None,
    mode: Label | None = None,
    count: Annotated[int, si.AtLeast(1)] = 6,
    tolerance: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)] = 1e-3,
    driven_only: bool = False,
    progress: ShareProgress | None = None,
    deadline: Deadline | None = None,
) -> PlateModes:
    """Modes of a plate by three-dimensional piezoelectric finite elements.

    One of: `near` (Hz), the `count` modes nearest to it; `band` (Hz, Hz), all modes in it, their
    number checked by Sylvester's law on the coarse mesh; `mode`, the one with these nodal lines
    across length and width. With none of them the plate's working mode is solved. `driven_only`
    leaves out the classes of symmetry that the drive does not excite. Where the estimated error of
    a mode exceeds `tolerance` (relative) finer meshes are used, and `status` says if that was not
    enough. `progress` is called with a text and a fraction. A mesh that would end after the
    `deadline` is not begun: the modes are those of the last one then, with its larger error.

    Electrodes are shorted or driven (the same for free vibration) unless a patch says open or
    shunted: a resistor's stiffening counts in `frequencies`, its loss in `quality_factors`; shapes
    and couplings are those with it short. Valid for linear, small vibration in vacuum. Interrupted,
    it leaves nothing behind.

    Raises `InputError` for a band without modes or a label that is not found, `OutOfRangeError` for
    plates too thin for solid elements.
    """
    if sum(option is not None for option in (near, band, mode)) > 1:
        raise InputError("give one of near, band and mode; they choose the modes in different ways")
    if near is not None:
        si.require("near", near, si.Unit("Hz"), above=0, at_most=FREQUENCY.most)
    if band is not None:
        check_band(band)
    if near is None and band is None and mode is None:
        mode = plate.working_label
    tell = progress or (lambda text, fraction: None)
    with one_blas_thread():
        found, _ = _solved(plate, near, band, mode, count, tolerance, driven_only, tell, deadline)
    again = functools.partial(
        solve_modes,
        plate,
        near=near,
        band=band,
        mode=mode,
        count=count,
        tolerance=tolerance,
        driven_only=driven_only,
    )
    return dataclasses.replace(found, _again=again)


def solve_for_response(
    plate: RectangularPlate,
    mode: Label,
    tolerance: si.Dimensionless,
    progress: ShareProgress | None = None,
    deadline: Deadline | None = None,
) -> tuple[PlateModes, list[RefinedModes]]:
    """`solve_modes` of one label, and the refined modes of each class with their mesh and its
    factors, on which `harmonic_response` can go on. Those take 50 to 500 MB: let them go soon.

    Raises what `solve_modes` raises.
    """
    again = functools.partial(solve_modes, plate, mode=mode, tolerance=tolerance)
    tell = progress or (lambda text, fraction: None)
    with one_blas_thread():
        modes, pieces = _solved(
            plate, None, None, mode, 1, tolerance, False, tell, deadline, keep_factors=True
        )
    return dataclasses.replace(modes, _again=again), pieces


def _solved(
    plate: RectangularPlate,
    near: float | None,
    band: tuple[float, float] | None,
    mode: Label | None,
    count: int,
    tolerance: float,
    driven_only: bool,
    tell: ShareProgress,
    deadline: Deadline | None,
    *,
    keep_factors: bool = False,
) -> tuple[PlateModes, list[RefinedModes]]:
    classes = drive_classes(plate) if driven_only else all_classes(plate)
    if mode is not None:
        classes = [c for c in all_classes(plate) if class_fits(c, mode)]
        if mode == plate.working_label and plate.working_frequency is not None:
            near, mode, count = plate.working_frequency, None, _BY_FREQUENCY
        else:
            near = estimated_frequency(plate, mode)
    centre = near if near is not None else sum(band or (0.0, 0.0)) / 2
    highest = band[1] if band is not None else 1.15 * centre
    # What a coarse mesh takes for the mode may be another on a finer one: then look further.
    for nearest in _WIDTHS if mode is not None else (count,):
        found, begun = [], time.monotonic()
        for number, parity in enumerate(classes):
            tell(f"coarse mesh, {told_of(parity)}", _COARSE * number / len(classes))
            found.append(coarse_modes(plate, parity, centre, highest, band, nearest))
        if deadline is not None:
            deadline = deadline.slower(_slowness(found, time.monotonic() - begun))
        last = nearest == _WIDTHS[-1]
        try:
            chosen = chosen_modes(found, near, band, mode, count)
        except InputError:
            if last or mode is None:
                raise
            continue
        pieces: list[RefinedModes] = []
        for number, (one, index) in enumerate(zip(found, chosen, strict=True)):
            if index.size:
                share = _COARSE + (1 - _COARSE) * number / len(found)
                tell(f"fine mesh, {told_of(one.parity)}", share)
                pieces.append(
                    refined_modes(
                        plate, one, index, highest, tolerance, deadline, keep_factor=keep_factors
                    )
                )
        if mode is None:
            break
        labelled = [piece for piece in (with_label(p, mode) for p in pieces) if piece.index.size]
        if labelled:
            pieces = labelled
            break
    return collected_modes(plate, pieces, tolerance, band), pieces


def _slowness(found: list[CoarseModes], took: si.Second) -> float:
    """Time that the coarse meshes took over what was expected: another machine, or a busy one.

    Between 1 and 4: what is compiled for the first time is no measure of the next mesh.
    """
    expected = sum(expected_seconds(one.solved) for one in found)
    return min(max(1.0, took / expected), 4.0)
