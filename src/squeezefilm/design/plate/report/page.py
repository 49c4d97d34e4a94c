"""Files that `squeezefilm plate --out` writes: a page with numbers and figures, and the volume as a
.vtu file for ParaView: shape, response and potential."""

from __future__ import annotations

import tempfile
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.errors import InputError, optional
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.numbers import NUMBERS, M, V, printable, shown
from squeezefilm.core.kit.page_style import (
    Pictures,
    drawn_figures,
    page,
    picture_files,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.core.results import write_whole
from squeezefilm.design.plate.command import PlateAnalysis
from squeezefilm.design.plate.report.figures import PLATE_FIGURES, RING_FIGURES
from squeezefilm.design.plate.report.terminal import (
    drive_rows,
    fit_sentences,
    mode_rows,
    working_rows,
)
from squeezefilm.design.plate.ring import RingAnalysis

if TYPE_CHECKING:
    from squeezefilm.core.quantities import FloatArray, Volt
    from squeezefilm.design.plate.solved import SolvedBody
    from squeezefilm.physics.plate.solid.modes import PlateModes
    from squeezefilm.physics.plate.solid.response import HarmonicResponse
    from squeezefilm.physics.plate.solid.volume import PlateVolume

_VOLUME = """ The solved volume for ParaView:
<a href="mode.vtu">mode.vtu</a> (warp by <code>mode_displacement_m</code>, scaled to 1 µm at its
largest)."""
LARGEST_DISPLACEMENT = 1e-6
"""The largest displacement (m) that a mode shape is scaled to in the file."""


def plate_page(result: SolvedBody, figures: Pictures) -> str:
    """The text of index.html; figures (heading and drawing) are the PNG files beside it by name."""
    title = escape(printable(result.display.title))
    body = (
        section("Working mode", _numbers(result))
        + picture_sections(figures)
        + section("Modes in the band, each alone at its antinode", _modes(result))
    )
    volume = _VOLUME if isinstance(result, PlateAnalysis) else ""
    stamp = stamped(result.summary()["provenance"], "description SHA-256")
    return page(
        f"{title}: solved plate",
        title,
        f"<code>{escape(printable(result.display.name))}</code>, plate solved by squeezefilm",
        body,
        f'{stamp}.\nNumbers: <a href="plate.json">plate.json</a>.{volume}',
    )


def _numbers(result: SolvedBody) -> str:
    volts = result.display.drive.voltage
    rows = working_rows(result)
    amplitude = shown(volts * result.amplitude_per_volt, M, 3)
    rows.append((f"Amplitude at {shown(volts, V)}", amplitude, "zero-to-peak, at the antinode"))
    table = text_table(result.model, NUMBERS, rows + drive_rows(result))
    fit = result.body.fit if isinstance(result, RingAnalysis) else None
    said = (*(() if fit is None else fit_sentences(fit)), *result.objections, *result.heat.doubts)
    return table + "".join(f"<p>{escape(sentence)}</p>" for sentence in said)


def _modes(result: SolvedBody) -> str:
    rows = [
        (label, frequency, f"± {error}", *rest)
        for label, frequency, error, *rest in mode_rows(result.rows, result.amplitude_per_volt)
    ]
    head = ("Mode", "Frequency", "Error", "Q", "Per volt", "Coupling")
    return text_table(result.status, head, rows)


def write_plate(result: SolvedBody, folder: Path) -> Path:
    """Write what a solved plate, disc or stator gives into `folder`: index.html, plate.json and one
    PNG a figure; of a rectangular plate mode.vtu for ParaView too. The page's path.

    Everything is made before anything is written.
    """
    kinds = RING_FIGURES if isinstance(result, RingAnalysis) else PLATE_FIGURES
    figures = drawn_figures(kinds, result)
    files = picture_files(figures)
    files["plate.json"] = json_text(result.summary())
    files["index.html"] = plate_page(result, figures)
    if isinstance(result, PlateAnalysis):
        write_mode(result, folder / "mode.vtu")
    return write_folder(folder, files)


def write_mode(result: PlateAnalysis, file: Path) -> Path:
    """Write the working mode and its response at the display's voltage as .vtu; the file."""
    return write_vtu(
        file,
        result.solid.modes,
        result.solid.index,
        response=result.response,
        at=result.resonance,
        voltage=result.display.drive.voltage,
    )


def write_vtu(
    path: Path,
    modes: PlateModes,
    mode: int,
    *,
    response: HarmonicResponse | None = None,
    at: int | None = None,
    voltage: Volt = 0.0,
) -> Path:
    """Write one mode, and the harmonic response for a voltage amplitude, as .vtu.

    The response is that at its frequency number `at`, without one where it moves most.

    Point data: ``mode_displacement_m`` and ``mode_potential_V`` (real, the largest displacement
    scaled to 1 µm), with a `response` also ``displacement_real_m``, ``displacement_imaginary_m``,
    ``potential_real_V`` and ``potential_imaginary_V`` at `voltage`. Cell data: ``material``. Field
    data: ``mode_scale_m_sqrt_kg`` (what the mode of unit modal mass was multiplied by),
    frequencies, voltage and the number of every material. The file is written whole or not at
    all. Raises `InputError` for a name that does not end in .vtu.
    """
    from squeezefilm.physics.plate.solid.volume import harmonic_fields, mode_fields, plate_volume

    if path.suffix != ".vtu":
        raise InputError(f"{path} does not end in .vtu; ParaView tells the format by the ending")
    volume = plate_volume(modes, mode)
    moved, charged = mode_fields(volume, modes, mode)
    scale = LARGEST_DISPLACEMENT / float(np.max(np.linalg.norm(moved, axis=1)))
    points: dict[str, FloatArray] = {
        "mode_displacement_m": scale * moved,
        "mode_potential_V": scale * charged,
    }
    notes = {
        "mode_frequency_Hz": float(modes.frequencies[mode]),
        "mode_scale_m_sqrt_kg": scale,
    }
    if response is not None:
        at = response.resonance if at is None else at
        u, potential = (voltage * part for part in harmonic_fields(volume, response, at))
        points |= {
            "displacement_real_m": u.real,
            "displacement_imaginary_m": u.imag,
            "potential_real_V": potential.real,
            "potential_imaginary_V": potential.imag,
        }
        notes |= {"drive_frequency_Hz": float(response.frequencies[at]), "drive_voltage_V": voltage}
    notes |= {f"material_{name}": float(number) for number, name in enumerate(volume.materials)}
    write_whole(path, _vtu(volume, points, notes))
    return path


def _vtu(volume: PlateVolume, points: dict[str, FloatArray], notes: dict[str, float]) -> bytes:
    with optional("design", "a VTU file"):
        import meshio

    mesh: Any = meshio.Mesh(
        volume.points,
        [("hexahedron", volume.cells)],
        point_data={name: np.ascontiguousarray(values) for name, values in points.items()},
        cell_data={"material": [volume.material]},
    )
    # meshio writes to a name only; what it wrote is then put in place whole.
    with tempfile.TemporaryDirectory() as folder:
        draft = Path(folder) / "plate.vtu"
        mesh.write(draft, file_format="vtu")
        text = draft.read_bytes()
    # meshio reads field data of this format but writes none.
    field = "".join(
        f'<DataArray type="Float64" Name="{name}" NumberOfTuples="1" format="ascii">'
        f"{value!r}</DataArray>"
        for name, value in notes.items()
    )
    head = b"<UnstructuredGrid>"
    return text.replace(head, head + f"<FieldData>{field}</FieldData>".encode(), 1)
