"""The compiled march: one implicit stage against its own balance, the schemes against tanh."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.film.gas import Aim, Gas
from squeezefilm.physics.film.mobility import mobility
from squeezefilm.physics.film.transient.kernel import (
    BACKWARD_EULER,
    BDF2,
    SDIRK2,
    Gaps,
    Line,
    Pace,
    Track,
    implicit_stage,
    march,
)

RNG = np.random.default_rng(3)
N = 5
H, H_FACE = 1 + 0.3 * RNG.random(N), 1 + 0.3 * RNG.random(N + 1)
VOLUME = 0.5 + RNG.random(N)
HELD = 1 + 0.5 * RNG.random(N)
ISOTHERMAL = Gas(1.0, 0.0, 0)


def inflows(m: np.ndarray, conductance: np.ndarray, n: float, kn: float, law: int) -> np.ndarray:
    """The flow to the left through every face, between cells and the ambient gas at both ends."""
    P = np.concatenate([[1.0], (m / H) ** n, [1.0]])
    ease = [
        mobility(h, (a + b) / 2, n, kn, law)[0]
        for h, a, b in zip(H_FACE, P[:-1], P[1:], strict=True)
    ]
    return np.asarray(conductance * np.array(ease) * np.diff(P))


@pytest.mark.parametrize("walls", [(), (0,), (N,), (0, N)])
@pytest.mark.parametrize(("n", "kn", "law"), [(1.0, 0.0, 0), (1.4, 0.0, 0), (1.2, 0.1, 2)])
def test_a_stage_balances_what_is_held_and_what_flows(
    walls: tuple[int, ...], n: float, kn: float, law: int
) -> None:
    conductance = 1 + RNG.random(N + 1)
    conductance[list(walls)] = 0.0
    m, outflow = H.copy(), np.full(2, np.nan)
    change, count = implicit_stage(
        m, HELD, Gaps(H, H_FACE), Line(VOLUME, conductance), 0.4, Gas(n, kn, law), Aim(1e-12, 20),
        outflow,
    )  # fmt: skip
    flow = 0.4 * inflows(m, conductance, n, kn, law)
    assert VOLUME * (m - HELD) == pytest.approx(np.diff(flow), abs=1e-11)
    assert outflow == pytest.approx([flow[0], -flow[-1]], abs=1e-11)
    assert VOLUME @ (HELD - m) == pytest.approx(outflow.sum(), abs=1e-11)
    for end in walls:
        assert outflow[min(end, 1)] == 0.0
    # Newton's method proper: its steps square the error.
    assert change <= 1e-9
    assert count <= 6


def test_a_stage_that_stops_early_says_how_far_it_was() -> None:
    conductance, outflow = np.ones(N + 1), np.zeros(2)
    m = 3 * H

    def once(limit: int, tolerance: float = 1e-12) -> tuple[float, int]:
        return implicit_stage(
            m, HELD, Gaps(H, H_FACE), Line(VOLUME, conductance), 0.4, ISOTHERMAL,
            Aim(tolerance, limit), outflow,
        )  # fmt: skip

    before = m.copy()
    change, count = once(1)
    assert count == 1
    assert change == pytest.approx(np.abs(m / before - 1).max())
    assert change > 0.1
    assert once(20, 0.5)[1] < 3
    # What is beyond numbers is given up at once.
    m[:] = 1e-310
    assert once(20) == (np.inf, 1)


def test_a_step_never_empties_a_cell() -> None:
    m, outflow = np.full(1, 100.0), np.zeros(2)
    one = np.ones(1)
    change, _ = implicit_stage(
        m, 0.01 * one, Gaps(one, np.ones(2)), Line(one, np.zeros(2)), 1.0, ISOTHERMAL,
        Aim(1e-12, 1), outflow,
    )  # fmt: skip
    # Newton alone would go to 0.01 at once; four fifths are taken.
    assert change == pytest.approx(0.9999)
    assert m == pytest.approx([20.0])


def marched(
    scheme: int,
    steps: int,
    span: float,
    start: float,
    *,
    n: float = 1.0,
    gap: Any = lambda T: np.ones_like(T),
    conductance: tuple[float, float] = (0.7, 1.3),
    before: float | None = None,
    limit: int = 20,
    keep: Any = None,
) -> dict[str, Any]:
    """One cell of the volume 0.5 at σ = 2, which empties through both ends."""
    dt = span / steps
    gamma = 1 - np.sqrt(0.5)
    at = (np.arange(steps)[:, None] + ([gamma, 1.0] if scheme == SDIRK2 else [1.0])).ravel()
    heights = np.asarray(gap(at * dt), dtype=float)[:, None]
    m, old = np.full(1, start), np.full(1, start if before is None else before)
    load, field = np.zeros(steps), np.full((2, 1), np.nan)
    rows = np.full(steps, -1) if keep is None else np.array(keep)
    lost, worst, made, done = march(
        m, old, Gaps(heights, np.repeat(heights, 2, axis=1)),
        Line(np.full(1, 0.5), np.array(conductance)), Pace(dt, 2.0, scheme), Gas(n, 0.0, 0),
        Aim(1e-13, limit), Track(load, field, rows),
    )  # fmt: skip
    return {
        "m": m[0], "before": old[0], "lost": lost, "worst": worst, "made": made, "done": done,
        "load": load, "field": field,
    }  # fmt: skip


def known(T: Any) -> Any:
    """P(T) from P(0) = 0.2: σ V P′ = G (1 − P²)/2 with σ V = 1 and G = 2."""
    return np.tanh(np.arctanh(0.2) + np.asarray(T))


@pytest.mark.parametrize(("scheme", "order"), [(BACKWARD_EULER, 1), (SDIRK2, 2), (BDF2, 2)])
def test_the_schemes_follow_a_cell_that_fills_in_their_order(scheme: int, order: int) -> None:
    errors = []
    for steps in (40, 80):
        ran = marched(scheme, steps, 0.8, 0.2, before=float(known(-0.8 / steps)))
        T = 0.8 * np.arange(1, steps + 1) / steps
        errors.append(np.abs(ran["load"] - known(T)).max())
        assert ran["load"][-1] == pytest.approx(ran["m"])
        assert ran["before"] == pytest.approx(ran["load"][-2])
        assert (ran["done"], ran["worst"] < 1e-9) == (steps, True)
        assert 2 * steps <= ran["made"] <= (10 if scheme == SDIRK2 else 6) * steps
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.1)
    assert errors[1] < (4e-3 if order == 1 else 1e-4)


@pytest.mark.parametrize("n", [1.0, 1.3])
@pytest.mark.parametrize("scheme", [BACKWARD_EULER, SDIRK2, BDF2])
def test_gas_that_leaves_is_gas_that_was_there(scheme: int, n: float) -> None:
    ran = marched(scheme, 25, 3.0, 1.4, n=n, gap=lambda T: 1 + 0.4 * np.cos(2 * T), before=1.3)
    gone = 0.5 * (1.4 - ran["m"])
    if scheme == BDF2:
        # (3 m₊ − 4 m + m₋)/2 sums to its two ends.
        gone = 0.5 * ((1.5 * 1.4 - 0.5 * 1.3) - (1.5 * ran["m"] - 0.5 * ran["before"]))
    assert ran["lost"] == pytest.approx(gone, abs=1e-11)
    assert abs(ran["lost"]) > 1e-2


@pytest.mark.parametrize("n", [1.0, 1.3])
@pytest.mark.parametrize("scheme", [BACKWARD_EULER, SDIRK2, BDF2])
def test_enclosed_gas_is_compressed_by_the_gap_of_the_end_of_each_step(
    scheme: int, n: float
) -> None:
    ran = marched(
        scheme, 4, 2.0, 1.1, n=n, gap=lambda T: 1 + 0.3 * np.sin(T), conductance=(0.0, 0.0),
        keep=[-1, 1, -1, 0],
    )  # fmt: skip
    T = 0.5 * np.arange(1, 5)
    pressure = (1.1 / (1 + 0.3 * np.sin(T))) ** n
    assert ran["load"] == pytest.approx(pressure)
    assert ran["field"].ravel() == pytest.approx(pressure[[3, 1]])
    assert (ran["lost"], ran["m"]) == (0.0, pytest.approx(1.1))


def test_the_load_is_the_mean_by_volume() -> None:
    load, field = np.zeros(1), np.zeros((1, 2))
    m = np.array([1.0, 3.0])
    march(
        m, m.copy(), Gaps(np.ones((1, 2)), np.ones((1, 3))),
        Line(np.array([0.3, 0.1]), np.zeros(3)), Pace(0.1, 1.0, BACKWARD_EULER), ISOTHERMAL,
        Aim(1e-12, 9), Track(load, field, np.zeros(1, int)),
    )  # fmt: skip
    assert load == pytest.approx([1.5])
    assert field == pytest.approx(np.array([[1.0, 3.0]]))


@pytest.mark.parametrize("scheme", [BACKWARD_EULER, SDIRK2, BDF2])
def test_a_step_that_fails_ends_the_march_there(scheme: int) -> None:
    # At rest until the gap halves: with one Newton step that is not to be followed.
    ran = marched(scheme, 6, 6.0, 1.0, limit=1, gap=lambda T: np.where(T > 3.0, 0.5, 1.0))
    assert ran["done"] == 3
    assert ran["worst"] > 1e-6
    assert ran["lost"] == 0.0
    assert ran["load"][3:] == pytest.approx([0.0, 0.0, 0.0])


def test_what_is_no_number_does_not_count_as_converged() -> None:
    one, m = np.ones(3), np.array([1.0, np.nan, 1.0])
    change, _ = implicit_stage(
        m.copy(), one, Gaps(one, np.ones(4)), Line(one, np.ones(4)), 0.4, ISOTHERMAL,
        Aim(1e-12, 20), np.zeros(2),
    )  # fmt: skip
    assert not change <= 1e-6
    *_, done = march(
        m.copy(), m.copy(), Gaps(np.ones((2, 3)), np.ones((2, 4))), Line(one, np.ones(4)),
        Pace(0.1, 1.0, BACKWARD_EULER), ISOTHERMAL, Aim(1e-12, 20),
        Track(np.zeros(2), np.zeros((1, 3)), np.full(2, -1)),
    )  # fmt: skip
    assert done == 0
