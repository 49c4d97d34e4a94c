"""`solve_modes`: the modes of a plate near a frequency, in a band, or with given nodal lines.

Two meshes are solved. The coarse one finds the modes, counts them (Sylvester), and gives what needs
few digits: coupling and energy shares. The finer one starts from these shapes. Its frequency and
the difference between the two give the extrapolated frequency and its estimated error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from squeezefilm.errors import InputError, OutOfRangeError, SqueezefilmError
from squeezefilm.plate.beam import free_beam_mode
from squeezefilm.plate.blas_threads import one_blas_thread
from squeezefilm.plate.box_model import IntArray, Medium
from squeezefilm.plate.krylov import (
    modes_below,
    modes_near,
    prolonged,
    with_open_electrodes,
)
from squeezefilm.plate.laminate import plate_laminate
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.plate_mesh import COARSE, FINE, NORMAL, Resolution, plate_model
from squeezefilm.plate.plate_modes import (
    MODEL,
    Label,
    PlateModes,
    SolvedModel,
    check_band,
    label_of,
)
from squeezefilm.plate.plate_symmetry import Parity, all_classes, drive_classes, drive_signs
from squeezefilm.plate.response import LEAST_COVERAGE
from squeezefilm.plate.shear_guess import screened_frequency
from squeezefilm.plate.slab_factor import SlabFactor
from squeezefilm.plate.slabs import Slabs
from squeezefilm.quantities import Dimensionless, FloatArray, Hertz, Unit, require

Progress = Callable[[str, float], None]

# Share of the difference between two meshes that is still missing on the finer one, and the
# uncertainty of that share, for the first and the second refinement (a smaller step): calibrated in
# tests/verification/test_plate_error.py. The floor is what a difference near zero may hide.
EXTRAPOLATION = (0.25, 1.0)
UNCERTAINTY = (0.25, 0.6)
_FLOOR = 1e-4
_POINTS = (97, 65)


@dataclass(frozen=True, eq=False)
class _Found:
    """Modes of one class on the coarse mesh, with what is taken from it."""

    parity: tuple[Parity | None, Parity | None]
    solved: SolvedModel
    values: FloatArray
    vectors: FloatArray
    labels: list[Label | None]
    factor: SlabFactor
    shift: float


def solve_modes(
    plate: RectangularPlate,
    *,
    near: Hertz | None = None,
    band: tuple[Hertz, Hertz] | None = None,
    mode: Label | None = None,
    count: int = 6,
    tolerance: Dimensionless = 1e-3,
    driven_only: bool = False,
    progress: Progress | None = None,
) -> PlateModes:
    """Modes of a plate by three-dimensional piezoelectric finite elements.

    One of: `near` (Hz), the `count` modes nearest to it; `band` (Hz, Hz), all modes in it, their
    number checked by Sylvester's law on the coarse mesh; `mode`, the one with these nodal lines
    across length and width. With none of them the plate's working mode is solved. `driven_only`
    leaves out the classes of symmetry that the drive does not excite. Where the estimated error of
    a mode exceeds `tolerance` (relative) finer meshes are used, and `status` says if that was not
    enough. `progress` is called with a text and a fraction.

    Electrodes are shorted or driven (the same for free vibration) unless a patch says open; a
    shunt counts as short here and acts in `harmonic_response`. Valid for linear, small vibration in
    vacuum. Raises `InputError` for a band without modes or a label that is not found,
    `OutOfRangeError` for plates too thin for solid elements.
    """
    if sum(option is not None for option in (near, band, mode)) > 1:
        raise InputError("give one of near, band and mode; they choose the modes in different ways")
    require("tolerance", tolerance, above=0, below=1)
    require("count", count, at_least=1)
    if near is not None:
        require("near", near, Unit("Hz"), above=0)
    if band is not None:
        check_band(band)
    if near is None and band is None and mode is None:
        mode = plate.working_label
    tell = progress or (lambda text, fraction: None)
    with one_blas_thread():
        return _solve(plate, near, band, mode, count, tolerance, driven_only, tell)


def _solve(
    plate: RectangularPlate,
    near: float | None,
    band: tuple[float, float] | None,
    mode: Label | None,
    count: int,
    tolerance: float,
    driven_only: bool,
    tell: Progress,
) -> PlateModes:
    classes = drive_classes(plate) if driven_only else all_classes(plate)
    if mode is not None:
        near = _estimate(plate, mode)
        classes = [c for c in all_classes(plate) if _fits(c, mode)]
    centre = near if near is not None else sum(band or (0.0, 0.0)) / 2
    highest = band[1] if band is not None else 1.15 * centre
    found = []
    for number, parity in enumerate(classes):
        tell(f"coarse mesh, symmetry {_name(parity)}", 0.3 * number / len(classes))
        found.append(_coarse(plate, parity, centre, highest, band, 8 if mode else count))
    chosen = _choose(found, near, band, mode, count)
    levels = [(COARSE, NORMAL), (NORMAL, FINE)]
    pieces: list[_Piece] = []
    for number, (one, index) in enumerate(zip(found, chosen, strict=True)):
        if index.size:
            tell(f"fine mesh, symmetry {_name(one.parity)}", 0.3 + 0.7 * number / len(found))
            pieces.append(_refined(plate, one, index, highest, levels, tolerance))
    return _collected(plate, pieces, tolerance, band)


def _name(parity: tuple[Parity | None, Parity | None]) -> str:
    return "".join(p or "-" for p in parity)


def _fits(parity: tuple[Parity | None, Parity | None], label: Label) -> bool:
    return all(
        p is None or p == ("S" if lines % 2 == 0 else "A")
        for p, lines in zip(parity, label, strict=True)
    )


def _estimate(plate: RectangularPlate, label: Label) -> float:
    """A first guess of a mode's frequency: a Timoshenko beam with the mode's wave number."""
    section = plate_laminate(plate, "plane_strain")
    lines = [(n, span) for n, span in zip(label, (plate.length, plate.width), strict=True)]
    k2 = sum(((n - 0.5) * np.pi / span) ** 2 for n, span in lines if n >= 2)
    k2 += 2 * (np.pi / plate.length) * (np.pi / plate.width) if label == (1, 1) else 0.0
    if k2 == 0:
        raise InputError(
            f"a mode with nodal lines {label} is no elastic mode that can be guessed; solve near a "
            "frequency or in a band",
            quantity="mode",
        )
    if plate.coverage < LEAST_COVERAGE and (guess := screened_frequency(plate, label)) is not None:
        return guess
    from squeezefilm.plate.beam import timoshenko_frequency

    if label[1] == 0:
        try:
            return free_beam_mode(section, plate.length, label[0]).frequency
        except (OutOfRangeError, SqueezefilmError):
            pass
    return float(timoshenko_frequency(float(np.pi / np.sqrt(k2)), section))


def _surface(solved: SolvedModel, vectors: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    plate = solved.plate
    x, y = np.linspace(0, plate.length, _POINTS[0]), np.linspace(0, plate.width, _POINTS[1])
    return x, y, solved.field(vectors, x, y, plate.thickness)


def _solver(slabs: Slabs, solved: SolvedModel, factor: SlabFactor) -> Callable[..., FloatArray]:
    """The inverse with the plate's own open electrodes."""
    open_patches = [i for i, p in enumerate(solved.plate.patches) if p.electrode == "open"]
    columns = _ties(solved, [[(i, 1.0)] for i in open_patches])
    return with_open_electrodes(slabs, factor.solve, columns) if columns.size else factor.solve


def _ties(solved: SolvedModel, groups: list[list[tuple[int, float]]]) -> FloatArray:
    """Model electrodes tied together, one column a group of (patch, sign); empty groups and
    repeated ones (mirror images) left out."""
    electrodes = len(solved.built.model.electrodes)
    columns: list[FloatArray] = []
    for group in groups:
        column = np.zeros(electrodes)
        for patch, sign in group:
            if solved.built.share_of[patch] == 0:
                continue
            column[solved.built.electrode_of[patch]] += sign * solved.built.sign_of[patch]
        column = np.sign(np.round(column, 9))
        if np.any(column) and not any(
            np.array_equal(np.abs(column), np.abs(other)) for other in columns
        ):
            columns.append(column)
    return np.stack(columns, axis=1) if columns else np.zeros((electrodes, 0))


def _coarse(
    plate: RectangularPlate,
    parity: tuple[Parity | None, Parity | None],
    centre: float,
    highest: float,
    band: tuple[float, float] | None,
    count: int,
) -> _Found:
    built = plate_model(plate, highest, COARSE, parity)
    slabs = Slabs(built.model)
    solved = SolvedModel(plate, built, slabs)
    shift = (2 * np.pi * centre * 1.0007) ** 2
    factor = SlabFactor(slabs, shift)
    expected: int | None = None
    if band is not None:
        # The coarse mesh is stiffer: look a little beyond the band, and choose later.
        low, high = 0.98 * band[0], 1.03 * band[1]
        limits = (2 * np.pi * low) ** 2, (2 * np.pi * high) ** 2
        opened = any(p.electrode == "open" for p in plate.patches)
        if not opened:
            expected = modes_below(slabs, limits[1]) - (
                modes_below(slabs, limits[0]) if low > 0 else 0
            )

        def wanted(values: FloatArray) -> IntArray:
            inside = np.flatnonzero((values > limits[0]) & (values < limits[1]))
            # Not there yet: let the iteration go on by asking for what is not found.
            if expected is not None and inside.size < expected:
                return np.flatnonzero(values == np.inf)
            return inside

    else:

        def wanted(values: FloatArray) -> IntArray:
            positive = np.flatnonzero(values > (2 * np.pi * 1.0) ** 2)
            near = positive[np.argsort(np.abs(np.sqrt(values[positive]) - 2 * np.pi * centre))]
            return np.sort(near[:count])

    if expected == 0:
        values, vectors = np.zeros(0), np.zeros((slabs.unknowns, 0))
    else:
        start = np.random.default_rng(1).standard_normal((slabs.unknowns, 4))
        start[(slabs.components == 3) | slabs.held] = 0
        solve = _solver(slabs, solved, factor)
        pairs = modes_near(slabs, solve, shift, wanted, start, tolerance=1e-6)
        values, vectors = pairs.values, pairs.vectors
    _, _, surface = _surface(solved, vectors)
    x, y = np.linspace(0, plate.length, _POINTS[0]), np.linspace(0, plate.width, _POINTS[1])
    labels = [label_of(one, x, y) for one in surface]
    return _Found(parity, solved, values, vectors, labels, factor, shift)


def _shares(slabs: Slabs, vectors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The share of each medium, and of springs, in a mode's elastic energy; loss factors."""
    media = slabs.model.media
    energy = []
    for medium in media:

        def only(other: Medium, own: Medium = medium) -> tuple[float, float]:
            return float(other is own), 0.0

        sections = slabs.weighted_sections(only, springs=0.0)
        energy.append(np.sum(vectors * slabs.stiffness_times(vectors, sections), axis=0))
    losses = [m.loss for m in media]
    if slabs.model.foundations:
        springs = slabs.weighted_sections(lambda m: (0.0, 0.0), springs=1.0)
        energy.append(np.sum(vectors * slabs.stiffness_times(vectors, springs), axis=0))
        losses.append(slabs.model.foundations[0].loss)
    total = np.stack(energy, axis=1)
    return total / np.sum(total, axis=1, keepdims=True), np.array(losses)


def _open_values(one: _Found, values: FloatArray, vectors: FloatArray) -> FloatArray:
    """ω² of the same modes with the drive's terminals open."""
    solved, slabs, factor, shift = one.solved, one.solved.slabs, one.factor, one.shift
    signs = drive_signs(solved.plate)
    port = _ties(solved, [[(i, s) for i, s in enumerate(signs) if s]])
    opened = _ties(
        solved, [[(i, 1.0)] for i, p in enumerate(solved.plate.patches) if p.electrode == "open"]
    )
    columns = np.concatenate([port, opened], axis=1)
    G, _ = slabs.electrode_columns
    force = G @ port
    if values.size == 0 or not port.size or np.max(np.abs(force.T @ vectors)) < 1e-9:
        return values.copy()
    solve = with_open_electrodes(slabs, factor.solve, columns)
    # Rayleigh–Ritz over the modes and one step of the open inverse: open modes are near.
    X = np.concatenate([vectors, solve(slabs.mass_times(vectors))], axis=1)
    X = np.concatenate([X, solve(slabs.mass_times(X[:, vectors.shape[1] :]))], axis=1)
    MX = slabs.mass_times(X)
    lifted = solve(MX)
    a, b = MX.T @ lifted, X.T @ MX
    size, turn = np.linalg.eigh((b + b.T) / 2)
    good = size > 1e-11 * size[-1]
    T = turn[:, good] / np.sqrt(size[good])
    inverse, turn2 = np.linalg.eigh(T.T @ (a + a.T) @ T / 2)
    ritz = shift + 1 / inverse
    overlap = (vectors.T @ MX @ (T @ turn2)) ** 2
    best = np.argmax(overlap, axis=1)
    return np.asarray(np.maximum(ritz[best], values))


def _choose(
    found: list[_Found],
    near: float | None,
    band: tuple[float, float] | None,
    mode: Label | None,
    count: int,
) -> list[IntArray]:
    """The indices of the modes to refine, for each class."""
    frequencies = [np.sqrt(one.values) / (2 * np.pi) for one in found]
    if mode is not None:
        out = []
        for one in found:
            hits = [i for i, label in enumerate(one.labels) if label == mode]
            # Of several with these nodal lines: the one nearest to the guess.
            hits.sort(key=lambda i: abs(np.sqrt(one.values[i]) / (2 * np.pi) - (near or 0.0)))
            out.append(np.array(hits[:1], dtype=np.int64))
        if not any(o.size for o in out):
            seen = ", ".join(str(label) for one in found for label in one.labels if label)
            raise InputError(
                f"no mode {mode} was found near {near:.0f} Hz (there are {seen}); solve near "
                "another frequency",
                quantity="mode",
            )
        return out
    if band is not None:
        return [np.arange(f.size) for f in frequencies]
    every = sorted(
        (
            (abs(f - (near or 0.0)), c, i)
            for c, fs in enumerate(frequencies)
            for i, f in enumerate(fs)
        )
    )[:count]
    return [np.array(sorted(i for _, k, i in every if k == c), dtype=np.int64)
            for c in range(len(found))]  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Piece:
    """The refined modes of one class."""

    found: _Found
    index: IntArray
    solved: SolvedModel
    coarse_values: FloatArray
    values: FloatArray
    vectors: FloatArray
    level: int


def _refined(
    plate: RectangularPlate,
    one: _Found,
    index: IntArray,
    highest: float,
    levels: list[tuple[Resolution, Resolution]],
    tolerance: float,
) -> _Piece:
    solved, values, vectors = one.solved, one.values[index], one.vectors[:, index]
    for level, (_, resolution) in enumerate(levels):
        built = plate_model(plate, highest, resolution, one.parity)
        slabs = Slabs(built.model)
        finer = SolvedModel(plate, built, slabs)
        start = prolonged(solved.slabs, slabs, vectors)
        # Just below the coarse values, where the finer ones are expected.
        shift = float(np.mean(values)) * (1 - 2e-3)
        factor = SlabFactor(slabs, shift)
        solve = _solver(slabs, finer, factor)

        def wanted(found: FloatArray, size: int = values.size, at: FloatArray = values) -> IntArray:
            picked: list[int] = []
            for value in at:
                order = np.argsort(np.abs(found - value * (1 - 2e-3)))
                picked.append(next((int(i) for i in order if int(i) not in picked), -1))
            return np.array([i for i in picked if i >= 0][:size])

        pairs = modes_near(
            slabs, solve, shift, wanted, start, tolerance=min(1e-6, 1e-3 * tolerance)
        )
        # Neighbours may change places between two meshes: pair them by shape, not by order, or
        # each would get the other's energy shares and error.
        order = _partners(slabs, start, pairs.vectors)
        index, values, vectors = index[order], values[order], vectors[:, order]
        piece = _Piece(one, index, finer, values, pairs.values, pairs.vectors, level)
        _, error = _extrapolated(piece.coarse_values, piece.values, piece.level)
        worst = np.max(error / (np.sqrt(piece.values) / (2 * np.pi)))
        if worst <= tolerance or level == len(levels) - 1:
            return piece
        solved, values, vectors = finer, pairs.values, pairs.vectors
    raise AssertionError("no level was solved")


def _partners(slabs: Slabs, coarse: FloatArray, fine: FloatArray) -> IntArray:
    """For each fine mode the coarse one (prolonged to the fine mesh) that moves most alike."""
    mass = slabs.mass_times(fine)
    size = np.sqrt(np.sum(coarse * slabs.mass_times(coarse), axis=0))
    alike = (coarse.T @ mass / size[:, None]) ** 2
    rows, columns = linear_sum_assignment(-alike)
    return np.asarray(rows[np.argsort(columns)], dtype=np.int64)


def _extrapolated(
    coarse: FloatArray, fine: FloatArray, level: int
) -> tuple[FloatArray, FloatArray]:
    """Frequencies extrapolated from two meshes, and their estimated errors (Hz)."""
    a, b = np.sqrt(coarse) / (2 * np.pi), np.sqrt(fine) / (2 * np.pi)
    share, doubt = EXTRAPOLATION[level], UNCERTAINTY[level]
    return b - share * (a - b), doubt * np.abs(a - b) + _FLOOR * b


def _collected(
    plate: RectangularPlate,
    pieces: list[_Piece],
    tolerance: float,
    band: tuple[float, float] | None,
) -> PlateModes:
    rows = []
    x = y = np.zeros(0)
    signs = drive_signs(plate)
    for piece in pieces:
        frequency, error = _extrapolated(piece.coarse_values, piece.values, piece.level)
        scale = 1 / np.sqrt(piece.solved.built.copies)
        vectors = piece.vectors * scale
        x, y, surface = _surface(piece.solved, vectors)
        G, _ = piece.solved.slabs.electrode_columns
        built = piece.solved.built
        per_electrode = -(G.T @ vectors).T
        own = np.array(built.sign_of) * np.array(built.share_of)
        forces = per_electrode[:, list(built.electrode_of)] * own[None, :]
        # Ratios need few digits: they are taken from the coarse mesh.
        rough, some = piece.found, piece.found.vectors[:, piece.index]
        shares, losses = _shares(rough.solved.slabs, some)
        known = rough.values[piece.index]
        opened = _open_values(rough, known, some) / known
        for i in range(frequency.size):
            top = surface[i]
            turn = 1.0
            driven = float(forces[i] @ signs)
            # The sign of a mode is free: the drive pushes it up, or its largest value does.
            largest = top[:, :, 2].flat[int(np.argmax(np.abs(top[:, :, 2])))]
            if driven < -1e-9 or (abs(driven) <= 1e-9 and largest < 0):
                turn = -1.0
            rows.append(
                (
                    frequency[i], error[i], np.sqrt(piece.values[i]) / (2 * np.pi),
                    label_of(top, x, y), piece.found.parity, turn * top[:, :, 2],
                    turn * forces[i], abs(driven), frequency[i] * np.sqrt(opened[i]),
                    shares[i], 1 / max(float(shares[i] @ losses), 1e-30),
                    (piece.solved, turn * vectors[:, i]),
                )
            )  # fmt: skip
    if band is not None:
        rows = [row for row in rows if band[0] <= row[0] <= band[1]]
    if not rows:
        low, high = band or (0.0, 0.0)
        raise InputError(
            f"no mode lies between {low:.6g} Hz and {high:.6g} Hz; widen the band, or ask for the "
            "modes near a frequency",
            quantity="band",
        )
    rows.sort(key=lambda row: row[0])
    columns = list(zip(*rows, strict=True))
    frequencies, errors = np.array(columns[0]), np.array(columns[1])
    opened_f = np.array(columns[8])
    over = int(np.sum(errors > tolerance * frequencies))
    status = (
        f"all {len(rows)} modes within {tolerance:.1e} (estimated)"
        if over == 0
        else f"{over} of {len(rows)} modes have an estimated error above {tolerance:.1e}; the "
        "finest mesh was used"
    )
    media = pieces[0].solved.built.model
    names = [m.name for m in media.media] + (["supports"] if media.foundations else [])
    return PlateModes(
        plate=plate,
        frequencies=frequencies,
        errors=errors,
        mesh_frequencies=np.array(columns[2]),
        labels=columns[3],
        parities=columns[4],
        x=x,
        y=y,
        shapes=np.stack(columns[5]),
        modal_forces=np.stack(columns[6]),
        drive_forces=np.array(columns[7]),
        open_frequencies=opened_f,
        couplings=np.sqrt(np.maximum(0.0, 1 - (frequencies / opened_f) ** 2)),
        quality_factors=np.array(columns[10]),
        materials=tuple(names),
        energy_shares=np.stack(columns[9]),
        model=MODEL,
        status=status,
        unknowns=max(piece.solved.slabs.unknowns for piece in pieces),
        _fields=columns[11],
    )
