"""The compiled plant on constants made by hand: arm, sensor, warmth, friction and truth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from scipy.signal import lsim

from squeezefilm.instruments.twin import plant_kernel as k
from squeezefilm.instruments.twin.envelope_step import Fingers, FrictionTables
from squeezefilm.instruments.twin.plant_kernel import gaussian, uniform

STEP = 50  # us
SPEED_X, SPEED_Y = 0.08, -0.03
ROWS = 50


@dataclass
class Bench:
    """A plant from its kernel's arrays, and a hand that goes straight from (10, 20) mm."""

    state: Any
    counts: Any
    arguments: tuple[Any, ...]
    truth: Any
    ring: Any

    def advance(self, until: int, level: int = 0, carrier: int = 0) -> int:
        return int(k.advance(until, level, carrier, *self.arguments))

    def go(self, until: int, level: int = 0, carrier: int = 0) -> None:
        """Advance to a time whatever rows of truth come."""
        while self.advance(until, level, carrier) < until:
            self.counts[k.ROWS] = 0

    def rows(self, until: int, level: int = 0, carrier: int = 0) -> dict[str, Any]:
        """All rows up to a time, by column."""
        kept = []
        while self.advance(until, level, carrier) < until or self.counts[k.ROWS]:
            kept.append(self.truth[: self.counts[k.ROWS]].copy())
            self.counts[k.ROWS] = 0
        table = np.concatenate(kept)
        return dict(zip(k.COLUMNS, table.T, strict=True))


# µ, and µ′/µ, whatever force, amplitude and speed.
ALIKE = FrictionTables(np.array([0.0, 1.0]), np.full((2, 3, 2), 0.6), np.full(2, 0.4))


def bench(
    waiting: int = 64, press: int = 1, tables: FrictionTables = ALIKE, **changes: float
) -> Bench:
    """A plant whose constants are these, any replaced by its name without the ``C_``."""
    named: dict[str, float] = {
        "STEP": STEP, "ROW": 100, "SEED": 9, "F0": 40e3, "Q": 60.0, "PER_VOLT": 2e-8,
        "FACTOR": 0.3, "OFFSET": 0.0, "AGEING": 0.0, "COEFFICIENT": 0.0, "SWING": 0.0,
        "PERIOD": 80_000_000, "QUALITY_DRIFT": 0.0, "CHARGE_DRIFT": 0.0, "SOFTENING": 0.0,
        "FIELD_DRIFT": 0.0, "CAPACITY": 1.0, "COOLING": math.inf, "FACE": 4e-3,
        "FACE_LENGTH": 15e-3, "EMISSIVITY": 0.5, "ROOM": 293.15, "GAIN": 1.0, "RAIL": 100.0,
        "CURRENT": 10.0, "SLEW": 1e9, "C0": 20e-9, "LOSS": 0.02, "MASS": 0.05,
        "STIFFNESS": 800.0, "DAMPING": 6.0, "PAD_MASS": 0.2e-3, "PAD_DAMPING": 1.0,
        "PAD_STIFFNESS": 1000.0, "SUBSTEPS": 8, "STATIC": 1.0,
        "EXPONENT": 1.0, "REFERENCE": 0.5, "FORCE": 0.0, "RATE": 3000.0, "LATENCY": 700.0,
        "JITTER": 0.0, "NOISE": 0.0, "QUANTUM": 0.0, "SHARE_LOST": 0.0, "LAG": 0.0,
    }  # fmt: skip
    named.update(changes)
    constants = np.zeros(k.CONSTANTS)
    for name, value in named.items():
        constants[getattr(k, f"C_{name}")] = value
    assert len(named) == k.CONSTANTS
    state, counts = np.zeros(k.STATE), np.zeros(k.COUNTS, dtype=np.int64)
    state[k.X] = state[k.SKIN_X] = 0.01
    state[k.Y] = 0.02
    state[k.RESONANCE] = named["F0"]
    state[k.RELATIVE] = math.nan
    duration = 1_000_000
    places = np.array([[0.01, 0.01 + SPEED_X], [0.02, 0.02 + SPEED_Y]])
    plan = np.array([0, duration, 0, press, duration, 1], dtype=np.int64)
    fingers = Fingers(np.array([0.1, 5.0]), np.zeros((2, 3), dtype=complex), 1e-5)
    ring, truth = np.zeros((waiting, 5)), np.empty((ROWS, len(k.COLUMNS)))
    plant = k.PlantState(state, counts, constants, k.untouched(tables))
    arguments = (plant, fingers, k.HandPath(places, plan), ring, truth)
    return Bench(state, counts, arguments, truth, ring)


def led(times: Any, mass: float, damping: float, stiffness: float) -> tuple[Any, Any]:
    """Way and speed of an oscillator whose arm sets off at speed 1: exact, for straight ways."""
    system = ([[0, 1], [-stiffness / mass, -damping / mass]], [[0, 0], [stiffness / mass,
              damping / mass]], np.eye(2), np.zeros((2, 2)))  # fmt: skip
    arm = np.column_stack([times, np.ones_like(times)])
    _, found, _ = lsim(system, arm, times, X0=[0.0, 0.0])
    return found[:, 0], found[:, 1]


# Too little, critical, and too much damping.
@pytest.mark.parametrize("damping", [6.0, 2 * math.sqrt(0.05 * 800.0), 40.0])
def test_without_friction_the_finger_follows_the_arm_in_both_directions(damping: float) -> None:
    plant = bench(DAMPING=damping)
    found = plant.rows(40_000)
    times = np.arange(0, 401) * 100e-6
    np.testing.assert_allclose(found["time_s"], times[1:], rtol=1e-12)
    way, speed = led(times, 0.05, damping, 800.0)
    np.testing.assert_allclose(found["x_m"], 0.01 + SPEED_X * way[1:], atol=1e-9)
    np.testing.assert_allclose(found["y_m"], 0.02 + SPEED_Y * way[1:], atol=1e-9)
    pace = math.hypot(SPEED_X, SPEED_Y)
    np.testing.assert_allclose(found["speed_m_per_s"], pace * np.abs(speed[1:]), atol=1e-7)
    assert plant.state[k.VY] == pytest.approx(SPEED_Y * speed[-1], abs=1e-7)
    # In the air the skin goes with the bone, and nothing is rubbed.
    np.testing.assert_array_equal(found["skin_x_m"], found["x_m"])
    assert np.all(np.isnan(found["relative_friction"]))
    assert np.all(found["tangential_force_N"] == 0.0)
    assert np.all(found["normal_force_N"] == 0.0)


@pytest.mark.parametrize("exponent", [1.0, 0.8])
def test_sliding_steadily_the_spring_carries_the_friction_of_the_law(exponent: float) -> None:
    plant = bench(FORCE=1.3, EXPONENT=exponent, DAMPING=30.0)
    found = plant.rows(350_000)
    drag = 0.4 * 0.6 * 0.5 * (1.3 / 0.5) ** exponent
    assert found["tangential_force_N"][-1] == pytest.approx(drag, rel=1e-9)
    assert found["relative_friction"][-1] == pytest.approx(0.6)
    assert found["normal_force_N"][-1] == pytest.approx(1.3)
    behind = 0.01 + SPEED_X * 0.35 - found["x_m"][-1]
    assert behind == pytest.approx(drag / 800.0, rel=1e-3)
    assert found["x_m"][-1] - found["skin_x_m"][-1] == pytest.approx(drag / 1000.0, rel=1e-3)
    # Nothing drags it sideways.
    assert found["y_m"][-1] == pytest.approx(0.02 + SPEED_Y * 0.35, abs=1e-6)
    assert plant.counts[k.FAILED] == plant.counts[k.BEYOND] == 0


def test_friction_is_that_at_the_skins_own_speed_and_at_the_force() -> None:
    # µ′/µ rises by 4 for each m/s up to 0.1 m/s, and µ with the force.
    speed, coefficient = np.array([0.0, 0.1]), np.array([0.1, 4.9 + 0.1])
    tables = FrictionTables(speed, np.tile([0.2, 0.6], (2, 3, 1)), coefficient)
    plant = bench(FORCE=1.3, DAMPING=30.0, tables=tables)
    found = plant.rows(350_000)
    assert plant.state[k.SKIN_V] == pytest.approx(SPEED_X, rel=1e-3)
    relative = 0.2 + 4.0 * plant.state[k.SKIN_V]
    assert found["relative_friction"][-1] == pytest.approx(relative, rel=1e-9)
    # µ is 1.3 at 1.3 N.
    assert found["tangential_force_N"][-1] == pytest.approx(1.3 * 1.3 * relative, rel=1e-6)


def test_a_skin_that_rests_is_held_by_the_friction_at_rest_and_its_static_ratio() -> None:
    rests = FrictionTables(np.array([0.0, 1e-3]), np.tile([0.5, 0.2], (2, 3, 1)), np.full(2, 0.4))
    for ratio in (1.0, 1.5):
        plant = bench(FORCE=1.0, STATIC=ratio, tables=rests)
        found = plant.rows(20_000)
        # The pad is pulled along until it slips, and what held it is friction at rest.
        held = found["tangential_force_N"].max()
        assert held == pytest.approx(ratio * 0.4 * 0.5, rel=0.02)
        stuck = np.diff(found["skin_x_m"]) == 0.0
        assert stuck.any()
        assert np.all(found["relative_friction"][1:][stuck] == 0.5)
        assert plant.counts[k.FAILED] == 0


def test_a_finger_lands_with_a_relaxed_skin() -> None:
    plant = bench(FORCE=1.0, press=2_000)
    found = plant.rows(2_500)
    np.testing.assert_allclose(found["normal_force_N"][:20], np.arange(1, 21) / 20, rtol=1e-9)
    assert np.all(found["normal_force_N"][20:] == 1.0)
    # The skin lags the more the harder it is held; at first it was with the bone.
    lag = np.abs(found["x_m"] - found["skin_x_m"])
    assert lag[0] < 0.4 * 0.6 * 0.05 / 1000.0 * 1.01
    limit = 0.4 * 0.6 * found["normal_force_N"]
    assert np.all(np.abs(found["tangential_force_N"]) <= limit * (1 + 1e-9))


@lru_cache(maxsize=1)
def ends_of_steps() -> tuple[Any, Any]:
    ends = np.arange(0, 10_001, STEP)
    return ends, led(ends * 1e-6, 0.05, 6.0, 800.0)[0]


def where(time: float) -> tuple[float, float]:
    """The finger's bone in a step, straight between its ends."""
    at = float(np.interp(time, *ends_of_steps()))
    return 0.01 + SPEED_X * at, 0.02 + SPEED_Y * at


@pytest.mark.parametrize("latency", [0.0, 700.0, 2500.0])
def test_the_sensor_shows_the_newest_sample_that_has_arrived(latency: float) -> None:
    plant = bench(LATENCY=latency)
    taken = [int(n * 1e6 / 3000.0) for n in range(100)]
    for now in range(STEP, 6_001, 3 * STEP):
        plant.go(now)
        there = [one for one in taken if one + latency <= now]
        if not there:
            assert plant.state[k.SEEN_X] == plant.state[k.SEEN_Y] == 0.0
            continue
        assert plant.counts[k.SEEN_TAKEN] == there[-1]
        assert plant.counts[k.SEEN_TOUCHING] == 0
        seen = (plant.state[k.SEEN_X], plant.state[k.SEEN_Y])
        assert seen == pytest.approx(where(there[-1]), abs=1e-10)
        assert plant.counts[k.SAMPLE] == len([one for one in taken if one <= now])
    assert plant.counts[k.LOST_SAMPLES] == 0


def test_what_the_sensor_adds_to_a_place() -> None:
    plant = bench(NOISE=2e-3, QUANTUM=0.5e-3, LATENCY=0.0)
    for n in range(1, 15):
        taken = int(n * 1e6 / 3000.0)
        plant.go(-(-taken // STEP) * STEP)
        x, y = where(taken)
        x += 2e-3 * gaussian(9, 1, n)
        y += 2e-3 * gaussian(9, 2, n)
        assert plant.counts[k.SEEN_TAKEN] == taken
        seen = (plant.state[k.SEEN_X], plant.state[k.SEEN_Y])
        assert seen == pytest.approx((0.5e-3 * round(x / 0.5e-3), 0.5e-3 * round(y / 0.5e-3)))


def test_samples_that_are_lost_are_counted_and_never_shown() -> None:
    plant = bench(SHARE_LOST=0.5, LATENCY=0.0)
    kept = [n for n in range(60) if uniform(9, 4, n) >= 0.5]
    for now in range(1_000, 20_001, 1_000):
        plant.go(now)
        made = int(now * 3000.0 / 1e6) + 1
        assert plant.counts[k.LOST_SAMPLES] == made - len([n for n in kept if n < made])
        newest = max(n for n in kept if n < made)
        assert plant.counts[k.SEEN_TAKEN] == int(newest * 1e6 / 3000.0)


def test_samples_with_jitter_arrive_in_their_order_and_never_before_they_were_taken() -> None:
    plant = bench(JITTER=2_000.0, LATENCY=1_000.0)
    arrivals, last = [], 0
    for n in range(60):
        taken = int(n * 1e6 / 3000.0)
        delay = max(1_000.0 + 2_000.0 * gaussian(9, 3, n), 0.0)
        last = max(last, taken + round(delay))
        arrivals.append((last, taken))
    for now in range(STEP, 15_001, STEP):
        plant.go(now)
        there = [taken for arrival, taken in arrivals if arrival <= now and taken <= now]
        assert plant.counts[k.SEEN_TAKEN] == (there[-1] if there else 0)


def test_a_sensor_says_whether_it_is_touched() -> None:
    plant = bench(FORCE=0.5, LATENCY=0.0)
    plant.go(1_000)
    assert plant.counts[k.SEEN_TOUCHING] == 1


def test_of_too_many_samples_on_the_way_the_oldest_are_forgotten() -> None:
    plant = bench(waiting=4, LATENCY=3_000.0)
    plant.go(2_950)
    # Samples 0 to 8 were taken; the last four wait.
    assert plant.counts[k.HEAD] - plant.counts[k.TAIL] == 4
    assert sorted(plant.ring[:, 1]) == [int(n * 1e6 / 3000.0) for n in (5, 6, 7, 8)]
    assert plant.counts[k.SEEN_TAKEN] == 0


def test_the_resonance_moves_with_age_ambient_and_warmth() -> None:
    c = np.zeros(k.CONSTANTS)
    for name, value in {
        "F0": 40e3, "OFFSET": 0.01, "AGEING": 1e-7, "COEFFICIENT": -1e-4, "SWING": 2.0,
        "PERIOD": 80e6,
    }.items():  # fmt: skip
        c[getattr(k, f"C_{name}")] = value
    for seconds, swing in ((0, 0.0), (20, 2.0), (60, -2.0), (80 + 20, 2.0)):
        expected = 40e3 * (1 + 0.01 + 1e-7 * seconds - 1e-4 * (3.0 + swing))
        assert k.resonance(seconds * 10**6, 3.0, c) == pytest.approx(expected, rel=1e-12)


def test_what_is_lost_warms_the_plate_each_ten_milliseconds() -> None:
    # A resistance of 12 K/W and a time constant of 50 ms.
    changes = {"COOLING": 1 / 12, "CAPACITY": 0.05 / 12, "COEFFICIENT": -1e-4, "FACTOR": 0.0}
    plant = bench(**changes)
    warmth, resonance = 0.0, 40e3
    # Without a motional current the loss is the capacitance's, whatever the plate does.
    power = 0.5 * 20.0**2 * 2 * math.pi * 40e3 * 20e-9 * 0.02
    for number in (1, 2, 3):
        assert plant.state[k.RESONANCE] == pytest.approx(resonance, rel=1e-12)
        plant.go(number * k.THERMAL - STEP, 20_000_000, 40_000_000)
        assert plant.state[k.LOST] == pytest.approx(power * (10e-3 - STEP * 1e-6), rel=1e-9)
        plant.go(number * k.THERMAL, 20_000_000, 40_000_000)
        assert plant.state[k.LOST] == 0.0
        warmth = 12.0 * power + (warmth - 12.0 * power) * math.exp(-10e-3 / 0.05)
        resonance = 40e3 * (1 - 1e-4 * warmth)
        assert plant.state[k.WARMTH] == pytest.approx(warmth, rel=1e-9)


def test_the_truth_says_what_the_state_says() -> None:
    plant = bench(FORCE=0.5, GAIN=2.0)
    found = plant.rows(1_000, 12_000_000, 39_900_000)
    s = plant.state
    last = {name: values[-1] for name, values in found.items()}
    assert last == {
        "time_s": pytest.approx(1e-3), "x_m": s[k.X], "y_m": s[k.Y],
        "speed_m_per_s": pytest.approx(math.hypot(s[k.VX], s[k.VY])), "level_V": 12.0,
        "frequency_Hz": 39_900.0, "amplitude_m": pytest.approx(math.hypot(s[k.Z_RE], s[k.Z_IM])),
        "relative_friction": s[k.RELATIVE], "tangential_force_N": s[k.FRICTION],
        "normal_force_N": 0.5, "voltage_V": 24.0, "current_A": s[k.CURRENT_A],
        "resonance_Hz": 40e3, "skin_x_m": s[k.SKIN_X],
    }  # fmt: skip
    assert last["x_m"] != last["skin_x_m"]
    assert last["tangential_force_N"] != last["relative_friction"]
    drawn = 2 * math.pi * 39_900.0 * (
        20e-9 * 24.0 * (0.02 + 1j) + 0.3 * complex(s[k.Z_RE], s[k.Z_IM])
    )  # fmt: skip
    assert last["current_A"] == pytest.approx(abs(drawn), rel=1e-9)


def test_it_stops_where_the_truth_is_full_and_goes_on_when_it_is_emptied() -> None:
    plant = bench()
    assert plant.advance(100_000) == ROWS * 100
    assert plant.counts[k.NOW] == ROWS * 100
    plant.counts[k.ROWS] = 0
    assert plant.advance(ROWS * 100 + 730) == ROWS * 100 + 730
    # Rows are due at whole hundreds of microseconds only.
    assert plant.counts[k.ROWS] == 7
    assert plant.truth[6, 0] == pytest.approx(ROWS * 100e-6 + 700e-6)


def test_pieces_that_end_with_steps_change_nothing() -> None:
    whole, parts = bench(FORCE=0.5), bench(FORCE=0.5)
    whole.advance(4_000, 9_000_000, 40_000_000)
    for until in (50, 150, 1_000, 1_000, 3_950, 4_000):
        parts.advance(until, 9_000_000, 40_000_000)
    np.testing.assert_array_equal(whole.state, parts.state)
    np.testing.assert_array_equal(whole.counts, parts.counts)
    np.testing.assert_array_equal(whole.ring, parts.ring)


def test_a_plate_without_carrier_or_level_is_at_rest_and_one_rings_down_at_its_own() -> None:
    plant = bench()
    plant.advance(1_000)
    assert plant.state[k.VOLTAGE] == plant.state[k.CURRENT_A] == 0.0
    plant.advance(3_000, 20_000_000)
    # No carrier was ever said: it is driven at its resonance, where the envelope is real.
    tau = 60.0 / (math.pi * 40e3)
    full = 20.0 * 2e-8
    assert plant.state[k.Z_RE] == pytest.approx(full * (1 - math.exp(-2e-3 / tau)), rel=1e-9)
    assert plant.state[k.Z_IM] == pytest.approx(0.0, abs=1e-18)
    held = plant.state[k.Z_RE]
    plant.advance(3_500)
    assert plant.state[k.Z_RE] == pytest.approx(held * math.exp(-0.5e-3 / tau), rel=1e-9)
    assert plant.state[k.VOLTAGE] == 0.0
