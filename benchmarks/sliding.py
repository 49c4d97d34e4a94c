"""How fast the sliding skin is marched, at what error, and against what.

Run `python benchmarks/sliding.py` (some 20 s). One smooth stroke that sticks and slips both ways,
on one core: the compiled event-driven march, the same code left to the Python interpreter, and
SciPy's `solve_ivp` with events. All three are compared with the march at a far finer step; the
speed-up is given at the error that SciPy reaches.
"""

from __future__ import annotations

import os

# One core for all that is timed; has to be set before NumPy loads its linear algebra.
os.environ["OMP_NUM_THREADS"] = "1"

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.contact.sliding import kernel as sliding_kernel
from squeezefilm.physics.contact.sliding import march as sliding
from squeezefilm.physics.contact.sliding.march import SpeedFriction

PAD = FingerpadDynamics(damping=0.1)
DURATION = 0.2
FINEST = 819_200
SAMPLES = 200


def best_time(run: Callable[[], object], repeats: int) -> float:
    """The shortest of some runs, in seconds of this process on its core."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


def bone(t: Any) -> Any:
    return 0.08 * t + 2e-4 * np.sin(2 * np.pi * 60 * t)


def bone_speed(t: float) -> float:
    return 0.08 + 2e-4 * 2 * math.pi * 60 * math.cos(2 * math.pi * 60 * t)


def limit(t: Any) -> Any:
    return 0.25 * (1 + 0.4 * np.sin(2 * np.pi * 90 * t))


def marched(steps: int) -> sliding.Sliding:
    t = np.linspace(0.0, DURATION, steps + 1)
    return sliding.slide(bone(t), DURATION / steps, limit(t), 1.0, PAD)


def interpreted(steps: int) -> sliding.Sliding:
    """The march with its outer loop in Python; the closed forms it calls stay compiled."""
    compiled = sliding.slide_march
    sliding.slide_march = sliding_kernel.slide_march.py_func
    try:
        return marched(steps)
    finally:
        sliding.slide_march = compiled


def by_scipy(tolerance: float) -> tuple[np.ndarray, int]:
    """Skin positions at the comparison's samples, and how often the motion was evaluated."""
    times = np.linspace(0.0, DURATION, SAMPLES + 1)
    answer = np.full(times.size, np.nan)
    t, x, v, sign, calls = 0.0, 0.0, 0.0, 0.0, 0

    def pull(s: float, x: float, v: float) -> float:
        return PAD.stiffness * (bone(s) - x) + PAD.damping * (bone_speed(s) - v)

    while True:
        if sign == 0.0:

            def event(s, y):
                return abs(pull(s, y[0], 0.0)) - limit(s)

            def rates(s, y):
                return [0.0, 0.0]

            event.direction = 1.0
        else:

            def event(s, y):
                return y[1]

            def rates(s, y, sign=sign):
                return [y[1], (pull(s, y[0], y[1]) - sign * limit(s)) / PAD.mass]

            event.direction = -sign
        event.terminal = True
        # Without a bound on its step the integrator runs past short sticks.
        done = solve_ivp(
            rates, (t, DURATION), [x, v], "RK45", events=event, rtol=tolerance,
            atol=tolerance * 1e-4, max_step=5e-4, dense_output=True,
        )  # fmt: skip
        calls += done.nfev
        inside = (times >= t) & (times <= done.t[-1])
        answer[inside] = done.sol(times[inside])[0]
        t, x = float(done.t[-1]), float(done.y[0, -1])
        if done.status == 0:
            return answer, calls
        force = pull(t, x, 0.0)
        sign = math.copysign(1.0, force) if sign == 0.0 or abs(force) > limit(t) else 0.0
        v = sign * 1e-12


def long_strokes(knots: int) -> tuple[float, float, int]:
    """Times (s) of a stroke to and fro over a 2 mm grating, with friction over time and by rows
    that rise from 0 where the surface vibrates, and its samples."""
    n = 192_000
    t = np.arange(n) / 19_200
    way = 0.02 * np.sin(2 * np.pi * 0.6 * t)
    on = np.convolve((way / 0.002) % 1 < 0.5, np.full(16, 1 / 16), "same")
    grid = np.concatenate([[0.0], np.geomspace(1e-4, 2.0, knots - 1)])
    saturation = 0.68 * np.maximum(on, 1e-3)
    rows = 0.9 * np.minimum(1.0, grid / saturation[:, np.newaxis]) * (1 - 0.6 * on)[:, np.newaxis]
    rows[on < 1e-6] = 0.9
    level, friction = rows[:, -1].copy(), SpeedFriction(grid, rows)

    def stroke(given: Any) -> sliding.Sliding:
        return sliding.slide(way, 1 / 19_200, given, 0.5)

    times = [best_time(lambda given=given: stroke(given), 4) for given in (level, friction)]
    return times[0], times[1], n


def share_of_kernel(steps: int) -> float:
    """The share of a march's time that is spent in the compiled kernel."""
    kernel, spent = sliding.slide_march, [0.0]

    def timed(*arguments: Any) -> int:
        start = time.process_time()
        done = kernel(*arguments)
        spent[0] += time.process_time() - start
        return done

    sliding.slide_march = timed
    try:
        start = time.process_time()
        for _ in range(50):
            marched(steps)
        return spent[0] / (time.process_time() - start)
    finally:
        sliding.slide_march = kernel


def main() -> None:
    reference = marched(FINEST)
    places = reference.skin_position[:: FINEST // SAMPLES]

    def error(positions: np.ndarray) -> float:
        return float(np.abs(positions - places).max())

    print(
        f"A stroke of {DURATION:g} s with {reference.slips} slips, {reference.stuck_share:.0%} of "
        "the time stuck; errors of the skin's place in nm"
    )
    print("  compiled        steps   million steps/s   ms a stroke   error")
    rows = []
    for steps in (1600, 6400, 25_600, 102_400):
        seconds = best_time(lambda steps=steps: marched(steps), 5)
        rows.append((steps, seconds, error(marched(steps).skin_position[:: steps // SAMPLES])))
        print(
            f"  {steps:19,d}   {steps / seconds / 1e6:15.2f}   {1e3 * seconds:11.2f}"
            f"   {1e9 * rows[-1][2]:7.3f}"
        )

    for knots in (8, 24, 48):
        plain, by_rows, samples = long_strokes(knots)
        print(
            f"  10 s over a grating at 19.2 kHz, rows of {knots} speeds: "
            f"{samples / by_rows / 1e6:.2f} million samples/s, {by_rows / plain:.1f} times as "
            "long as friction over time"
        )

    steps = 1600
    slow = best_time(lambda: interpreted(steps), 3)
    print(
        f"\nouter loop in Python: {steps / slow:,.0f} steps/s; compiled is "
        f"{slow / rows[0][1]:,.0f} times as fast at the same steps"
    )
    for tolerance in (1e-4, 1e-7):
        found, calls = by_scipy(tolerance)
        seconds = best_time(lambda tolerance=tolerance: by_scipy(tolerance), 1)
        wrong = error(found)
        equal = next((row for row in rows if row[2] <= wrong), rows[-1])
        print(
            f"SciPy RK45 with events, rtol {tolerance:g}: {1e3 * seconds:,.0f} ms, {calls:,} "
            f"evaluations, error {1e9 * wrong:.3f} nm; compiled at {1e9 * equal[2]:.3f} nm is "
            f"{seconds / equal[1]:,.0f} times as fast"
        )
    share = share_of_kernel(25_600)
    print(
        f"\nWhat limits the march: {share:.0%} of the time is the compiled kernel, where a sliding "
        "step sums its series at its end and at four points for the energies; "
        "the rest is NumPy preparing and checking arrays. At fine errors the second order does: "
        "SciPy's order is five."
    )


if __name__ == "__main__":
    main()
