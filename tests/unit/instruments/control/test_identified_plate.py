"""From a recorded sweep of a free plate to loops that hold it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.control.gains import identified_plate, loop_gains
from squeezefilm.instruments.control.plate_loop import LOCKED

from .simulated_plate import FREQUENCY, MODE, RE, held
from .test_plate_loop import AIMS, F0, RATE, RATIO, STEP, detuning, identified, true


def sweep(
    quality: float, noise: float, seed: int = 1, width: float = 4.0
) -> tuple[si.HertzArray, si.ComplexArray]:
    """The free plate of the loops' tests as a lock-in shows it (V/V), with its chain's phase."""
    half = F0 / (2 * quality)
    f = np.linspace(F0 - width * half, F0 + width * half, 81)
    phase = -math.pi * F0 / RATE - 2 * math.pi * 0.5 / RATE * (f - F0)
    random = np.random.default_rng(seed)
    disturbed = noise * (random.standard_normal(f.size) + 1j * random.standard_normal(f.size))
    return f, RATIO * np.exp(1j * phase) / (1 + 1j * (f - F0) / half) + disturbed


@pytest.mark.parametrize("quality", [20.0, 150.0, 1000.0])
def test_a_sweep_gives_the_plate_and_its_noise(quality: float) -> None:
    plate, noise = identified_plate(*sweep(quality, 0.01 * RATIO))
    known = identified(quality)
    print(f"Q {quality:g}: {plate}, noise {noise / RATIO:.4f} of K")
    assert plate.frequency == pytest.approx(F0, abs=0.01 * known.half_bandwidth)
    assert plate.quality_factor == pytest.approx(quality, rel=0.01)
    assert plate.ratio == pytest.approx(RATIO, rel=0.01)
    assert plate.phase == pytest.approx(known.phase, abs=0.01)
    # Its slope is seen over the sweep alone: 8 half-bandwidths.
    assert abs(plate.delay - known.delay) * 2 * math.pi * known.half_bandwidth < 0.01
    assert noise == pytest.approx(0.01 * RATIO, rel=0.1)


def test_an_exact_sweep_in_any_order_is_exact() -> None:
    f, response = sweep(100.0, 0.0)
    order = np.random.default_rng(2).permutation(f.size)
    plate, noise = identified_plate(f[order], response[order])
    known = identified(100.0)
    for name in ("frequency", "quality_factor", "ratio", "phase", "delay"):
        assert getattr(plate, name) == pytest.approx(getattr(known, name), rel=1e-6), name
    assert noise < 1e-9 * RATIO


@pytest.mark.parametrize("quality", [50.0, 300.0])
def test_gains_from_a_sweep_hold_the_plate_that_was_swept(quality: float) -> None:
    plate, noise = identified_plate(*sweep(quality, 0.005 * RATIO))
    gains = loop_gains(plate, replace(AIMS, noise=noise))
    blank = np.zeros(round(0.4 / STEP))
    rows = held(gains, true(quality), blank + 30e6, blank + F0, blank)[2000:]
    assert np.all(rows[:, MODE] == LOCKED)
    off = detuning(rows, quality)
    wrong = float(np.abs(rows[:, RE] / (RATIO * 30e6) - 1).max())
    print(f"Q {quality:g}: {100 * off:.2f} % of the half-bandwidth, {100 * wrong:.2f} % amplitude")
    assert off < 0.05
    assert wrong < 0.02
    assert np.ptp(rows[:, FREQUENCY]) < 0.02 * plate.half_bandwidth


def test_what_is_no_sweep_of_a_resonance_is_refused() -> None:
    f, response = sweep(100.0, 0.0)
    with pytest.raises(InputError, match="at least eight frequencies"):
        identified_plate(f[:7], response[:7])
    with pytest.raises(InputError, match=r"the shapes are \(80,\) and \(81,\)"):
        identified_plate(f, response[1:])
    with pytest.raises(InputError, match="at the sweep's end"):
        identified_plate(f[50:], response[50:])
    with pytest.raises(InputError, match="no single resonance"):
        identified_plate(*sweep(100.0, 0.3 * RATIO))
