"""Refined modes of all classes of symmetry gathered, signed and sorted: what is returned."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.plate.elements.box_model import Medium
from squeezefilm.plate.elements.slabs import Slabs
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.solid.electrode_circuits import open_values, shunted_frequencies
from squeezefilm.plate.solid.model import PlateModel
from squeezefilm.plate.solid.modes import (
    MODEL,
    Label,
    PlateModes,
    label_of,
    surface_shapes,
)
from squeezefilm.plate.solid.refined_modes import RefinedModes, extrapolated
from squeezefilm.plate.solid.symmetry import Symmetry, drive_signs


def energy_shares_of(slabs: Slabs, vectors: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
    """The share of each medium, and of springs, in a mode's elastic energy (modes × media), and the
    loss factor that these shares and each medium's and spring's own loss make."""
    model = slabs.model
    energy, lost = [], []
    used = set(np.unique(model.medium).tolist())
    for number, medium in enumerate(model.media):
        if number not in used:
            energy.append(np.zeros(vectors.shape[1]))
            lost.append(energy[-1])
            continue

        def only(other: Medium, own: Medium = medium) -> tuple[float, float]:
            return float(other is own), 0.0

        sections = slabs.weighted_sections(only, springs=0.0)
        energy.append(np.sum(vectors * slabs.stiffness_times(vectors, sections), axis=0))
        lost.append(energy[-1] * medium.loss)
    if model.foundations:
        for total, springs in ((energy, 1.0), (lost, model.spring_losses)):
            sections = slabs.weighted_sections(lambda m: (0.0, 0.0), springs=springs)
            total.append(np.sum(vectors * slabs.stiffness_times(vectors, sections), axis=0))
    table, whole = np.stack(energy, axis=1), np.sum(energy, axis=0)
    return table / whole[:, None], np.sum(lost, axis=0) / whole


def collected_modes(
    plate: RectangularPlate,
    pieces: list[RefinedModes],
    tolerance: float,
    band: tuple[float, float] | None,
) -> PlateModes:
    """The modes of all classes in ascending order, those outside a band left out.

    Raises `InputError` where none is left.
    """
    rows: list[_Mode] = []
    x = y = np.zeros(0)
    signs = drive_signs(plate)
    for piece in pieces:
        x, y, found = _modes_of(piece, signs)
        rows += found
    if band is not None:
        rows = [row for row in rows if band[0] <= row.frequency <= band[1]]
    if not rows:
        low, high = band or (0.0, 0.0)
        raise InputError(
            f"no mode lies between {low:.6g} Hz and {high:.6g} Hz; widen the band, or ask for the "
            "modes near a frequency",
            quantity="band",
        )
    rows.sort(key=lambda row: row.frequency)
    frequencies = np.array([row.frequency for row in rows])
    errors = np.array([row.error for row in rows])
    opened = np.array([row.open_frequency for row in rows])
    over = int(np.sum(errors > tolerance * frequencies))
    media = pieces[0].solved.model
    names = [m.name for m in media.media] + (["supports"] if media.foundations else [])
    return PlateModes(
        plate=plate,
        frequencies=frequencies,
        errors=errors,
        mesh_frequencies=np.array([row.mesh_frequency for row in rows]),
        labels=tuple(row.label for row in rows),
        parities=tuple(row.parity for row in rows),
        x=x,
        y=y,
        shapes=np.stack([row.shape for row in rows]),
        modal_forces=np.stack([row.forces for row in rows]),
        drive_forces=np.array([row.drive_force for row in rows]),
        open_frequencies=opened,
        couplings=np.sqrt(np.maximum(0.0, 1 - (frequencies / opened) ** 2)),
        quality_factors=np.array([row.quality_factor for row in rows]),
        materials=tuple(names),
        energy_shares=np.stack([row.energy_shares for row in rows]),
        model=MODEL,
        status=(
            f"all {len(rows)} modes within {tolerance:.1e} (estimated)"
            if over == 0
            else f"{over} of {len(rows)} modes have an estimated error above {tolerance:.1e}; the "
            "finest mesh was used"
        ),
        unknowns=max(piece.solved.slabs.unknowns for piece in pieces),
        _fields=tuple(row.field for row in rows),
    )


class _Mode(NamedTuple):
    """One mode, as `PlateModes` has many."""

    frequency: float
    error: float
    mesh_frequency: float
    label: Label | None
    parity: Symmetry
    shape: si.FloatArray
    forces: si.FloatArray
    drive_force: float
    open_frequency: float
    energy_shares: si.FloatArray
    quality_factor: float
    field: tuple[PlateModel, si.FloatArray]


def _modes_of(
    piece: RefinedModes, signs: si.FloatArray
) -> tuple[si.FloatArray, si.FloatArray, list[_Mode]]:
    """The modes of one class, and x and y of their shapes; `signs` are those of the drive."""
    frequency, error = extrapolated(piece.coarse_values, piece.values, piece.level)
    scale = 1 / np.sqrt(piece.solved.copies)
    vectors = piece.vectors * scale
    x, y, surface = surface_shapes(piece.solved, vectors)
    G, _ = piece.solved.slabs.electrode_columns
    built = piece.solved
    per_electrode = -(G.T @ vectors).T
    own = np.array(built.sign_of) * np.array(built.share_of)
    forces = per_electrode[:, list(built.electrode_of)] * own[None, :]
    # Ratios need few digits: they are taken from the coarse mesh.
    rough, some = piece.found, piece.found.vectors[:, piece.index]
    shares, losses = energy_shares_of(rough.solved.slabs, some)
    omega = shunted_frequencies(piece.solved, piece.factor, piece.values, piece.vectors)
    shunted = omega.real / np.sqrt(piece.values)
    frequency, error = frequency * shunted, error * shunted
    losses = losses + 2 * omega.imag / omega.real
    known = rough.values[piece.index]
    opened = open_values(rough.solved, rough.factor, rough.shift, known, some) / known
    modes = []
    for i in range(frequency.size):
        top = surface[i]
        driven = float(forces[i] @ signs)
        turn = _turn(top, driven)
        mode = _Mode(
            frequency=frequency[i],
            error=error[i],
            mesh_frequency=np.sqrt(piece.values[i]) / (2 * np.pi),
            label=label_of(top, x, y),
            parity=piece.found.parity,
            shape=turn * top[:, :, 2],
            forces=turn * forces[i],
            drive_force=abs(driven),
            open_frequency=frequency[i] / shunted[i] * np.sqrt(opened[i]),
            energy_shares=shares[i],
            quality_factor=1 / max(float(losses[i]), 1e-30),
            field=(piece.solved, turn * vectors[:, i]),
        )
        modes.append(mode)
    return x, y, modes


def _turn(top: si.FloatArray, driven: float) -> float:
    """The sign of a mode is free: the drive pushes it up, or its largest value does."""
    largest = top[:, :, 2].flat[int(np.argmax(np.abs(top[:, :, 2])))]
    return -1.0 if driven < -1e-9 or (abs(driven) <= 1e-9 and largest < 0) else 1.0
