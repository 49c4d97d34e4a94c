"""A step of the march in the plane against the same equations in plain NumPy, at random states."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from squeezefilm.actuators.motor.assembled import Feet, Slider, Stator
from squeezefilm.actuators.motor.plane import TOTALS, PlaneMarch, march_plane

MODES, FEET, H = 2, 5, 0.01
NAMES = ("q", "dq", "ddq", "slider", "last", "depth", "stretch", "force", "totals", "shares")


def made(seed: int, *, held: bool, imposed: bool) -> tuple[Stator, Feet, np.ndarray, Slider]:
    random = np.random.default_rng(seed)

    def some(low: float, high: float, *shape: int) -> np.ndarray:
        return random.uniform(low, high, shape or (MODES,))

    stator = Stator(
        some(1, 2), some(20, 30), some(0.5, 1), some(1, 3), some(2, 5), some(0, 6),
        some(0.2, 0.6), some(0.1, 0.4), some(0.1, 0.4), some(0.1, 0.4), held,
    )  # fmt: skip
    feet = Feet(
        some(-1, 1, FEET, MODES), some(-1, 1, FEET, MODES), some(8, 12, FEET), some(-2, 2, FEET),
        some(5, 9, FEET), some(0.01, 0.1, FEET), some(0.1, 0.4, FEET),
    )  # fmt: skip
    slider = Slider(*(float(one) for one in some(0.5, 2, 5)), imposed)
    return stator, feet, some(-1, 1, FEET, MODES), slider


def begun(seed: int) -> PlaneMarch:
    random = np.random.default_rng(1000 + seed)
    sizes = (MODES, MODES, MODES + 1, 6, (FEET, 2), FEET, (FEET, 2), (FEET, 2), TOTALS, 1)
    march = PlaneMarch(*(0.3 * random.standard_normal(size) for size in sizes))
    march.shares[:] = np.abs(march.shares)
    return march


def foot(feet: Feet, i: int, depth: float, speed: float, stretch: np.ndarray) -> tuple:
    """Force in the plane, elastic normal force and slip of a foot that stretched as if it stuck:
    where friction cannot hold it, the force keeps its direction and falls to what it can."""
    limit = feet.mu[i] * (1 + feet.chi[i] * speed)
    lean = np.array([feet.k_nt[i], 0.0])
    force = lean * depth + feet.k_tt[i] * stretch

    def over(share: float) -> float:
        left = (share * force - lean * depth) / feet.k_tt[i]
        return float(share * np.linalg.norm(force) - limit * (feet.k_nn[i] * depth + lean @ left))

    if over(1.0) > 0:
        force = force * brentq(over, 0.0, 1.0, xtol=1e-15, rtol=1e-15)
    left = (force - lean * depth) / feet.k_tt[i]
    return force, feet.k_nn[i] * depth + lean @ left, stretch - left


def stepped(
    t: float, march: PlaneMarch, stator: Stator, feet: Feet, sideways: np.ndarray, slider: Slider
) -> dict[str, np.ndarray]:
    """The state one step after the time `t`."""
    now = {name: getattr(march, name).copy() for name in NAMES}
    s, totals = now["slider"], now["totals"]
    angle = stator.omega * (t + H / 2) + stator.phase
    if stator.held:
        half = stator.amplitude * np.cos(angle)
        speed = -stator.amplitude * stator.omega * np.sin(angle)
    else:
        half, speed = march.q + H / 2 * march.dq, march.dq + H / 2 * march.ddq[:MODES]
    height, rise = s[0] + H / 2 * s[1], s[1] + H / 2 * march.ddq[-1]
    onto, whole, normal, lossy = np.zeros(MODES), np.zeros(2), 0.0, np.zeros(FEET)
    for i in range(FEET):
        ways = np.array([feet.along[i], sideways[i]])
        depth = feet.across[i] @ half - height
        place = ways @ half - (s[2:4] + H / 2 * s[4:6])
        moved = place - march.last[i]
        now["last"][i], now["depth"][i] = place, depth
        if depth <= 0:
            now["stretch"][i] = now["force"][i] = 0.0
            continue
        if march.depth[i] < 0:
            moved = moved * depth / (depth - march.depth[i])
        pressed = feet.across[i] @ speed - rise
        force, elastic, slip = foot(feet, i, depth, pressed, march.stretch[i] + moved)
        lossy[i] = feet.chi[i] * pressed * elastic
        now["stretch"][i], now["force"][i] = march.stretch[i] + moved - slip, force
        totals[5] += (march.force[i] + force) @ slip / 2
        now["shares"] += H / FEET
        onto -= (elastic + lossy[i]) * feet.across[i] + force @ ways
        whole, normal = whole + force, normal + elastic + lossy[i]
    if stator.held:
        after = stator.omega * (t + H) + stator.phase
        now["q"] = stator.amplitude * np.cos(after)
        now["dq"] = -stator.amplitude * stator.omega * np.sin(after)
        totals[0] -= onto @ (now["q"] - march.q)
    else:
        push = stator.force * np.cos(angle)
        size = np.abs(half)
        spring = stator.stiffness * (1 + stator.bend * size + stator.cube * size**2) * half
        c = stator.damping * (1 + stator.rise * np.hypot(half, speed / stator.omega))
        # m (v1 − v0)/h + c (v0 + v1)/2 = what acts in the middle of the step.
        inertia = stator.mass / H
        now["dq"] = (push + onto - spring + (inertia - c / 2) * march.dq) / (inertia + c / 2)
        mean = (now["dq"] + march.dq) / 2
        now["ddq"][:MODES] = (now["dq"] - march.dq) / H
        now["q"] = half + H / 2 * now["dq"]
        totals[0] += push @ mean * H
        totals[3] += c @ mean**2 * H
    inertia = slider.mass / H
    risen = (normal - slider.preload + (inertia - slider.damping / 2) * s[1]) / (
        inertia + slider.damping / 2
    )
    mean = (risen + s[1]) / 2
    totals[1] -= slider.preload * mean * H
    totals[6] += slider.damping * mean**2 * H
    now["ddq"][-1] = (risen - s[1]) / H
    s[0], s[1], before = s[0] + H * mean, risen, s[4:6].copy()
    if slider.imposed:
        drag = slider.guide * np.linalg.norm(before)
        totals[2] += (whole @ before - drag) * H
        totals[6] += drag * H
    else:
        pushed = before + (whole - [slider.load, 0.0]) * H / slider.mass
        speed_pushed = np.linalg.norm(pushed)
        braked = max(speed_pushed - slider.guide * H / slider.mass, 0.0)
        s[4:6] = pushed * braked / speed_pushed
        mean_way = (before + s[4:6]) / 2
        totals[2] += slider.load * mean_way[0] * H
        totals[6] += slider.mass * (pushed - s[4:6]) @ mean_way
    s[2:4] += H / 2 * (before + s[4:6])
    totals[4] += lossy @ (march.slider[0] - s[0] + feet.across @ (now["q"] - march.q))
    totals[7:] += whole * H
    return now


@pytest.mark.parametrize("imposed", [False, True])
@pytest.mark.parametrize("held", [False, True])
def test_every_step_is_that_of_the_equations(held: bool, imposed: bool) -> None:
    kinds = set()
    for seed in range(12):
        stator, feet, sideways, slider = made(seed, held=held, imposed=imposed)
        march, path = begun(seed), np.full((2, 2), np.nan)
        first = stepped(0.7, march, stator, feet, sideways, slider)
        middle = PlaneMarch(**first)
        second = stepped(0.7 + H, middle, stator, feet, sideways, slider)
        met = (march.depth < 0) & (first["depth"] > 0)
        kinds |= {(bool(a), bool(b)) for a, b in zip(met, first["depth"] > 0, strict=True)}
        march_plane(0.7, H, 2, (stator, feet, sideways, slider, march), path)
        for name in NAMES:
            found = getattr(march, name)
            assert found == pytest.approx(second[name], rel=1e-9, abs=1e-11), (seed, name)
        known = [first["slider"][2:4], second["slider"][2:4]]
        assert path == pytest.approx(np.array(known), rel=1e-9, abs=1e-11)
    # Feet that were pressed before, that met the slider within the step, and that hang free.
    assert kinds == {(False, True), (True, True), (False, False)}
