"""Discs and annuli against analysis (Kirchhoff, thin piezoelectric disc), against their own
convergence, and against three-dimensional elements in Cartesian axes (scikit-fem)."""

import dataclasses
import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy import sparse, special
from scipy.linalg import det
from scipy.optimize import brentq
from scipy.sparse.linalg import LinearOperator, eigsh, splu, spsolve

from squeezefilm.core.errors import GeometryError, InputError, UnreachableError
from squeezefilm.core.materials import ElasticMaterial
from squeezefilm.physics.plate.elements.box_model import Medium, isotropic_solid, piezoceramic_solid
from squeezefilm.physics.plate.layout import DiscPlate
from squeezefilm.physics.plate.ring.body import (
    HARD_PZT,
    PHOSPHOR_BRONZE,
    StatorAssumptions,
    fit_stator,
    stator_section,
)
from squeezefilm.physics.plate.ring.elements import harmonic_system
from squeezefilm.physics.plate.ring.modes import (
    annular_admittance,
    annular_modes,
    bending_frequency,
    bending_mode,
    clamped_capacitance,
)
from squeezefilm.physics.plate.ring.section import (
    AnnularSection,
    RingLayer,
    SectorDrive,
    alternate_sectors,
    bonded_disc,
    full_drive,
    soft_teeth,
    stiff_teeth,
)

STEEL = ElasticMaterial("steel", 200e9, 0.3, 7800.0)
MEAN_DIAMETER, WIDTH = 53.57e-3, 6.43e-3
INNER, OUTER = (MEAN_DIAMETER - WIDTH) / 2, (MEAN_DIAMETER + WIDTH) / 2


def plain(inner: float, outer: float, thickness: float, material: ElasticMaterial = STEEL) -> Any:
    return AnnularSection((RingLayer(inner, outer, 0.0, thickness, isotropic_solid(material)),))


# --- thin plates: Kirchhoff -----------------------------------------------------------------


def _kirchhoff_root(n: int, poisson: float, hole: float, low: float, high: float) -> float:
    """λ = k R of a free plate with n diameters and a hole of radius `hole` × R (0 for none).

    w = (A Jn + B In + C Yn + D Kn)(kr) cos nθ with M_r = V_r = 0 at the edges (Leissa, NASA
    SP-160, eq 1.8 and 1.9). Computed with scaled columns.
    """
    functions: list[tuple[Callable[..., Any], float]] = [(special.jvp, -1.0), (special.ivp, 1.0)]
    if hole > 0:
        functions += [(special.yvp, -1.0), (special.kvp, 1.0)]

    def residual(k: float) -> float:
        rows = []
        for r in (1.0,) if hole == 0 else (1.0, hole):
            moment, shear = [], []
            for f, sign in functions:
                w, d1 = f(n, k * r, 0), k * f(n, k * r, 1)
                laplace = sign * k**2 * w  # ∇²w = ∓k² w
                d_laplace = sign * k**2 * d1
                d2 = laplace - d1 / r + n**2 * w / r**2
                moment.append(d2 + poisson * (d1 / r - n**2 * w / r**2))
                shear.append(d_laplace - (1 - poisson) * n**2 / r**2 * (d1 - w / r))
            rows += [moment, shear]
        matrix = np.array(rows, dtype=float)
        return float(det(matrix / np.abs(matrix).max(axis=0)))

    grid = np.linspace(low, high, 400)
    values = np.array([residual(k) for k in grid])
    first = np.flatnonzero(np.diff(np.sign(values)))[0]
    return float(brentq(residual, grid[first], grid[first + 1], xtol=1e-13))


def _kirchhoff_frequency(root: float, radius: float, h: float, m: ElasticMaterial) -> float:
    stiffness = m.plane_strain_modulus * h**3 / 12
    return root**2 / (2 * math.pi * radius**2) * math.sqrt(stiffness / (m.density * h))


def test_tabulated_roots_of_the_free_disc() -> None:
    """Leissa, NASA SP-160, table 2.5 (ν = 1/3: 5.253, 12.23, 9.084) and the case ν = 0.3."""
    assert _kirchhoff_root(2, 1 / 3, 0, 1.5, 3) ** 2 == pytest.approx(5.253, abs=1e-2)
    assert _kirchhoff_root(3, 1 / 3, 0, 2.5, 4) ** 2 == pytest.approx(12.23, abs=2e-2)
    assert _kirchhoff_root(0, 1 / 3, 0, 2, 4) ** 2 == pytest.approx(9.084, abs=1e-2)
    assert _kirchhoff_root(2, 0.3, 0, 1.5, 3) ** 2 == pytest.approx(5.3583, abs=1e-4)


@pytest.mark.parametrize(
    ("n", "label", "low", "high"),
    [(2, "B(0,2)", 1.5, 3), (3, "B(0,3)", 2.5, 4), (0, "B(1,0)", 2, 4), (1, "B(1,1)", 3, 5)],
)
def test_thin_disc_tends_to_kirchhoff(n: int, label: str, low: float, high: float) -> None:
    root = _kirchhoff_root(n, 0.3, 0, low, high)
    radius, gaps = 0.05, []
    for h in (1e-3, 0.5e-3, 0.25e-3):
        mode = bending_mode(plain(0, radius, h), n, int(label[2]), quality_factor=100)
        gaps.append(1 - mode.frequency / _kirchhoff_frequency(root, radius, h, STEEL))
    # Below Kirchhoff by an amount of first order in h/R (the Kirchhoff edge) or higher.
    assert 0 < gaps[2] < gaps[1] < gaps[0] < 8e-3
    assert gaps[1] / gaps[2] > 1.8
    assert abs(2 * gaps[2] - gaps[1]) < 4e-4


@pytest.mark.parametrize("n", [2, *(pytest.param(n, marks=pytest.mark.slow) for n in (3, 5))])
def test_thin_annulus_tends_to_kirchhoff(n: int) -> None:
    root = _kirchhoff_root(n, 0.3, 0.5, 0.8 * n, 2.2 * n)
    gaps = []
    for h in (0.5e-3, 0.25e-3):
        mode = bending_mode(plain(0.025, 0.05, h), n, quality_factor=100)
        gaps.append(1 - mode.frequency / _kirchhoff_frequency(root, 0.05, h, STEEL))
    assert 0 < gaps[1] < gaps[0] < 1e-2
    assert abs(2 * gaps[1] - gaps[0]) < 8e-4


# --- the discretisation ---------------------------------------------------------------------


def with_web(section: AnnularSection, thickness: float, inner_radius: float) -> AnnularSection:
    """A stator with a web of its metal inwards, level with the ring's lower face."""
    ring = section.layers[1]
    top = ring.bottom + thickness
    web = RingLayer(inner_radius, ring.inner_radius, ring.bottom, top, ring.solid)
    return dataclasses.replace(section, layers=(*section.layers, web))


@pytest.fixture(scope="module")
def stator() -> AnnularSection:
    section = stator_section(MEAN_DIAMETER, 2.5e-3, StatorAssumptions(), "soft")
    return with_web(section, 0.6e-3, 15e-3)


@pytest.mark.slow
def test_rigid_body_modes_are_at_zero(stator: AnnularSection) -> None:
    disc = plain(0, 0.02, 1e-3)
    for section in (stator, disc):
        for harmonic in (0, 1):
            modes = annular_modes(section, harmonic, count=4, quality_factor=100)
            assert [mode.is_rigid for mode in modes] == [True, True, False, False]
            assert modes[0].frequency == 0
        assert not annular_modes(section, 2, count=2, quality_factor=100)[0].is_rigid
    with pytest.raises(InputError, match="rigid"):
        annular_modes(disc, 0, count=2, quality_factor=9)[0].amplitude_per_volt(full_drive())


def test_a_rigid_motion_costs_no_energy() -> None:
    system = harmonic_system(plain(0, 0.02, 1e-3), 1, 4)
    vector = np.zeros(system.displacements)
    # Rotation about a diameter: u_z = r cos θ, u_r = −z cos θ, u_θ = z sin θ.
    for k, values in enumerate([-system.z, system.z, system.r]):
        rows = system.unknown[:, k]
        vector[rows[rows >= 0]] = (values * system.sign[:, k])[rows >= 0]
    stiff = abs(system.matrix[: vector.size, : vector.size])
    assert np.abs(system.matrix[: vector.size, : vector.size] @ vector).max() < 1e-9 * float(
        (stiff @ np.abs(vector)).max()
    )


def test_p_convergence_of_a_plain_ring_is_exponential() -> None:
    section = plain(INNER, OUTER, 3e-3, PHOSPHOR_BRONZE)
    best = bending_mode(section, 9, degree=11, quality_factor=100).frequency
    errors = [
        bending_mode(section, 9, degree=p, quality_factor=100).frequency / best - 1
        for p in (3, 4, 5, 6, 7)
    ]
    assert all(0 < b < a for a, b in itertools.pairwise(errors))
    assert errors[2] < 1e-4
    assert errors[4] < 5e-6


@pytest.mark.slow
def test_error_estimate_is_honest(stator: AnnularSection) -> None:
    best = annular_modes(stator, 9, count=4, degree=9)
    for degree in (4, 5, 6):
        for mode, exact in zip(annular_modes(stator, 9, count=4, degree=degree), best, strict=True):
            error = mode.frequency - exact.frequency
            assert -1e-6 * exact.frequency < error < mode.frequency_error + 1e-6 * exact.frequency
    assert annular_modes(stator, 9)[0].frequency_error < 1e-3 * best[0].frequency


# --- piezoelectricity -----------------------------------------------------------------------


def test_thin_piezoelectric_disc_in_its_radial_mode() -> None:
    """Resonance and capacitance of a thin disc in plane stress (IEEE Std 176-1987, §6.4.2)."""
    radius, h = 10e-3, 0.1e-3
    ceramic = HARD_PZT
    solid = piezoceramic_solid(ceramic)
    assert solid.stress_matrix is not None
    assert solid.permittivity is not None
    section = AnnularSection((RingLayer(0, radius, 0, h, solid),))
    nu, c_p = ceramic.in_plane_poisson_ratio, ceramic.in_plane_stiffness
    e_p = ceramic.effective_stress_coefficient
    c, e = solid.stiffness, solid.stress_matrix
    epsilon = solid.permittivity[2, 2] + e[2, 2] ** 2 / c[2, 2]  # free across the thickness
    nu = 4.78 / 16.5
    root = brentq(lambda x: x * special.j0(x) - (1 - nu) * special.j1(x), 1.5, 2.5)
    expected = root / (2 * math.pi * radius) * math.sqrt(c_p / ceramic.density)
    # B(8,0) of so thin a disc lies 20 Hz beside it.
    radial = [m for m in annular_modes(section, 0, near=expected, count=3) if m.label == "R(0)"]
    assert [m.frequency for m in radial] == pytest.approx([expected], rel=1e-4)
    low = np.array([expected / 50])
    y = annular_admittance(section, full_drive(), low, harmonics=[0], quality_factor=1e6)
    # A free disc: ε33T = ε33_p + 2 e_p d31, d31 = e_p (s11 + s12) = e_p / (c_p (1 + ν)).
    omega = 2 * math.pi * low[0]
    capacitance = (epsilon + 2 * e_p**2 / (c_p * (1 + nu))) * math.pi * radius**2 / h
    assert y[0].imag / omega == pytest.approx(capacitance, rel=2e-3)


@pytest.mark.slow
def test_admittance_by_modes_is_the_direct_solution(stator: AnnularSection) -> None:
    drive, q = alternate_sectors(8, math.pi / 9), 200.0
    mode = bending_mode(stator, 9, degree=4)
    assert bending_frequency(stator, 9, degree=4) == pytest.approx(mode.frequency, rel=1e-9)
    assert mode.quality_factor == pytest.approx(q, rel=1e-6)
    frequency = mode.frequency * np.array([0.9, 0.999, 1.0, 1.002, 1.1])
    got = annular_admittance(stator, drive, frequency, harmonics=[9], quality_factor=q, degree=4)
    system = harmonic_system(stator, 9, 4)
    n, size = system.displacements, system.matrix.shape[0]
    mass = system.mass.copy()
    mass.resize((size, size))
    force = np.zeros(size)
    force[:n] = system.force
    for f, y in zip(frequency, got, strict=True):
        omega = 2 * math.pi * f
        motion = spsolve((system.matrix * (1 + 1j / q) - omega**2 * mass).tocsc(), force)
        charge = clamped_capacitance(stator, drive) + abs(drive.coefficient(9)) ** 2 * (
            force @ motion
        )
        assert y == pytest.approx(1j * omega * charge, rel=2e-3)
    # Energy: the conductance at resonance dissipates what the amplitude per volt does.
    omega = 2 * math.pi * mode.frequency
    loss = omega**3 * mode.modal_mass / q * mode.amplitude_per_volt(drive) ** 2
    assert got[2].real == pytest.approx(loss, rel=2e-2)  # the rest: loss in the other modes


@pytest.mark.slow
def test_short_circuit_is_softer_than_open(stator: AnnularSection) -> None:
    drive = alternate_sectors(18, math.pi / 9)
    mode = bending_mode(stator, 9)
    held = clamped_capacitance(stator, drive)
    # Beside a mode the others add to the held capacitance: taken 10 % above it, less its own.
    beside = np.array([1.1 * mode.frequency])
    y = annular_admittance(stator, drive, beside, harmonics=[9], quality_factor=1e6)
    stiffness = (2 * math.pi * mode.frequency) ** 2 * mode.modal_mass
    own = mode.modal_force(drive) ** 2 / stiffness / (1 - 1.1**2)
    static = float(y[0].imag / (2 * math.pi * beside[0])) - own
    assert held < static < 1.6 * held
    k = mode.coupling_coefficient(drive, static)
    assert 0.02 < k < mode.coupling_coefficient(drive, held) < 0.4
    frequency = mode.frequency * np.linspace(1 + 1e-4, 1 + 2 * k**2, 4001)
    y = annular_admittance(stator, drive, frequency, harmonics=[9], quality_factor=1e6)
    antiresonance = frequency[np.argmin(np.abs(y))]
    assert antiresonance / mode.frequency == pytest.approx(1 / math.sqrt(1 - k**2), rel=2e-3)


# --- drives ---------------------------------------------------------------------------------


def test_fourier_coefficients_of_sectors() -> None:
    assert abs(alternate_sectors(18, math.pi / 9).coefficient(9)) == pytest.approx(4.0)
    assert abs(alternate_sectors(8, math.pi / 9).coefficient(9)) == pytest.approx(16 / 9)
    assert abs(alternate_sectors(18, math.pi / 9).coefficient(8)) == pytest.approx(0, abs=1e-12)
    assert full_drive().coefficient(0) == pytest.approx(2 * math.pi)
    uneven = SectorDrive(((0.1, 0.4, 1), (0.5, 1.3, -1)))
    theta = np.linspace(0, 2 * math.pi, 200001)
    s = 1.0 * ((theta > 0.1) & (theta < 0.4)) - 1.0 * ((theta > 0.5) & (theta < 1.3))
    direct = np.trapezoid(s * np.exp(-5j * theta), theta)
    assert uneven.coefficient(5) == pytest.approx(direct, abs=1e-4)


def test_bad_rings_are_refused() -> None:
    solid = isotropic_solid(STEEL)
    a = RingLayer(0, 1e-2, 0, 1e-3, solid)
    with pytest.raises(InputError, match="quality_factor"):
        annular_modes(AnnularSection((a,)), 2)
    with pytest.raises(InputError, match="no layer is piezoelectric"):
        clamped_capacitance(AnnularSection((a,)), full_drive())
    with pytest.raises(GeometryError, match="overhangs"):
        bonded_disc(DiscPlate(1e-2, 1e-3, 50.0, STEEL, HARD_PZT, 2e-2, 1e-3))


# --- the two devices ------------------------------------------------------------------------


@pytest.mark.slow
def test_stator_fitted_to_what_the_paper_gives() -> None:
    fit = fit_stator()
    assert fit.mode.frequency == pytest.approx(40.5e3, rel=1e-6)
    assert fit.mode.label == "B(0,9)"
    assert fit.mode.frequency == pytest.approx(40.5e3, rel=1e-6)
    assert fit.section.mean_diameter == pytest.approx(53.57e-3, rel=1e-4)
    assert fit.mode.half_wavelength == pytest.approx(18.7e-3 / 2, rel=1e-9)
    assert 2e-3 < fit.ring_thickness < 4e-3
    low, high = fit.frequency_bounds
    assert low == pytest.approx(40.5e3, rel=1e-6)
    assert high > low
    assert 0.1e-6 < 140 * fit.mode.amplitude_per_volt(fit.drive) < 50e-6
    smooth = fit_stator(assumptions=StatorAssumptions(tooth_height=0.0))
    assert smooth.frequency_bounds[0] == smooth.frequency_bounds[1]
    with pytest.raises(UnreachableError, match="no ring thickness"):
        fit_stator(frequency=400e3)


def test_glass_disc_display() -> None:
    """A 25 mm glass disc on a ceramic of 16 mm, in its umbrella mode (the T-PaD's)."""
    glass = ElasticMaterial("borosilicate", 63e9, 0.2, 2230.0)
    section = bonded_disc(DiscPlate(25e-3, 1.6e-3, 50.0, glass, HARD_PZT, 16e-3, 0.76e-3))
    mode = bending_mode(section, 0, circles=1)
    assert 20e3 < mode.frequency < 60e3
    assert mode.frequency_error < 1e-3 * mode.frequency
    assert mode.half_wavelength is None
    assert mode.amplitude_per_volt(full_drive()) > 1e-9
    # The centre and the rim move against each other, one nodal circle between.
    assert mode.surface_shape[0] * mode.surface_shape[-1] < 0


# --- three dimensions, in Cartesian axes ----------------------------------------------------


def _skfem() -> Any:
    return pytest.importorskip(
        "skfem",
        reason="scikit-fem is no dependency; install it to compare with three-dimensional elements",
    )


def sector_frequencies(
    radii: Any,
    angles: Any,
    heights: Any,
    m: int,
    solid_at: Callable[[float, float, float], Medium | None],
    count: int = 2,
) -> Any:
    """Frequencies from quadratic hexahedra of a quarter wave, θ = 0…π/2m, of a mode cos mθ.

    Symmetric about θ = 0 and antisymmetric about θ = π/2m. Electrodes (the faces of piezoelectric
    cells in z) are earthed. `solid_at` gives the solid at a cell's centre, or None for a hole.
    """
    skfem = _skfem()
    from skfem.helpers import grad, sym_grad

    box = skfem.MeshHex.init_tensor(radii, angles, heights)
    centre = box.p[:, box.t].mean(axis=1)
    solids = [solid_at(*point) for point in centre.T]
    keep = np.array([k for k, s in enumerate(solids) if s is not None])
    solids = [solids[k] for k in keep]
    box = box.restrict(keep)
    curved = skfem.MeshHex2.from_mesh(box)
    r, theta, z = curved.doflocs
    mesh = skfem.MeshHex2(np.vstack([r * np.cos(theta), r * np.sin(theta), z]), curved.t)
    element = skfem.ElementVector(skfem.ElementHex2())
    basis = skfem.Basis(mesh, element, intorder=6)
    # z-poled and isotropic solids look the same in Cartesian axes.
    voigt = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    c = np.stack([s.stiffness for s in solids])
    rho = np.array([s.density for s in solids])[:, None]

    def strain(u: Any) -> list[Any]:
        e = sym_grad(u)
        return [e[i, j] if i == j else 2 * e[i, j] for i, j in voigt]

    @skfem.BilinearForm
    def elastic(u: Any, v: Any, w: Any) -> Any:
        su, sv = strain(u), strain(v)
        total = 0.0
        for i in range(6):
            for j in range(6):
                if np.any(c[:, i, j]):
                    total = total + c[:, i, j][:, None] * su[j] * sv[i]
        return total

    @skfem.BilinearForm
    def inertia(u: Any, v: Any, w: Any) -> Any:
        return rho * sum(u[k] * v[k] for k in range(3))

    K, M = elastic.assemble(basis).tocsr(), inertia.assemble(basis).tocsr()
    X = basis.doflocs
    n = K.shape[0]
    component = np.empty(n, dtype=int)
    for k, name in enumerate(["u^1", "u^2", "u^3"]):
        component[basis.get_dofs(elements=True).all([name])] = k
    angle, end = np.arctan2(X[1], X[0]), math.pi / (2 * m)
    first, last = np.abs(angle) < 1e-9, np.abs(angle - end) < 1e-9
    held = (first & (component == 1)) | (last & (component == 2))
    free = np.flatnonzero(~held & ~(last & (component == 0)))
    # On the node plane only u_θ is left: u_x = −sin, u_y = cos of it.
    place = {
        tuple(np.round(X[:, q], 9)): k for k, q in enumerate(free) if last[q] and component[q] == 1
    }
    slaves = np.flatnonzero(last & (component == 0))
    rows = [*free, *slaves]
    columns = [*range(free.size), *(place[tuple(np.round(X[:, q], 9))] for q in slaves)]
    entries = [math.cos(end) if last[q] and component[q] == 1 else 1.0 for q in free]
    entries += [-math.sin(end)] * slaves.size
    T = sparse.coo_matrix((entries, (rows, columns)), shape=(n, free.size)).tocsr()
    K, M = (T.T @ K @ T).tocsc(), (T.T @ M @ T).tocsc()
    electric = np.array([k for k, s in enumerate(solids) if s.piezoelectric])
    if electric.size:
        scalar = skfem.Basis(mesh, skfem.ElementHex2(), intorder=6, elements=electric)
        vector = skfem.Basis(mesh, element, intorder=6, elements=electric)
        solid = solids[electric[0]]

        @skfem.BilinearForm
        def coupling(u: Any, p: Any, w: Any) -> Any:
            su, dp = strain(u), grad(p)
            return sum(
                solid.stress_matrix[k, i] * su[i] * dp[k]
                for k in range(3)
                for i in range(6)
                if solid.stress_matrix[k, i]
            )

        @skfem.BilinearForm
        def dielectric(u: Any, p: Any, w: Any) -> Any:
            return sum(solid.permittivity[k, k] * grad(u)[k] * grad(p)[k] for k in range(3))

        G, D = coupling.assemble(vector, scalar).tocsr(), dielectric.assemble(scalar).tocsr()
        Y = scalar.doflocs
        inside = np.unique(scalar.element_dofs[:, electric])
        faces = [centre[2, keep[electric]].min(), centre[2, keep[electric]].max()]
        low = max(h for h in heights if h < faces[0])
        high = min(h for h in heights if h > faces[1])
        loose = (np.abs(Y[2] - low) > 1e-9) & (np.abs(Y[2] - high) > 1e-9)
        loose &= np.abs(np.arctan2(Y[1], Y[0]) - end) > 1e-9
        inside = inside[loose[inside]]
        G, D = G[inside] @ T, D[inside][:, inside]
        factors = splu(sparse.bmat([[K, G.T], [G, -D]]).tocsc())
        silent = np.zeros(D.shape[0])
    else:
        factors, silent = splu(K), np.zeros(0)
    inverse = LinearOperator(
        K.shape,
        matvec=lambda b: factors.solve(np.concatenate([b.ravel(), silent]))[: K.shape[0]],
        dtype=float,
    )
    squares = eigsh(K, k=count, M=M, sigma=0.0, OPinv=inverse, return_eigenvectors=False)
    return np.sort(np.sqrt(squares)) / (2 * math.pi)


@pytest.mark.slow
def test_plain_ring_against_scikit_fem() -> None:
    _skfem()
    solid = isotropic_solid(PHOSPHOR_BRONZE)
    h = 3e-3
    theirs = sector_frequencies(
        np.linspace(INNER, OUTER, 6),
        np.linspace(0, math.pi / 18, 7),
        np.linspace(0, h, 4),
        9,
        lambda r, t, z: solid,
    )
    section = plain(INNER, OUTER, h, PHOSPHOR_BRONZE)
    ours = [mode.frequency for mode in annular_modes(section, 9, count=2, quality_factor=100)]
    assert ours == pytest.approx(theirs, rel=1e-3)
    assert np.all(np.array(ours) < theirs)  # both are upper bounds; ours is the tighter


@pytest.mark.nightly
def test_whole_ring_against_scikit_fem() -> None:
    """No Fourier harmonics on their side at all: every elastic mode of a whole ring, in pairs."""
    skfem = _skfem()
    from skfem.helpers import ddot, dot, sym_grad, trace

    m, h, around = STEEL, 3e-3, 64
    box = skfem.MeshHex.init_tensor(
        np.linspace(INNER, OUTER, 4), np.linspace(0, 2 * math.pi, around + 1), np.linspace(0, h, 3)
    )
    curved = skfem.MeshHex2.from_mesh(box)
    r, theta, z = curved.doflocs
    mesh = skfem.MeshHex2(np.vstack([r * np.cos(theta), r * np.sin(theta), z]), curved.t)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex2()), intorder=6)
    lame = m.young_modulus * m.poisson_ratio / (1 + m.poisson_ratio) / (1 - 2 * m.poisson_ratio)

    @skfem.BilinearForm
    def elastic(u: Any, v: Any, w: Any) -> Any:
        e, d = sym_grad(u), sym_grad(v)
        return lame * trace(e) * trace(d) + 2 * m.shear_modulus * ddot(e, d)

    @skfem.BilinearForm
    def inertia(u: Any, v: Any, w: Any) -> Any:
        return m.density * dot(u, v)

    K, M = elastic.assemble(basis), inertia.assemble(basis)
    # Sew the cut: unknowns at the same place (and of the same component) are one.
    component = np.empty(K.shape[0])
    for k, name in enumerate(["u^1", "u^2", "u^3"]):
        component[basis.get_dofs(elements=True).all([name])] = k
    place = np.round(np.vstack([basis.doflocs, component * 1e3]) * 1e8).astype(np.int64)
    _, same = np.unique(place, axis=1, return_inverse=True)
    same = same.ravel()
    T = sparse.coo_matrix((np.ones(same.size), (np.arange(same.size), same))).tocsr()
    K, M = (T.T @ K @ T).tocsc(), (T.T @ M @ T).tocsc()
    shift = -((2 * math.pi * 300.0) ** 2)
    squares = np.sort(eigsh(K, k=16, M=M, sigma=shift, return_eigenvectors=False))
    theirs = np.sqrt(squares[6:]) / (2 * math.pi)
    assert abs(squares[5]) < 1e-4 * squares[6]
    section = plain(INNER, OUTER, h)
    ours = [
        mode.frequency
        for n in range(8)
        for mode in annular_modes(section, n, count=4, quality_factor=100)
        for _ in range(2 if n else 1)
        if not mode.is_rigid
    ]
    gaps = theirs / np.sort(ours)[:10] - 1
    assert gaps.max() < 1e-3, gaps
    assert gaps.min() > 0, gaps


def _with_ceramic(web_thickness: float) -> AnnularSection:
    assumptions = StatorAssumptions(tooth_height=0.0, quality_factor=100.0)
    section = stator_section(MEAN_DIAMETER, 2.5e-3, assumptions, "soft")
    return with_web(section, web_thickness, INNER - 3e-3) if web_thickness else section


def _filled(section: AnnularSection) -> Callable[[float, float, float], Medium | None]:
    def solid_at(r: float, t: float, z: float) -> Medium | None:
        for layer in section.layers:
            if layer.inner_radius < r < layer.outer_radius and layer.bottom < z < layer.top:
                return layer.solid
        return None

    return solid_at


@pytest.mark.slow
def test_ring_with_ceramic_against_scikit_fem() -> None:
    _skfem()
    section = _with_ceramic(0.0)
    theirs = sector_frequencies(
        INNER + np.array([0, 0.4, 1.6, 3.2, 4.8, 6.03, 6.43]) * 1e-3,
        np.linspace(0, math.pi / 18, 5),
        np.array([0, 0.5, 0.9, 1.9, 3]) * 1e-3,
        9,
        _filled(section),
        count=1,
    )
    ours = bending_mode(section, 9)
    assert ours.frequency == pytest.approx(theirs[0], rel=5e-4)
    assert ours.frequency < theirs[0]


@pytest.mark.nightly
def test_stepped_ring_with_ceramic_against_scikit_fem() -> None:
    """With a web inwards: two re-entrant corners, to which both meshes are graded."""
    _skfem()
    section = _with_ceramic(0.8e-3)
    theirs = sector_frequencies(
        INNER + np.array([-3, -1, -0.2, -0.04, 0, 0.04, 0.2, 1, 2.5, 4.5, 6.43]) * 1e-3,
        np.linspace(0, math.pi / 18, 6),
        np.array([0, 0.25, 0.44, 0.5, 0.56, 0.9, 1.24, 1.3, 1.36, 1.7, 2.3, 3]) * 1e-3,
        9,
        _filled(section),
        count=1,
    )
    ours = bending_mode(section, 9)
    assert ours.frequency == pytest.approx(theirs[0], rel=1e-3)
    assert ours.frequency < theirs[0]


@pytest.mark.nightly
def test_real_teeth_lie_between_the_bounds() -> None:
    """72 teeth of 80 % fill, modelled one by one: two of them in a quarter wave of B(0,9)."""
    _skfem()
    solid, h, tooth = isotropic_solid(PHOSPHOR_BRONZE), 2.5e-3, 1.5e-3
    degree = math.pi / 180
    angles = np.array([0, 0.5, 1.5, 2.5, 3.5, 4.5, 5, 5.5, 6.5, 7.5, 8.5, 9.5, 10]) * degree

    def solid_at(r: float, t: float, z: float) -> Medium | None:
        return solid if z < h or 0.5 * degree < t % (5 * degree) < 4.5 * degree else None

    real = sector_frequencies(
        np.linspace(INNER, OUTER, 4),
        angles,
        np.array([0, 1.0e-3, 2e-3, h, h + 0.4e-3, h + tooth]),
        9,
        solid_at,
        count=1,
    )[0]
    bounds = []
    for teeth in (soft_teeth, stiff_teeth):
        layer = RingLayer(INNER, OUTER, h, h + tooth, teeth(solid, 0.8))
        section = AnnularSection((RingLayer(INNER, OUTER, 0, h, solid), layer))
        bounds.append(bending_mode(section, 9, quality_factor=100).frequency)
    assert bounds[0] < real < bounds[1], (bounds, real)
    # The soft bound is the near one.
    assert real - bounds[0] < 0.2 * (bounds[1] - bounds[0])
