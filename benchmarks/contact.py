"""How fast the load sharing is, at what error, and against what.

Run `python benchmarks/contact.py`.

Prints, on one core: a friction curve of 100 amplitudes over a whole pad (28 ridges on the standing
wave), with and without solving its film table; a map of 50 amplitudes × 50 forces; the time of one
load balance; the ratio to balancing each plateau with SciPy's brentq on `solve_uniform`, in the
same run and at the same error; and where the time goes.
"""

from __future__ import annotations

import os

# One core for all that is timed; has to be set before NumPy loads its linear algebra.
os.environ["OMP_NUM_THREADS"] = "1"

import argparse
import dataclasses
import time
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from squeezefilm.physics.contact.sharing.balance import share_load
from squeezefilm.physics.contact.sharing.gas_table import FilmTable
from squeezefilm.physics.contact.sharing.pad import pad_friction, pad_points
from squeezefilm.physics.display import load_display
from squeezefilm.physics.film.periodic.film import solve_uniform

FREQUENCY, HALF_WAVELENGTH = 40.5e3, 9.35e-3


def best_time(run: Callable[[], object], repeats: int = 5) -> float:
    """The shortest of some runs, in seconds of this process (all in one thread)."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


def peer(gas, width, law, amplitude, pressure, tolerance):
    """A plateau balanced the plain way: a film solved at every step of brentq; µ′/µ and solves."""
    length = width * np.sqrt(24 * np.pi * gas.viscosity * FREQUENCY / gas.ambient_pressure)
    phase = 2 * np.pi * np.arange(128) / 128
    solves = 0

    def carried(u):
        return float(np.mean(law.pressure(u - amplitude * np.cos(phase))))

    def excess(u):
        nonlocal solves
        solves += 1
        film = solve_uniform(
            (length / u) ** 2,
            amplitude / u,
            knudsen_number=gas.mean_free_path / u,
            tolerance=tolerance,
        )
        gas_pressure = gas.ambient_pressure * film.over_pressure
        return gas_pressure + carried(u) - pressure

    u = brentq(excess, amplitude / 0.98, 2e-5, xtol=1e-12, rtol=1e-7)
    return carried(u) / pressure, solves


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--sample", type=int, default=60, help="plateaus for the peer")
    sample = arguments.parse_args().sample
    display = load_display("biet2008-stator")
    finger, gas = display.finger, display.gas
    law = finger.asperity_law(display.surface().roughness)
    points = pad_points(finger)
    met = np.abs(np.cos(np.pi * points.along / HALF_WAVELENGTH))
    amplitudes = np.linspace(0.05e-6, 5e-6, 100)
    pressure = finger.plateau_pressure()

    def curve(table, **options):
        return pad_friction(table, law, amplitudes, met, points.shares, pressure, **options)

    def fresh():
        return FilmTable(FREQUENCY, finger.plateau_width, gas)

    table = fresh()
    curve(table)  # compiles
    curve(table, limit="one-gap")
    cold = best_time(lambda: curve(fresh()))
    cold_table = fresh()
    curve(cold_table)
    films = cold_table.solved
    warm = best_time(lambda: curve(table))
    tied = best_time(lambda: curve(table, limit="one-gap"))
    print(f"Friction curve of 100 amplitudes, {met.size} ridges on the standing wave, one core")
    print(f"  each ridge at its own balance, film table solved too : {cold * 1e3:8.1f} ms")
    print(f"  the same with the table at hand                      : {warm * 1e3:8.1f} ms")
    print(f"  all ridges at one mean gap                           : {tied * 1e3:8.1f} ms")
    print(f"  films in that table {films}, its error bound {cold_table.relative_error:.1e}")

    forces = np.linspace(0.05, 2.0, 50)
    wide = np.linspace(0.05e-6, 5e-6, 50)

    def whole_map(table):
        return np.array(
            [
                pad_friction(
                    table, law, wide, met, points.shares, finger.plateau_pressure(float(f))
                ).relative_friction
                for f in forces
            ]
        )

    seconds = best_time(lambda: whole_map(fresh()), 3)
    print(f"\nMap of 50 amplitudes × 50 forces (70 000 plateaus): {seconds:.3f} s with its table")

    rng = np.random.default_rng(3)
    a, p = rng.uniform(0.2e-6, 5e-6, 20000), rng.uniform(1e3, 3e4, 20000)
    share_load(table, law, a, p)
    each = best_time(lambda: share_load(table, law, a, p)) / a.size
    steps = float(np.mean(share_load(table, law, a, p).steps))
    print(f"\nOne load balance: {each * 1e6:.2f} µs in {steps:.1f} steps on average")
    soft = dataclasses.replace(law, heights="gaussian", decay_length=0.8e-6)
    share_load(table, soft, a[:2000], p[:2000])
    gaussian = best_time(lambda: share_load(table, soft, a[:2000], p[:2000])) / 2000
    print(f"  with Gaussian heights: {gaussian * 1e6:.2f} µs")

    tolerance = table.tolerance
    values: list[tuple[float, int]] = []

    def plain() -> None:
        values.clear()
        for one, load in zip(a[:sample], p[:sample], strict=True):
            values.append(peer(gas, finger.plateau_width, law, one, load, tolerance))

    plain()
    there = best_time(plain, 2) / sample
    exact = share_load(
        FilmTable(FREQUENCY, finger.plateau_width, gas, tolerance=2e-5), law, a[:sample], p[:sample]
    ).relative_friction
    ours = share_load(table, law, a[:sample], p[:sample]).relative_friction
    theirs = np.array([value for value, _ in values])
    print(
        f"  brentq on solve_uniform at {tolerance:g}: {there * 1e3:.2f} ms in "
        f"{np.mean([n for _, n in values]):.1f} solves, {there / each:,.0f} times as long"
    )
    print(
        f"  largest error of µ′/µ on {sample} plateaus: table {np.max(np.abs(ours - exact)):.1e}, "
        f"brentq {np.max(np.abs(theirs - exact)):.1e}"
    )
    break_even = (cold - warm) / there
    print(
        f"\nWhat limits: of a cold curve {(cold - warm) / cold:.0%} is solving {films} films for "
        f"the table, which pays after {break_even:.0f} balances done the plain way;\n"
        f"a warm one is {points.size // 2} × 100 distinct balances at {warm / 1400 * 1e6:.1f} µs, "
        f"{each / steps * 1e9:.0f} ns a step: two logarithms, an 8 × 8 Chebyshev sum, I0."
    )


if __name__ == "__main__":
    main()
