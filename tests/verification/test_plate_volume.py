"""The .vtu of a solved plate, read back: geometry, materials, shapes and potentials."""

import dataclasses
from pathlib import Path

import meshio
import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline

from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import ElasticMaterial
from squeezefilm.design.plate.report.page import LARGEST_DISPLACEMENT, write_vtu
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import CeramicPatch, GlueLayer, RectangularPlate
from squeezefilm.physics.plate.solid.modes import PlateModes
from squeezefilm.physics.plate.solid.response import HarmonicResponse, harmonic_response
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.volume import harmonic_fields, mode_fields, plate_volume

Solved = tuple[PlateModes, HarmonicResponse]


def _paper() -> RectangularPlate:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    return plate


def _small(**changes: object) -> RectangularPlate:
    """Two ceramics that touch each other, one of them poled the other way."""
    patches = (
        CeramicPatch(8e-3, 0.0, 10e-3, 20e-3, 1e-3, polarity=1),
        CeramicPatch(18e-3, 0.0, 6e-3, 20e-3, 1e-3, polarity=1, poling=-1),
    )
    plate = RectangularPlate(
        40e-3, 20e-3, 1.5e-3, 3, 60.0, ElasticMaterial("steel", 200e9, 0.3, 7800.0),
        _paper().ceramic, patches,
    )  # fmt: skip
    return dataclasses.replace(plate, **changes)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def paper() -> Solved:
    modes = solve_modes(_paper())
    f = float(modes.frequencies[0])
    return modes, harmonic_response(_paper(), np.linspace(0.995 * f, 1.005 * f, 11))


@pytest.fixture(scope="module")
def read_back(paper: Solved, tmp_path_factory: pytest.TempPathFactory) -> meshio.Mesh:
    modes, response = paper
    file = tmp_path_factory.mktemp("vtu") / "mode.vtu"
    assert write_vtu(file, modes, 0, response=response, voltage=15.0) == file
    assert [path.name for path in file.parent.iterdir()] == ["mode.vtu"]
    return meshio.read(file)


def _volumes(mesh: meshio.Mesh) -> dict[int, float]:
    corners = mesh.points[mesh.cells_dict["hexahedron"]]
    # The triple product of the edges at the first corner: negative for a cell turned inside out.
    edges = corners[:, [1, 3, 4]] - corners[:, :1]
    volume = np.linalg.det(edges)
    assert volume.min() > 0
    material = mesh.cell_data["material"][0]
    return {int(k): float(volume[material == k].sum()) for k in np.unique(material)}


@pytest.mark.slow
def test_volumes_per_material_add_up_to_the_plate(read_back: meshio.Mesh) -> None:
    volumes = _volumes(read_back)
    names = {n: int(v[0]) for n, v in read_back.field_data.items() if n.startswith("material_")}
    assert volumes[names["material_substrate"]] == pytest.approx(83e-3 * 49e-3 * 2e-3, rel=1e-12)
    assert volumes[names["material_ceramic_bottom"]] == pytest.approx(
        7 * 11e-3 * 49e-3 * 1e-3, rel=1e-12
    )
    assert len(volumes) == 2


@pytest.mark.slow
def test_surface_moves_as_the_solver_says(read_back: meshio.Mesh, paper: Solved) -> None:
    modes, response = paper
    top = np.isclose(read_back.points[:, 2], 2e-3)
    x, y = read_back.points[top, 0], read_back.points[top, 1]
    moved = read_back.point_data["mode_displacement_m"]
    scale = float(read_back.field_data["mode_scale_m_sqrt_kg"][0])
    # The solver's own grid is another one: interpolated to the points of the file.
    shape = RectBivariateSpline(modes.x, modes.y, modes.shapes[0], kx=5, ky=5)(x, y, grid=False)
    assert moved[top, 2] == pytest.approx(scale * shape, abs=1e-3 * LARGEST_DISPLACEMENT)
    assert np.linalg.norm(moved, axis=1).max() == pytest.approx(LARGEST_DISPLACEMENT)
    at = response.resonance
    some = np.flatnonzero(top)[::97]
    for n in some:
        px, py = read_back.points[n, :2]
        w = 15.0 * response.displacement(np.array([px]), np.array([py]))[at, 0, 0]
        assert read_back.point_data["displacement_real_m"][n, 2] == pytest.approx(w.real, rel=1e-9)
        assert read_back.point_data["displacement_imaginary_m"][n, 2] == pytest.approx(
            w.imag, rel=1e-9
        )


@pytest.mark.slow
def test_electrodes_have_the_drives_potential(read_back: meshio.Mesh) -> None:
    potential = read_back.point_data["potential_real_V"]
    imaginary = read_back.point_data["potential_imaginary_V"]
    x, z = read_back.points[:, 0], read_back.points[:, 2]
    assert np.all(potential[z > -1e-9] == 0)
    for patch in _paper().patches:
        face = np.isclose(z, -1e-3) & (x > patch.x - 1e-9) & (x < patch.x + patch.length + 1e-9)
        assert potential[face] == pytest.approx(15.0 * patch.polarity, abs=1e-9)
        assert imaginary[face] == pytest.approx(0.0, abs=1e-9)
        shape = read_back.point_data["mode_potential_V"]
        assert shape[face] == pytest.approx(0.0, abs=1e-12 * np.abs(shape).max() + 1e-12)


@pytest.mark.slow
def test_a_slow_voltage_falls_evenly_through_the_ceramic() -> None:
    plate = _small()
    modes = solve_modes(plate)
    response = harmonic_response(plate, np.array([500.0, 1000.0]))
    volume = plate_volume(modes, 0)
    _, potential = harmonic_fields(volume, response, 0)
    x, y, z = volume.points.T
    # Away from its rim, and but for its free ends' strain, a plate capacitor.
    inside = (np.abs(y - 10e-3) < 6e-3) & (z < 1e-12) & (np.abs(x - 13e-3) < 3e-3)
    assert inside.sum() > 20
    assert potential[inside].real == pytest.approx(-z[inside] / 1e-3, abs=0.08)
    # The other ceramic is poled the other way and has the same polarity: the same potential.
    other = (np.abs(x - 21e-3) < 2e-3) & np.isclose(z, -1e-3)
    assert potential[other].real == pytest.approx(1.0)


@pytest.mark.slow
def test_touching_ceramics_keep_their_own_potential() -> None:
    patches = tuple(
        dataclasses.replace(p, polarity=s, poling=1)
        for p, s in zip(_small().patches, (1, -1), strict=True)
    )
    plate = _small(patches=patches)
    volume = plate_volume(solve_modes(plate), 0)
    response = harmonic_response(plate, np.array([500.0, 1000.0]))
    _, potential = harmonic_fields(volume, response, 0)
    at_face = np.isclose(volume.points[:, 0], 18e-3) & np.isclose(volume.points[:, 2], -1e-3)
    assert set(np.round(potential[at_face].real, 9)) == {1.0, -1.0}


def test_open_electrode_carries_one_potential_and_no_charge() -> None:
    """The open electrode's potential is the one at which the mode is a mode: with it the reciprocal
    theorem makes the drive-open frequency of the shorted plate that of the open one."""
    opened = tuple(dataclasses.replace(p, electrode="open") for p in _small().patches)
    modes = solve_modes(_small(patches=opened))
    volume = plate_volume(modes, 0)
    _, potential = mode_fields(volume, modes, 0)
    x, _, z = volume.points.T
    for patch in opened:
        inside = (x > patch.x + 1e-9) & (x < patch.x + patch.length - 1e-9)
        face = potential[np.isclose(z, -1e-3) & inside]
        assert np.ptp(face) < 1e-9 * np.abs(face).max()
        # The mean field through the ceramic is that of the electrode: not all in the dielectric.
        assert abs(face[0]) > 0.01 * np.abs(potential).max()


@pytest.mark.slow
def test_glue_and_a_plate_longer_across(tmp_path: Path) -> None:
    small = _small(glue=GlueLayer(50e-6, 3e9))
    turned = dataclasses.replace(
        small, length=20e-3, width=40e-3,
        patches=tuple(
            dataclasses.replace(p, x=p.y, y=p.x, length=p.width, width=p.length)
            for p in small.patches
        ),
    )  # fmt: skip
    shapes = []
    for plate, near in ((small, None), (turned, None)):
        del near
        modes = solve_modes(plate, near=9e3, count=1)
        file = write_vtu(tmp_path / "plate.vtu", modes, 0)
        mesh = meshio.read(file)
        volumes = _volumes(mesh)
        assert volumes[0] == pytest.approx(40e-3 * 20e-3 * 1.5e-3, rel=1e-9)
        assert volumes[1] == pytest.approx(16e-3 * 20e-3 * 1e-3, rel=1e-9)
        assert volumes[3] == pytest.approx(16e-3 * 20e-3 * 50e-6, rel=1e-9)
        w = mesh.point_data["mode_displacement_m"]
        shapes.append((modes.frequencies[0], np.abs(w[:, 2]).max(), np.abs(w[:, 0]).max()))
    assert shapes[0][0] == pytest.approx(shapes[1][0], rel=1e-4)
    assert shapes[0][1] == pytest.approx(shapes[1][1], rel=1e-3)
    # What moved along x moves along y now.
    assert shapes[0][2] != pytest.approx(shapes[1][2], rel=0.1)


@pytest.mark.slow
def test_several_modes_each_in_its_file(tmp_path: Path) -> None:
    modes = solve_modes(_small(), band=(3e3, 30e3))
    assert modes.count >= 3
    for mode in range(modes.count):
        write_vtu(tmp_path / f"mode-{mode}.vtu", modes, mode)
    read = [meshio.read(tmp_path / f"mode-{mode}.vtu") for mode in range(modes.count)]
    written = [float(mesh.field_data["mode_frequency_Hz"][0]) for mesh in read]
    assert written == pytest.approx(list(modes.frequencies), rel=1e-12)


def test_nothing_half_written(tmp_path: Path, paper: Solved) -> None:
    modes, _ = paper
    with pytest.raises(InputError, match=r"\.vtu"):
        write_vtu(tmp_path / "mode.vtk", modes, 0)
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(InputError, match="cannot write"):
        write_vtu(tmp_path / "file" / "mode.vtu", modes, 0)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
