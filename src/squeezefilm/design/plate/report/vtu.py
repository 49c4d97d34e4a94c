"""A solved plate as a .vtu file for ParaView: shape, response and potential in the volume."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.errors import InputError, optional
from squeezefilm.core.results import write_whole

if TYPE_CHECKING:
    from squeezefilm.core.quantities import FloatArray, Volt
    from squeezefilm.physics.plate.solid.modes import PlateModes
    from squeezefilm.physics.plate.solid.response import HarmonicResponse
    from squeezefilm.physics.plate.solid.volume import PlateVolume

LARGEST_DISPLACEMENT = 1e-6
"""The largest displacement (m) that a mode shape is scaled to in the file."""


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
