"""A motor's causal graph against its equations, and the force law that inverts it, in time."""

from dataclasses import replace

import numpy as np
import pytest
from tests.unit.actuators.test_motor import PRELOAD, motor

from squeezefilm.actuators.motor import kernel
from squeezefilm.actuators.motor.assembled import AssembledMotor, Working
from squeezefilm.actuators.motor.causal import averaged_graph, causal_graph, inverted
from squeezefilm.actuators.motor.closed_loop import inverted_law, track_force
from squeezefilm.actuators.motor.in_time import resting
from squeezefilm.core.errors import InputError

SPEED = 0.01


def depends(there: AssembledMotor, contact: int) -> set[tuple[str, str]]:
    """Which rate depends on which state at once, by differences of the compiled equations."""
    working = Working(voltage=10.0)
    stator = there.stator(working)
    march, slider = resting(there, working, stator, None, 0.02)
    march.contact[:] = contact
    names = ["q", "q'", "z", "z'", "x", "v", "e_1", "e_2", "e_3"]
    y = np.concatenate([[2e-6, 0.1, -1e-6, 0.01, 0.0, 0.02], np.full(3, 1e-7)])
    y = np.concatenate([y, np.zeros(kernel.TOTALS)])

    def rates(state: np.ndarray) -> np.ndarray:
        found = np.zeros_like(state)
        kernel.rates(0.0, state.copy(), stator, there.feet, slider, march, found)
        return found

    base = rates(y)
    found = set()
    for k, name in enumerate(names):
        moved = y.copy()
        moved[k] *= 1.01
        changed = ~np.isclose(rates(moved), base, rtol=1e-12, atol=0)
        for target, row in (("q", 1), ("z", 3), ("v", 5), ("e_1", 6), ("e_2", 7), ("e_3", 8)):
            if changed[row]:
                found.add((name.rstrip("'"), target))
    return {(a, b) for a, b in found if a != b and a != "x"}


@pytest.mark.parametrize("inclination", [0.0, 0.2])
def test_the_graph_says_what_the_equations_say(inclination: float) -> None:
    there = motor(inclination=inclination)
    graph = causal_graph(there)
    maker = {one.output: one for one in graph.elements}

    def behind(name: str, through_stretch: bool) -> set[str]:
        """What is integrated and stands behind an input, through what has no memory."""
        found, seen, waiting = set(), {name}, [name]
        while waiting:
            one = maker.get(waiting.pop())
            if one is None:
                continue
            if one.causal and not (through_stretch and one.output.startswith("e_")):
                found.add(one.output)
                continue
            waiting += [near for near in one.inputs if near not in seen]
            seen |= set(one.inputs)
        return found

    said = {
        (far, one.output)
        for one in graph.elements
        if one.causal
        for name in one.inputs
        for far in behind(name, False)
        if far != one.output
    }
    # Friction holds: the stretch does not ask how hard the foot is pressed.
    without_limit = {pair for pair in said if not (pair[1].startswith("e_") and pair[0] in ("z",))}
    assert depends(there, kernel.STICK) == without_limit
    slips = {
        (far, one.output)
        for one in graph.elements
        if one.causal and not one.output.startswith("e_")
        for name in one.inputs
        for far in behind(name, True)
        if far != one.output
    }
    slipping = {pair for pair in depends(there, kernel.SLIP_UP) if not pair[1].startswith("e_")}
    assert slipping <= slips


def test_the_graph_is_made_of_the_motor() -> None:
    there = motor()
    graph = causal_graph(there)
    assert graph.sources == ("V", "P", "load")
    assert sum(one.name.startswith("contact") for one in graph.elements) == 3
    upright = replace(there, feet=there.feet._replace(along=np.zeros_like(there.feet.along)))
    stretch = next(one for one in causal_graph(upright).elements if one.output == "e_1")
    assert "q" not in stretch.inputs
    assert ("slider along", "stretch of foot 1", "v") in graph.edges


def test_the_law_is_the_way_from_the_force_back_to_the_voltage() -> None:
    graph = averaged_graph(motor())
    assert [one.output for one in graph.way("V", "F")] == ["f", "A", "F"]
    law = inverted(graph, "V", "F")
    assert [one.command for one in law] == ["A wanted", "f wanted", "V wanted"]
    # Speed and preload are measured for the function, the amplitude for its loop.
    assert [one.measured for one in law] == [("v", "P"), ("A",), ()]
    assert "loop around A" in law[1].relation
    assert "inverse of" in law[0].relation
    with pytest.raises(InputError, match="no 'U'; it has: V, P, load"):
        graph.way("U", "F")
    with pytest.raises(InputError, match="nothing leads from 'load' to 'f'"):
        graph.way("load", "f")


def tracked(friction: float, steps: int = 60) -> tuple[float, float, float, float]:
    """A step of the force with another µ than the law's: largest error from 3 ms on, mean errors at
    both ends, largest overshoot, all over the wanted force."""
    amplitudes = np.linspace(0.2e-6, 1.5e-6, 14)
    law = inverted_law(motor(), np.array([SPEED]), amplitudes)
    low, high = 0.3 * law.thrust[0, -1], 0.7 * law.thrust[0, -1]
    wanted = np.concatenate([np.full(steps, low), np.full(steps, high)])
    found = track_force(motor(friction=friction), law, wanted, SPEED)
    assert found.cut == 0
    begun = found.time[steps - 1]
    after = found.force[steps:] / high - 1
    late = found.time[steps:] - begun > 3e-3
    last = found.mean_error(found.time[-10], found.time[-1])
    first = found.mean_error(found.time[steps - 10], begun)
    return float(np.max(np.abs(after[late]))), first, last, float(np.max(after))


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.24, 0.3, 0.36])
def test_a_step_of_force_is_tracked_whatever_the_friction(friction: float) -> None:
    largest, first, last, overshoot = tracked(friction)
    assert largest < 0.05
    assert abs(first) < 0.02
    assert abs(last) < 0.02
    assert overshoot < 0.05


def test_at_rest_no_amplitude_can_be_found_for_a_force() -> None:
    with pytest.raises(InputError, match="at rest a slider that the feet leave is pushed"):
        inverted_law(motor(), np.array([0.0]), np.linspace(0.8e-6, 1.5e-6, 5))


def test_no_step_between_two_times_is_refused() -> None:
    law = inverted_law(motor(), np.array([SPEED]), np.linspace(0.2e-6, 1.5e-6, 5))
    found = track_force(motor(), law, np.full(3, 1.0), SPEED)
    assert found.force[-1] < 0.3 * PRELOAD
    with pytest.raises(InputError, match="no step of the law"):
        found.mean_error(1.0, 2.0)
