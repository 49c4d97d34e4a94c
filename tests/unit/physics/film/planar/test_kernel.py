"""The compiled residual of a planar film and its Jacobian, against flows and differences."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.physics.film.gas import CompiledGas
from squeezefilm.physics.film.mobility import mobility
from squeezefilm.physics.film.planar.balance import (
    Balances,
    Storage,
    assemble,
    row_block,
    take_off,
)
from squeezefilm.physics.film.planar.grid import Faces

RNG = np.random.default_rng(5)
ROWS, COLUMNS, M = 3, 2, 3
NODES = ROWS * COLUMNS
# A face within each row; edges at three nodes.
EDGES = np.array([0, 4, 5])


def some(*shape: int) -> np.ndarray:
    return 0.8 + 0.5 * RNG.random(shape)


H, H_ROW, H_COLUMN, H_EDGE = some(NODES, M), some(NODES - COLUMNS, M), some(3, M), some(3, M)
GAPS = np.concatenate([H, H_ROW, H_COLUMN, H_EDGE])
ROW_G, COLUMN_G, EDGE_G, WEIGHT = some(NODES - COLUMNS), some(3), some(3), some(NODES)
D = RNG.normal(size=(M, M))
GAS = some(NODES, M)
FACES, STORAGE = Faces(COLUMNS, ROW_G, COLUMN_G, EDGES, EDGE_G), Storage(WEIGHT, D)
LAWS = [(1.0, 0.0, 0), (1.4, 0.0, 0), (1.2, 0.1, 2)]


def assembled(m: np.ndarray, law: tuple[float, float, int]) -> Balances:
    out = Balances(*(np.full((size, M), np.nan) for size in (NODES, NODES, 4, 4, 3, 3)))
    assemble(m, GAPS, FACES, STORAGE, CompiledGas(*law), out)
    return out


def balance(m: np.ndarray, law: tuple[float, float, int]) -> np.ndarray:
    """Inflow less the gas stored, face by face."""
    P = (m / H) ** law[0]
    out = -WEIGHT[:, None] * (m @ D.T)
    faces = [(g, g + COLUMNS, ROW_G[g], H_ROW[g]) for g in range(NODES - COLUMNS)]
    faces += [(2 * g, 2 * g + 1, COLUMN_G[g], H_COLUMN[g]) for g in range(ROWS)]
    for a, b, G, h in faces:
        for k in range(M):
            flow = G * mobility(h[k], (P[a, k] + P[b, k]) / 2, *law)[0] * (P[b, k] - P[a, k])
            out[a, k] += flow
            out[b, k] -= flow
    for g, a in enumerate(EDGES):
        for k in range(M):
            ease = mobility(H_EDGE[g, k], (P[a, k] + 1) / 2, *law)[0]
            out[a, k] += EDGE_G[g] * ease * (1 - P[a, k])
    return np.asarray(out)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_the_residual_is_what_flows_in_less_what_is_stored(law: tuple[float, float, int]) -> None:
    assert assembled(GAS, law)[0] == pytest.approx(balance(GAS, law), rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("law", LAWS)
def test_the_jacobian_is_the_derivative_of_the_residual(law: tuple[float, float, int]) -> None:
    slopes = assembled(GAS, law)
    size, block_size = NODES * M, COLUMNS * M
    found = np.zeros((size, size))
    for row in range(ROWS):
        block = np.full((block_size, block_size), np.nan)
        nodes = slice(row * COLUMNS, (row + 1) * COLUMNS)
        up, down = slopes.column_up[row : row + 1], slopes.column_down[row : row + 1]
        row_block(WEIGHT[nodes], D, slopes.diagonal[nodes], up, down, block)
        at = slice(row * block_size, (row + 1) * block_size)
        found[at, at] = block
    for face in range(NODES - COLUMNS):
        for k in range(M):
            lower, upper = face * M + k, (face + COLUMNS) * M + k
            found[lower, upper] = slopes.row_up[face, k]
            found[upper, lower] = slopes.row_down[face, k]
    step = 1e-6
    for column in range(size):
        shift = np.zeros(size)
        shift[column] = step
        apart = shift.reshape(NODES, M)
        slope = (balance(GAS + apart, law) - balance(GAS - apart, law)).ravel() / (2 * step)
        assert found[:, column] == pytest.approx(slope, abs=2e-8)


def test_gas_at_rest_under_a_still_gap_flows_nowhere() -> None:
    residual = assembled(H.copy(), (1.4, 0.0, 0))[0]
    assert residual == pytest.approx(-WEIGHT[:, None] * (H @ D.T), abs=1e-13)


def test_a_row_takes_its_part_off_the_next() -> None:
    block, inverse = RNG.normal(size=(2, 4, 4))
    down, up = RNG.normal(size=(2, 4))
    expected = block - np.diag(down) @ inverse @ np.diag(up)
    take_off(block, down, inverse, up)
    assert block == pytest.approx(expected)
