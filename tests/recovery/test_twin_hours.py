"""Hours of a twin's time: nothing drifts, grows or loses its phase, over wraps of the clock.

The device's clock is 32 bits of µs and wraps every 71.6 minutes. A finger comes down once a
minute, to and fro; every session that plays to it must have the truth of the first, at its time.
"""

import gc
import tracemalloc

import numpy as np
import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.instruments.device.machine.playing import CLOCK
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import State
from squeezefilm.instruments.twin import plant
from squeezefilm.instruments.twin.device import TwinDevice
from squeezefilm.instruments.twin.hand import hand_from
from squeezefilm.instruments.twin.settings import PlateDrift, TwinSettings
from squeezefilm.physics.display import load_display

SECOND = 1_000_000
CYCLE = 120 * SECOND  # there and, a minute later, back
LENGTH = 2 * SECOND
STEADY = PlateDrift(temperature_coefficient=0.0)
LIMITS = Limits(140.0, 50_000.0, 140.0, 1e5, 30e3, 50e3, insulation="glass")


def twin(tick: float) -> TwinDevice:
    settings = TwinSettings(
        tick=tick, truth_period=tick, steps_per_tick=round(tick / 100e-6),
        drift=STEADY,
    )  # fmt: skip
    hand = hand_from("60 mm in 0.75 s", begin=0.5, lift=59.25)
    return TwinDevice(load_display("biet2008-stator"), settings, hand=hand)


class Sessions:
    """Plays the same session again and again, from when the finger lands."""

    def __init__(self, device: TwinDevice) -> None:
        self.device, self.sequence = device, 0

    def send(self, message: m.Message) -> None:
        self.sequence = (self.sequence + 1) & 0xFFFF
        self.device.receive(message.frame(self.sequence).encoded(), self.device.now)
        assert self.device.machine.refused == 0

    def play(self, begin: int) -> np.ndarray:
        """One session from `begin` (µs); its truth, with times counted from there."""
        device = self.device
        device.advance(begin)
        for message in (m.Hello(1), m.limits_message(LIMITS), m.Arm(device.machine.token)):
            self.send(message)
        self.send(m.Start(40_500_000))
        while device.now < begin + LENGTH:
            # Two levels per 20 ms, told anew all the time, as a host does.
            self.send(m.Envelope(5_000, (140.0, 35.0, 140.0, 0.0)))
            device.advance(device.now + 20_000)
        assert device.machine.state is State.PLAYING
        self.send(m.Stop())
        device.advance(begin + LENGTH + SECOND)
        assert device.machine.state is State.OFF
        rows = device.truth.rows
        rows = rows[(rows[:, 0] > begin / SECOND) & (rows[:, 0] <= (begin + LENGTH) / SECOND)]
        rows[:, 0] = np.round(rows[:, 0] * SECOND - begin) / SECOND
        return rows


def assert_same(one: np.ndarray, other: np.ndarray) -> None:
    assert one.shape == other.shape
    assert np.nanmax(one[:, 8]) > 0.1  # the finger is there, and slides
    assert np.ptp(one[:, 6]) > 1e-6
    # Times and levels exactly; the finger comes to rest in the air between, to rounding.
    np.testing.assert_array_equal(one[:, [0, 4, 5]], other[:, [0, 4, 5]])
    np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)


@pytest.mark.slow
def test_a_session_across_the_wrap_of_the_clock_is_like_any_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(plant, "KEPT", 4000)
    device = twin(1e-3)
    sessions = Sessions(device)
    # The finger is back in the same phase each two minutes, and down for the clock's wrap.
    wrap = (CLOCK + 1) // CYCLE * CYCLE
    first = sessions.play(CYCLE)
    assert wrap + LENGTH < CLOCK + 1 < wrap + CYCLE
    sessions.play(wrap)
    device.advance(CLOCK - SECOND)
    later = sessions.play(CLOCK + 1 - SECOND)  # playing while the clock wraps
    assert np.all(np.diff(later[:, 0]) > 0)
    assert later[:, 4].max() == 140.0
    again = sessions.play(wrap + CYCLE)
    assert_same(first, again)
    assert device.plant.counts.failed == 0


@pytest.mark.parametrize(
    "hours",
    [
        pytest.param(2, marks=pytest.mark.nightly),  # over a wrap of the clock
        pytest.param(8, marks=pytest.mark.campaign),
    ],
)
def test_hours_end_as_they_began(hours: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plant, "KEPT", 4000)
    tracemalloc.start()
    device = twin(1e-3)
    sessions = Sessions(device)
    hour, ticks = 3600 * SECOND, 30 * CYCLE
    assert hour == ticks
    first = sessions.play(CYCLE)
    sessions.play(CYCLE + hour)
    gc.collect()
    before, _ = tracemalloc.get_traced_memory()
    for k in range(2, hours + 1):
        assert_same(first, sessions.play(CYCLE + k * hour))
    gc.collect()
    after, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert after - before < 200_000
    assert device.now > hours * hour
    assert device.plant.counts.failed == 0
    # The carrier's frequency and the plate's are what they were, to the last bit.
    fresh = twin(1e-3)
    fresh.advance(SECOND)
    assert device.plant.resonance_frequency == fresh.plant.resonance_frequency
