"""Recordings that no instrument should give end in a message or in a fit, in nothing else."""

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import guarded_fit
from squeezefilm.measure.fits.friction.friction_bench import fit_friction_bench
from squeezefilm.measure.fits.vibration.frequency_response import fit_frequency_response
from squeezefilm.measure.fits.vibration.line_scan import fit_line_scan
from squeezefilm.measure.fits.vibration.raw_signals import fit_raw_signals
from squeezefilm.measure.fits.vibration.ring_down import fit_ring_down
from squeezefilm.measure.fits.vibration.solved_shapes import fit_grid_scan
from squeezefilm.measure.fits.vibration.voltage_sweeps import fit_voltage_sweeps
from squeezefilm.measure.recordings import kinds

COUNT = 400
RANDOM = np.random.default_rng(1)
ROWS = {
    "noise": RANDOM.standard_normal(COUNT),
    "rising": np.linspace(29e3, 31e3, COUNT),
    "a small row": np.linspace(0.0, 1e-9, COUNT),
    "one value": np.ones(COUNT),
    "nothing": np.zeros(COUNT),
    "no number": np.full(COUNT, np.nan),
    "half no number": np.where(np.arange(COUNT) % 2, np.nan, 1.0),
    "infinite": np.full(COUNT, np.inf),
    "huge": np.linspace(1e150, 1e155, COUNT),
    "tiny": np.linspace(1e-160, 2e-160, COUNT),
    "negative": -np.linspace(1.0, 2.0, COUNT),
    "a step": (np.arange(COUNT) > 200).astype(float),
    "a spike": (np.arange(COUNT) == 200).astype(float),
    "clipped": np.clip(3 * np.sin(np.arange(COUNT) / 3), -1, 1),
    "few": np.array([1.0, 2.0, 3.0]),
    "empty": np.array([]),
}


def _fits(x, w):
    """Every fit of a recording with these columns."""
    z, same = np.asarray(w + 1j * w[::-1]), np.ones(x.size)
    shapes = {"a": np.cos(np.arange(x.size)), "b": np.sin(np.arange(x.size))}
    yield lambda: fit_frequency_response(kinds.FrequencyResponse(x, z))
    yield lambda: fit_line_scan(kinds.LineScan(x, z, 30e3))
    yield lambda: fit_line_scan(kinds.LineScan(x, w, 30e3, 1.0))
    yield lambda: fit_grid_scan(kinds.GridScan(x, x, z, 30e3, 1.0), shapes)
    yield lambda: fit_ring_down(kinds.RingDown(x, w))
    yield lambda: fit_voltage_sweeps(
        kinds.VoltageSweeps(
            tuple(kinds.FrequencyResponse(x, z, volts) for volts in (1.0, 2.0)), ("up", "up")
        )
    )
    yield lambda: fit_voltage_sweeps(kinds.VoltageSweeps((), ()))
    yield lambda: fit_raw_signals(kinds.RawSignals(x, w, w))
    yield lambda: fit_friction_bench(kinds.FrictionBench(x, same, w, w, np.abs(w)))


def _tried(x: str, w: str) -> None:
    with np.errstate(invalid="ignore"):
        fits = list(_fits(ROWS[x], ROWS[w]))
    for number, fit in enumerate(fits):
        try:
            found = fit()
        except InputError:
            continue
        except Exception as error:
            raise AssertionError(f"fit {number} of {w} over {x}: {error!r}") from error
        assert found.adequacy.sentence
        for one in found.observations:
            assert np.isfinite([one.value, one.standard_error]).all(), one


# What is fitted for a second and more has its turn below.
LONG = {
    "a small row",
    "a spike",
    "clipped",
    "huge",
    "negative",
    "noise",
    "one value",
    "rising",
    "tiny",
}


@pytest.mark.parametrize("w", sorted(ROWS.keys() - LONG))
def test_a_fit_or_a_message(w: str) -> None:
    _tried("rising" if ROWS[w].size == COUNT else w, w)


WHOLE = sorted(name for name, row in ROWS.items() if row.size == COUNT)
# Each row over another one and under another one; the rest have their turn at night.
BY_DAY = dict(zip(WHOLE, WHOLE[5:] + WHOLE[:5], strict=True))


@pytest.mark.parametrize(
    ("x", "w"),
    [
        pytest.param(x, w, marks=pytest.mark.slow if BY_DAY[x] == w else pytest.mark.nightly)
        for x in WHOLE
        for w in WHOLE
    ],
)
def test_a_fit_or_a_message_over_anything(x: str, w: str) -> None:
    _tried(x, w)


def test_arithmetic_that_ends_is_a_message() -> None:
    @guarded_fit
    def ends(how: str):
        if how == "divides":
            return 1 / 0
        raise np.linalg.LinAlgError("no solution")

    for how in ("divides", "solves"):
        with pytest.raises(InputError, match="has no fit"):
            ends(how)
