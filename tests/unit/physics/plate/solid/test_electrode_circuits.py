"""Circuits at electrodes: open and shunted, against bordered solves, limits and first order."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.elements.slab_modes import (
    SlabFactor,
    modes_near,
    with_open_electrodes,
)
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.solid.coarse_modes import (
    CoarseModes,
    coarse_modes,
    inverse_with_open,
    open_values,
    shunted_frequencies,
)
from squeezefilm.physics.plate.solid.reduced import open_electrodes
from squeezefilm.physics.plate.solid.symmetry import Parity

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)
NEAR = 11.6e3


@functools.cache
def solved_plate(
    *patches: CeramicPatch, parity: tuple[Parity | None, Parity | None] = (None, "S")
) -> CoarseModes:
    plate = RectangularPlate(24e-3, 14e-3, 1.2e-3, 3, 60, GLASS, CERAMIC, patches)
    return coarse_modes(plate, parity, NEAR, 14e3, None, 1)


DRIVEN = CeramicPatch(2e-3, 0, 8e-3, 14e-3, 0.5e-3)


def sensing(electrode: str, resistance: float | None = None) -> CoarseModes:
    """A driven ceramic on the left, and one of another length on the right that senses."""
    patch = CeramicPatch(
        14e-3, 0, 6e-3, 14e-3, 0.5e-3, electrode=electrode,  # type: ignore[arg-type]
        shunt_resistance=resistance,
    )  # fmt: skip
    return solved_plate(DRIVEN, patch)


def value_with(one: CoarseModes, *columns: tuple[float, float]) -> float:
    """ω² with these combinations of electrodes open, found afresh by iteration."""
    slabs = one.solved.slabs
    solve = with_open_electrodes(slabs, one.factor.solve, np.array(columns).T)
    shift = one.factor.shift
    return float(modes_near(slabs, solve, shift, None, one.vectors, tolerance=1e-10).values[0])


def shunted(one: CoarseModes) -> complex:
    return complex(shunted_frequencies(one.solved, one.factor, one.values, one.vectors)[0])


def opened(one: CoarseModes) -> float:
    values = open_values(one.solved, one.factor, one.values, one.vectors)
    assert values.shape == one.values.shape
    return float(values[0])


def test_mirror_images_share_an_electrode_that_an_odd_class_does_not_have() -> None:
    pair = [
        CeramicPatch(x, 0, 6e-3, 14e-3, 0.5e-3, sign, electrode="open")
        for x, sign in ((2e-3, 1), (16e-3, -1))
    ]
    centre = CeramicPatch(10e-3, 0, 4e-3, 14e-3, 0.5e-3, electrode="open")
    even, odd = (
        solved_plate(*pair, centre, parity=(p, "S")).solved  # type: ignore[arg-type]
        for p in ("S", "A")
    )
    for solved, count in ((even, 2), (odd, 1)):
        columns = open_electrodes(solved)
        assert columns.shape == (2, count)
        assert np.all(columns.sum(axis=0) == 1)
    assert open_electrodes(sensing("shorted").solved).shape == (2, 0)


@pytest.mark.parametrize("sign", [1, -1])
def test_an_open_drive_raises_the_mode_as_its_own_iteration_finds(sign: int) -> None:
    # Both ceramics at the same terminals, or the second the other way round.
    one = solved_plate(DRIVEN, CeramicPatch(14e-3, 0, 6e-3, 14e-3, 0.5e-3, sign))
    exact = value_with(one, (1.0, float(sign)))
    assert exact > 1.00007 * one.values[0]
    assert opened(one) == pytest.approx(exact, rel=1e-7)
    # An electrode that is shorted is no terminal.
    held = sensing("shorted")
    assert opened(held) == pytest.approx(value_with(held, (1.0, 0.0)), rel=1e-7)


def test_an_open_sensor_is_open_from_the_start() -> None:
    short, free = sensing("shorted"), sensing("open")
    assert free.values[0] == pytest.approx(value_with(short, (0.0, 1.0)), rel=1e-6)
    assert free.values[0] > 1.0002 * short.values[0]
    # And stays open beside the drive, each by itself.
    assert opened(free) == pytest.approx(value_with(short, (1.0, 0.0), (0.0, 1.0)), rel=1e-7)
    # A shunt is short for the modes that this starts from; the drive is the left electrode alone.
    assert sensing("shunted", 1.0).values[0] == pytest.approx(short.values[0], rel=1e-9)
    assert opened(sensing("shunted", 1.0)) == pytest.approx(value_with(short, (1.0, 0.0)), rel=1e-7)


def test_without_open_electrodes_the_inverse_is_the_factor_s() -> None:
    one = sensing("shorted")
    assert inverse_with_open(one.solved, one.factor) == one.factor.solve
    free = sensing("open")
    slabs = free.solved.slabs
    solve = inverse_with_open(free.solved, free.factor)
    bordered = with_open_electrodes(slabs, free.factor.solve, np.array([[0.0], [1.0]]))
    right = slabs.mass_times(free.vectors)
    assert solve(right) == pytest.approx(bordered(right), rel=1e-12)


def test_a_mode_that_the_drive_does_not_move_is_left_as_it_is() -> None:
    one = sensing("shorted")
    none = one.values[:0], one.vectors[:, :0]
    assert open_values(one.solved, one.factor, *none).size == 0
    assert shunted_frequencies(one.solved, one.factor, *none).size == 0
    # Two like ceramics driven against each other move no mode that is even along x.
    pair = [CeramicPatch(x, 0, 6e-3, 14e-3, 0.5e-3, sign) for x, sign in ((2e-3, 1), (16e-3, -1))]
    even = solved_plate(*pair, parity=("S", "S"))
    assert opened(even) == even.values[0]
    assert shunted(even) == pytest.approx(np.sqrt(even.values[0]))
    assert shunted(one) == pytest.approx(np.sqrt(one.values[0]))


def test_shunts_reach_from_short_to_open() -> None:
    short, free = sensing("shorted"), sensing("open")
    low, high = shunted(sensing("shunted", 1e-3)), shunted(sensing("shunted", 1e12))
    assert low == pytest.approx(np.sqrt(short.values[0]), rel=1e-6)
    assert high.real == pytest.approx(np.sqrt(free.values[0]), rel=1e-6)
    assert abs(high.imag) < 1e-5 * high.real


def test_a_small_shunt_damps_with_the_square_of_its_force() -> None:
    one = sensing("shunted", 1.0)
    G, _ = one.solved.slabs.electrode_columns
    force = float(G[:, 1] @ one.vectors[:, 0])
    # ω² gains iωR f², with the whole ceramic's charge: the class has half of it.
    assert one.solved.share_of[1] == 2.0
    omega = shunted(one)
    assert omega.imag == pytest.approx(1.0 * 2.0 * force**2 / 2, rel=1e-3)
    assert omega.imag > 0
    assert omega.real == pytest.approx(np.sqrt(one.values[0]), rel=1e-6)


@pytest.mark.parametrize("resistance", [300.0, 30e3])
def test_the_complex_frequency_satisfies_the_circuit(resistance: float) -> None:
    one = sensing("shunted", resistance)
    omega = shunted(one)
    slabs = one.solved.slabs
    G, C = slabs.electrode_columns
    column = G[:, 1:2].astype(complex)
    answer = SlabFactor(slabs, omega**2).solve(column)  # type: ignore[arg-type]
    # x = −(K − ω²M)⁻¹ G V and V = iωR q with the charge q = Gᵀx + C V, for half of the ceramic.
    z = 1j * omega * resistance * 2.0
    rest = 1 - z * C[1, 1] + z * (column.T @ answer)[0, 0]
    assert abs(rest) < 1e-3 * abs(z * (column.T @ answer)[0, 0])
    assert omega.imag > 1e-5 * omega.real


def test_an_open_neighbour_is_open_while_a_shunt_works() -> None:
    third = CeramicPatch(10.5e-3, 0, 3e-3, 14e-3, 0.5e-3, electrode="open")
    shunt = CeramicPatch(14e-3, 0, 6e-3, 14e-3, 0.5e-3, electrode="shunted", shunt_resistance=1e12)
    one = solved_plate(DRIVEN, shunt, third)
    slabs = one.solved.slabs
    solve = with_open_electrodes(slabs, one.factor.solve, np.eye(3)[:, 1:])
    exact = modes_near(slabs, solve, one.factor.shift, None, one.vectors, tolerance=1e-10).values[0]
    assert exact > 1.0002 * one.values[0]
    assert shunted(one).real == pytest.approx(np.sqrt(exact), rel=1e-6)
