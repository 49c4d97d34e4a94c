"""What a step of the motion estimator and a compensated sample cost, and against what.

Run `python benchmarks/motion.py` (some 15 s). One core. The estimator's step is compared with the
same step left to the Python interpreter, and with the textbook filter in NumPy matrices; the
inverse filter with a loop in Python; the preview with SciPy's bounded least squares. All peers are
first checked to give the same numbers.
"""

from __future__ import annotations

import os

# One core for all that is timed; has to be set before NumPy loads its linear algebra.
os.environ["OMP_NUM_THREADS"] = "1"

import math
import time
from collections.abc import Callable

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.optimize import lsq_linear

from squeezefilm.physics.render.motion import kernel as motion_kernel
from squeezefilm.physics.render.motion.estimator import MotionEstimator, MotionModel
from squeezefilm.physics.render.motion.stroke import MinimumJerkStroke
from squeezefilm.physics.render.resonator import kernel as compensation_kernel
from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
    carrier_block,
    preview_samples,
    preview_work,
)

TAU, LIMIT, RATE = 0.5687e-3, 1e-6, 20e3


def best_time(run: Callable[[], object], repeats: int) -> float:
    """The shortest of some runs, in seconds of this process on its core."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


def textbook(estimator: MotionEstimator, stamps: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Positions by the Kalman filter as written in books: 3×3 matrices of NumPy."""
    m, R = estimator.model, estimator.position_error**2
    H = np.array([[1.0, 0.0, 0.0]])
    x = np.array([seen[0], 0.0, 0.0])
    P = np.diag([R, m.speed_deviation**2, m.acceleration_deviation**2])
    out = np.empty(seen.size)
    out[0] = seen[0]
    for k in range(1, seen.size):
        h = stamps[k] - stamps[k - 1]
        F = np.array([[1.0, h, h * h / 2], [0.0, 1.0, h], [0.0, 0.0, 1.0]])
        Q = m.jerk_density * np.array(
            [
                [h**5 / 20, h**4 / 8, h**3 / 6],
                [h**4 / 8, h**3 / 3, h**2 / 2],
                [h**3 / 6, h**2 / 2, h],
            ]
        )
        x, P = F @ x, F @ P @ F.T + Q
        K = P @ H.T / (H @ P @ H.T + R)
        x = x + K[:, 0] * (seen[k] - x[0])
        P = (np.eye(3) - K @ H) @ P
        out[k] = x[0]
    return out


def stepped(estimator: MotionEstimator, step: Callable[..., object], stamps: np.ndarray,
            seen: np.ndarray) -> np.ndarray:  # fmt: skip
    """Positions by one call of `step` for each sample, from Python."""
    state, parameters = estimator.new_state(), estimator.parameters()
    out = np.empty(seen.size)
    for k in range(seen.size):
        step(state, parameters, stamps[k], seen[k])
        out[k] = state[motion_kernel.X]
    return out


def marched(estimator: MotionEstimator, stamps: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Positions by the compiled loop: a step and a prediction for each sample."""
    out = np.empty((4, seen.size))
    code = np.empty(seen.size, dtype=np.int64)
    motion_kernel.motion_march(
        estimator.new_state(), estimator.parameters(), stamps, stamps, seen, stamps, 0.0, out, code
    )
    return out[0]


def inverse_in_python(wanted: np.ndarray, keep: float, top: float, bottom: float) -> np.ndarray:
    """The inverse filter as a loop in Python over floats."""
    amplitude, command, given = float(wanted[0]), [], wanted.tolist()
    for goal in [*given[1:], given[-1]]:
        c = min(max((goal - amplitude * keep) / (1 - keep), bottom), top)
        command.append(c)
        amplitude = c + (amplitude - c) * keep
    return np.array(command)


def first_by_scipy(wanted: np.ndarray, start: float, keep: float, top: float) -> float:
    """The first amplitude of the least-squares plan by SciPy, over bounded commands."""
    n = wanted.size
    lag = np.subtract.outer(np.arange(n), np.arange(n))
    A = np.where(lag >= 0, (1 - keep) * keep ** np.maximum(lag, 0), 0.0)
    free = start * keep ** np.arange(1, n + 1)
    found = lsq_linear(A, (wanted - free) / top, (-1, 1), method="bvls", tol=1e-14)
    return float(keep * start + (1 - keep) * top * found.x[0])


def predicted(estimator: MotionEstimator, times: np.ndarray) -> None:
    """One sample, then a prediction for each time within the stall limit."""
    out, code = np.empty((4, times.size)), np.empty(times.size, dtype=np.int64)
    near = np.minimum(times, 0.5 * estimator.stall)
    motion_kernel.motion_march(
        estimator.new_state(), estimator.parameters(), times[:1], times[:1], times[:1],
        near, 0.0, out, code,
    )  # fmt: skip
    assert np.all(code == motion_kernel.FRESH)


def preview_seconds(envelope: DrivenEnvelope, wanted: np.ndarray, ahead: int) -> float:
    """Time of a block by the compiled preview (s)."""
    command, code = np.empty(wanted.size), np.empty(wanted.size, dtype=np.int64)
    windows = sliding_window_view(np.append(wanted[1:], np.full(ahead, wanted[-1])), ahead)

    def run() -> None:
        compensation_kernel.previewed_windows(
            envelope.new_state(float(wanted[0])), envelope.parameters(1 / RATE), windows,
            preview_work(ahead), command, code,
        )  # fmt: skip

    run()
    return best_time(run, 3)


def main() -> None:
    estimator = MotionEstimator(MotionModel(), 2e-5)
    hand = MinimumJerkStroke(passes=10)
    few, many = 4000, 400_000
    stamps = np.linspace(0.0, hand.duration, many)
    seen = hand.position(stamps) + 2e-5 * np.random.default_rng(0).standard_normal(many)
    marched(estimator, stamps, seen)
    compiled = best_time(lambda: marched(estimator, stamps, seen), 5) / many
    short, values = stamps[:few], seen[:few]
    step = motion_kernel.motion_step
    peers = {
        "the compiled step, called from Python": lambda: stepped(estimator, step, short, values),
        "the step interpreted, its prediction compiled": lambda: stepped(
            estimator, step.py_func, short, values
        ),
        "textbook filter in NumPy matrices": lambda: textbook(estimator, short, values),
    }
    same = marched(estimator, short, values)
    print(f"Motion: a step and a prediction, compiled loop: {1e9 * compiled:.0f} ns")
    for name, run in peers.items():
        apart = float(np.max(np.abs(run() - same)))
        seconds = best_time(run, 3) / few
        print(
            f"  {name}: {1e9 * seconds:,.0f} ns, {seconds / compiled:,.0f} times as long "
            f"(apart {1e9 * apart:.1g} nm)"
        )

    envelope = DrivenEnvelope(TAU, TAU, LIMIT, braking=True)
    parameters = envelope.parameters(1 / RATE)
    keep = float(parameters[0])
    wanted = np.where((np.arange(many) * 0.24 / RATE / 0.4e-3) % 1 < 0.5, 0.8 * LIMIT, 0.0)
    command, code = np.empty(many), np.empty(many, dtype=np.int64)

    def inverse() -> np.ndarray:
        compensation_kernel.compensated_march(
            envelope.new_state(float(wanted[0])), parameters, wanted, command, code
        )
        return command

    inverse()
    fast = best_time(inverse, 5) / many
    slow = best_time(lambda: inverse_in_python(wanted, keep, LIMIT, -LIMIT), 3) / many
    apart = float(np.max(np.abs(inverse() - inverse_in_python(wanted, keep, LIMIT, -LIMIT))))
    print(
        f"\nInverse filter, compiled: {1e9 * fast:.1f} ns a sample; in Python {1e9 * slow:.0f} ns, "
        f"{slow / fast:.0f} times as long (apart {apart / LIMIT:.1g} of the limit)"
    )

    ahead = preview_samples(envelope, 1 / RATE)
    work, part = preview_work(ahead), 20_000
    plan = preview_seconds(envelope, wanted[:part], ahead) / part
    windows = [wanted[k : k + ahead] for k in range(0, 60 * 37, 37)]
    state = envelope.new_state(0.4 * LIMIT)

    def ours(window: np.ndarray) -> float:
        state[compensation_kernel.AMPLITUDE] = 0.4 * LIMIT
        compensation_kernel.previewed_step(state, parameters, window, work)
        return float(state[compensation_kernel.AMPLITUDE])

    theirs = [first_by_scipy(window, 0.4 * LIMIT, keep, LIMIT) for window in windows]
    apart = max(abs(ours(w) - found) for w, found in zip(windows, theirs, strict=True))
    peer = best_time(
        lambda: [first_by_scipy(w, 0.4 * LIMIT, keep, LIMIT) for w in windows], 3
    ) / len(windows)  # fmt: skip
    print(
        f"Preview of {ahead} samples, compiled: {1e6 * plan:.2f} µs a sample; SciPy's bounded "
        f"least squares {1e6 * peer:,.0f} µs, {peer / plan:,.0f} times as long (apart "
        f"{apart / LIMIT:.1g} of the limit)"
    )

    out = np.empty(many)
    advance = 2 * math.pi * 33.583e3 / 192e3
    carrier_block(0.0, advance, wanted[: many // 4], 4, 1.0, out)
    carrier = best_time(lambda: carrier_block(0.0, advance, wanted[: many // 4], 4, 1.0, out), 5)
    carrier /= many
    print(f"Carrier at 192 kHz: {1e9 * carrier:.1f} ns a sample, {carrier * 192e3:.2%} of a core")

    # What the parts cost: predictions alone, and a preview twice as long.
    once = best_time(lambda: predicted(estimator, stamps), 5) / many
    twice = preview_seconds(envelope, wanted[:part], 2 * ahead) / part
    print(
        f"\nWhat limits: a control step at {RATE / 1e3:g} kHz (estimate, predict, invert) takes "
        f"{1e6 * (compiled + fast):.2f} µs of {1e6 / RATE:.0f} µs, with the preview "
        f"{1e6 * (compiled + plan):.1f} µs. Of the estimator's {1e9 * compiled:.0f} ns the "
        f"prediction alone takes {1e9 * once:.0f}; looking ahead twice as far takes "
        f"{twice / plan:.1f} times as long."
    )


if __name__ == "__main__":
    main()
