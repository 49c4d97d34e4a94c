"""`solve_modes`: the modes of a plate near a frequency, in a band, or with given nodal lines.

Two meshes are solved. The coarse one finds the modes, counts them (Sylvester), and gives what needs
few digits: coupling and energy shares. The finer one starts from these shapes. Its frequency and
the difference between the two give the extrapolated frequency and its estimated error.
"""

from __future__ import annotations

import dataclasses
import functools
import time
from dataclasses import KW_ONLY, dataclass
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import FREQUENCY
from squeezefilm.core.progress import Deadline, ShareProgress
from squeezefilm.physics.plate.elements.cross_section import Springs, Weight
from squeezefilm.physics.plate.elements.slabs import Slabs
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.coarse_modes import (
    CoarseModes,
    chosen_modes,
    class_fits,
    coarse_modes,
)
from squeezefilm.physics.plate.solid.forecast import estimated_frequency, expected_seconds
from squeezefilm.physics.plate.solid.modes import (
    MODEL,
    Label,
    PlateModes,
    check_band,
    label_of,
    surface_shapes,
)
from squeezefilm.physics.plate.solid.refined_modes import (
    UNREFINED,
    RefinedModes,
    effective_coupling,
    extrapolated,
    refined_modes,
    with_label,
)
from squeezefilm.physics.plate.solid.symmetry import (
    all_classes,
    drive_classes,
    drive_signs,
    told_of,
)


def energy_shares_of(slabs: Slabs, vectors: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
    """The share of each medium, and of springs, in a mode's elastic energy (modes × media), and the
    loss factor that these shares and each medium's and spring's own loss make."""
    model = slabs.model

    def energy(weight: Weight, springs: Springs) -> si.FloatArray:
        sections = slabs.weighted_sections(weight, springs)
        return np.asarray(np.sum(vectors * slabs.stiffness_times(vectors, sections), axis=0))

    parts = [
        energy(lambda other, own=medium: (float(other is own), 0.0), 0.0)  # type: ignore[misc]
        for medium in model.media
    ]
    if model.foundations:
        parts.append(energy(lambda medium: (0.0, 0.0), 1.0))
    lost = energy(lambda medium: (medium.loss or 0.0, 0.0), model.spring_losses)
    whole = np.sum(parts, axis=0)
    return np.stack(parts, axis=1) / whole[:, None], lost / whole


# Fields of `PlateModes` that have no entry for each mode.
_OF_ALL = {"plate", "x", "y", "materials", "model", "status", "unknowns", "left_coarse", "_again"}


def collected_modes(
    plate: RectangularPlate,
    pieces: list[RefinedModes],
    tolerance: float,
    band: tuple[float, float] | None,
) -> PlateModes:
    """The modes of all classes in ascending order, those outside a band left out.

    Raises `InputError` where none is left.
    """
    tables = [_modes_of(piece, drive_signs(plate)) for piece in pieces]
    order = _order([frequency for table in tables for frequency in table.frequencies], band)

    def taken(name: str) -> Any:
        rows = [row for table in tables for row in getattr(table, name)]
        chosen = [rows[i] for i in order]
        return tuple(chosen) if isinstance(getattr(tables[0], name), tuple) else np.array(chosen)

    columns = {field.name for field in dataclasses.fields(PlateModes)} - _OF_ALL
    modes = dataclasses.replace(tables[0], **{name: taken(name) for name in columns})
    over = int(np.sum(modes.errors > tolerance * modes.frequencies))
    return dataclasses.replace(
        modes,
        status=(
            f"the frequencies of all {len(order)} modes within {100 * tolerance:.2g} % (estimated)"
            if over == 0
            else f"{over} of {len(order)} modes have an estimated error above {tolerance:.1e}; "
            + ("the time was up" if modes.left_coarse else "no finer mesh was used")
        ),
        unknowns=max(table.unknowns for table in tables),
        left_coarse=any(table.left_coarse for table in tables),
    )


def _order(every: list[si.Hertz], band: tuple[float, float] | None) -> list[int]:
    """The numbers of the frequencies in a band, ascending by frequency."""
    order = sorted(range(len(every)), key=every.__getitem__)
    if band is not None:
        order = [i for i in order if band[0] <= every[i] <= band[1]]
    if not order:
        low, high = band or (0.0, 0.0)
        raise InputError(
            f"no mode lies between {low:.6g} Hz and {high:.6g} Hz; widen the band, or ask for the "
            "modes near a frequency",
            quantity="band",
        )
    return order


def _modes_of(piece: RefinedModes, signs: si.FloatArray) -> PlateModes:
    """The modes of one class; `signs` are those of the drive."""
    frequency, error = extrapolated(piece.coarse_values, piece.values, piece.level)
    solved = piece.solved
    vectors = piece.vectors * (1 / np.sqrt(solved.copies))
    x, y, surface = surface_shapes(solved, vectors)
    G, _ = solved.slabs.electrode_columns
    own = np.array(solved.sign_of) * np.array(solved.share_of)
    forces = -(G.T @ vectors).T[:, list(solved.electrode_of)] * own[None, :]
    # Ratios need few digits: they are taken from the coarse mesh.
    rough, some = piece.found, piece.found.vectors[:, piece.index]
    shares, losses = energy_shares_of(rough.solved.slabs, some)
    omega = piece.shunted
    shunted = omega.real / np.sqrt(piece.values)
    frequency, error = frequency * shunted, error * shunted
    losses = losses + 2 * omega.imag / omega.real
    coupling, coupling_error = effective_coupling(piece)
    opened, open_error = extrapolated(piece.coarse_open_values, piece.open_values, piece.level)
    # A product for each mode, as results were recorded: `forces @ signs` may differ in the last
    # digit. (So may a mode that is alone in its class: BLAS adds in another order along its row.)
    driven = np.array([row @ signs for row in forces])
    turn = np.array([_turn(top, push) for top, push in zip(surface, driven, strict=True)])
    model = solved.model
    return PlateModes(
        plate=solved.plate,
        frequencies=frequency,
        errors=error,
        mesh_frequencies=np.sqrt(piece.values) / (2 * np.pi),
        labels=tuple(label_of(top, x, y) for top in surface),
        parities=(solved.parity,) * frequency.size,
        x=x,
        y=y,
        shapes=turn[:, None, None] * surface[..., 2],
        modal_forces=turn[:, None] * forces,
        drive_forces=np.abs(driven),
        open_frequencies=opened,
        open_errors=open_error,
        coupling_errors=coupling_error,
        couplings=coupling,
        quality_factors=1 / np.maximum(losses, 1e-30),
        materials=(*(m.name for m in model.media), *(["supports"] if model.foundations else [])),
        energy_shares=shares,
        model=MODEL,
        status="",
        unknowns=solved.slabs.unknowns,
        _fields=tuple((solved, sign * vec) for sign, vec in zip(turn, vectors.T, strict=True)),
        left_coarse=piece.level == UNREFINED,
    )


def _turn(top: si.FloatArray, driven: float) -> float:
    """The sign of a mode is free: the drive pushes it up, or its largest value does."""
    largest = top[:, :, 2].flat[int(np.argmax(np.abs(top[:, :, 2])))]
    return -1.0 if driven < -1e-9 or (abs(driven) <= 1e-9 and largest < 0) else 1.0


# So many modes of a class are looked at around the guess of a mode that is asked for by its lines.
_WIDTHS = (8, 24)
# So many around the frequency that a plate's description asks for: one of them is meant.
_BY_FREQUENCY = 4
# The share of the time that the coarse meshes take: an eighth to a third, measured on the presets.
_COARSE = 0.2


@si.checked_numbers
@dataclass(frozen=True)
class ModesRequest:
    """Arguments of `solve_modes`."""

    plate: RectangularPlate
    _: KW_ONLY
    near: si.Hertz | None = None
    band: tuple[si.Hertz, si.Hertz] | None = None
    mode: Label | None = None
    count: Annotated[int, si.AtLeast(1)] = 6
    tolerance: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)] = 1e-3
    driven_only: bool = False
    progress: ShareProgress | None = None
    deadline: Deadline | None = None


@called_with(ModesRequest)
def solve_modes(asked: ModesRequest) -> PlateModes:
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
    ways = [option for option in (asked.near, asked.band, asked.mode) if option is not None]
    if len(ways) > 1:
        raise InputError("give one of near, band and mode; they choose the modes in different ways")
    if asked.near is not None:
        si.require("near", asked.near, si.Unit("Hz"), above=0, at_most=FREQUENCY.most)
    if asked.band is not None:
        check_band(asked.band)
    if not ways:
        asked = dataclasses.replace(asked, mode=asked.plate.working_label)
    modes, _ = solved_classes(asked)
    unhurried = dataclasses.replace(asked, progress=None, deadline=None)
    return dataclasses.replace(modes, _again=functools.partial(solve_modes, **vars(unhurried)))


@one_blas_thread()
def solved_classes(
    asked: ModesRequest, *, keep_factors: bool = False
) -> tuple[PlateModes, list[RefinedModes]]:
    """`solve_modes` with one of its three ways to choose, and the refined modes of each class with
    their mesh.

    With `keep_factors` each has the factors of its mesh too, on which `harmonic_response` can go
    on. Those take 50 to 500 MB: let them go soon. Raises what `solve_modes` raises.
    """
    plate, band, deadline = asked.plate, asked.band, asked.deadline
    near, mode, count = asked.near, asked.mode, asked.count
    tell = asked.progress or (lambda text, fraction: None)
    classes = drive_classes(plate) if asked.driven_only else all_classes(plate)
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
        for number, (coarse, index) in enumerate(zip(found, chosen, strict=True)):
            if index.size:
                share = _COARSE + (1 - _COARSE) * number / len(found)
                tell(f"fine mesh, {told_of(coarse.solved.parity)}", share)
                pieces.append(
                    refined_modes(
                        plate,
                        coarse,
                        index,
                        highest,
                        asked.tolerance,
                        deadline,
                        keep_factor=keep_factors,
                    )
                )
        if mode is None:
            break
        labelled = [piece for piece in (with_label(p, mode) for p in pieces) if piece.index.size]
        if labelled:
            pieces = labelled
            break
    return collected_modes(plate, pieces, asked.tolerance, band), pieces


def _slowness(found: list[CoarseModes], took: si.Second) -> float:
    """Time that the coarse meshes took over what was expected: another machine, or a busy one.

    Between 1 and 4: what is compiled for the first time is no measure of the next mesh.
    """
    expected = sum(expected_seconds(coarse.solved) for coarse in found)
    return min(max(1.0, took / expected), 4.0)
