"""The resonance of a device, swept through its link on a simulated clock."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.virtual_play import VirtualStream

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.bench import resonance_sweep
from squeezefilm.instruments.bench.resonance_sweep import ResonanceSweep, peak, sweep_resonance
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.wire.frames import State
from squeezefilm.instruments.device.wire.link import Link
from squeezefilm.instruments.twin.device import TwinDevice
from squeezefilm.instruments.twin.hand import hand_from
from squeezefilm.instruments.twin.settings import PickupModel, PlateDrift, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ

DISPLAY = load_display("biet2008-plate")
SETTINGS = TwinSettings(sensor=LVDT_10_KHZ, pickup=PickupModel(kind="sensing_patch"))
VOLTS = 3.75


@pytest.fixture(scope="module")
def point() -> WorkingPoint:
    """The plate solved once."""
    return working_point(DISPLAY, SETTINGS)


def swept(
    point: WorkingPoint, stroke: str = "none", before: float = 0.0, **changed: object
) -> tuple[ResonanceSweep | None, TwinDevice]:
    settings = dataclasses.replace(SETTINGS, **changed)  # type: ignore[arg-type]
    hand = None if stroke == "none" else hand_from(stroke)
    twin = TwinDevice(DISPLAY, settings, point=point, hand=hand)
    stream = VirtualStream(twin)
    stream.wait(before)
    host = DeviceHost(Link(stream, stream.clock, stream.wait), session=7)
    mode = point.mode
    half = 2 * mode.resonance_frequency / mode.quality_factor
    found = sweep_resonance(
        host,
        DISPLAY.drive.limits(mode.resonance_frequency, VOLTS),
        mode.resonance_frequency + half * np.linspace(-1, 1, 41),
        VOLTS,
        settle=6e-3,
        wait=stream.wait,
    )
    return found, twin


def test_a_sweep_finds_the_plate_as_it_is_and_leaves_it_off(point: WorkingPoint) -> None:
    found, twin = swept(point)
    assert found is not None
    frequency, volts = found.peak
    mode = point.mode
    assert frequency == pytest.approx(mode.resonance_frequency, rel=5e-4)
    amplitude = volts / SETTINGS.pickup.sensitivity
    assert amplitude == pytest.approx(VOLTS * mode.amplitude_per_volt, rel=5e-3)
    assert not found.touched
    assert twin.machine.state is State.OFF
    assert twin.machine.level == 0
    # Never more than was asked.
    assert float(np.max(twin.truth.column("level_V"))) <= VOLTS * (1 + 1e-9)


def test_a_plate_that_is_off_shows(point: WorkingPoint) -> None:
    mode = point.mode
    weak, _ = swept(point, drift=PlateDrift(quality_factor_ratio=0.7))
    assert weak is not None
    ratio = weak.peak[1] / SETTINGS.pickup.sensitivity / (VOLTS * mode.amplitude_per_volt)
    assert ratio == pytest.approx(0.7, rel=0.01)
    detuned, _ = swept(point, drift=PlateDrift(offset=0.02))
    assert detuned is not None
    assert detuned.peak[0] == pytest.approx(1.02 * mode.resonance_frequency, rel=1e-3)
    far, _ = swept(point, drift=PlateDrift(offset=0.2))
    assert far is not None
    assert np.all(np.isnan(far.peak))


def test_what_cannot_be_swept_is_said(point: WorkingPoint, monkeypatch: pytest.MonkeyPatch) -> None:
    assert swept(point, pickup=PickupModel(kind="none"))[0] is None
    stroke = "60 mm/s over 4 cm"
    with monkeypatch.context() as impatient:
        impatient.setattr(resonance_sweep, "LIFT_LIMIT", 0.5)
        with pytest.raises(DeviceError, match=r"a finger was on the plate for 0\.5 s"):
            swept(point, stroke, before=0.5)
    # One that comes down in the middle of it.
    touched, _ = swept(point, stroke)
    assert touched is not None
    assert touched.touched


def test_a_carrier_outside_the_limits_is_refused(point: WorkingPoint) -> None:
    twin = TwinDevice(DISPLAY, SETTINGS, point=point)
    stream = VirtualStream(twin)
    host = DeviceHost(Link(stream, stream.clock, stream.wait), session=7)
    limits = DISPLAY.drive.limits(33e3, VOLTS)
    with pytest.raises(InputError, match="carriers"):
        sweep_resonance(host, limits, np.array([20e3, 33e3]), 1.0, settle=1e-3, wait=stream.wait)
    with pytest.raises(InputError, match="voltage"):
        sweep_resonance(host, limits, np.array([33e3, 33.1e3]), 4.0, settle=1e-3, wait=stream.wait)


def test_the_vertex_of_a_parabola_is_exact_between_its_samples() -> None:
    x = np.linspace(0.0, 1.0, 11)
    place, height = peak(x, 3.0 - 5.0 * (x - 0.437) ** 2)
    assert (place, height) == pytest.approx((0.437, 3.0), rel=1e-12)
    assert np.all(np.isnan(peak(x, x)))


class Host:
    """A device that sends these readings, one a look, on a clock of its own."""

    def __init__(self, *readings: Any) -> None:
        self.time, self.left = 0.0, list(readings)
        self.link = SimpleNamespace(clock=lambda: self.time)
        self.did: list[str] = []

    def wait(self, duration: float) -> None:
        self.time += duration

    def pump(self) -> None:
        """Nothing waits."""

    def poll(self) -> list[Any]:
        return [self.left.pop(0)] if self.left else []


def reading(fault: int = 0, touching: bool = False, pickup: float = 2e6) -> Any:
    return SimpleNamespace(fault=fault, touching=touching, pickup=pickup)


def test_a_fault_or_silence_ends_a_measurement_with_what_to_do() -> None:
    host: Any = Host(*[reading()] * 3)
    assert len(resonance_sweep._readings(host, 3, host.wait)) == 3
    host = Host(reading(), reading(fault=4), reading())
    with pytest.raises(DeviceError, match=r"was measured \(fault 4\); run `squeezefilm device"):
        resonance_sweep._readings(host, 3, host.wait)
    host = Host(reading())
    with pytest.raises(DeviceError, match=r"sent 1 of 3 readings in [\d.]+ s; look at its power"):
        resonance_sweep._readings(host, 3, host.wait)
    limit = resonance_sweep._DEAF_LIMIT
    assert limit < host.time <= limit + 2 * resonance_sweep.REPORT_PERIOD


def test_the_mean_square_leaves_out_what_came_while_the_plate_settled() -> None:
    count = resonance_sweep.READINGS
    late = reading(pickup=1e9)
    host: Any = Host(late, *[reading(pickup=3e6), reading(pickup=1e6, touching=True)] * count)
    square, touched = resonance_sweep._mean_square(host, 5e-3, host.wait)
    # Microvolts: 3 V and 1 V in turn.
    threes = (count + 1) // 2
    assert square == pytest.approx((9 * threes + (count - threes)) / count)
    assert touched
    assert host.time >= 5e-3 + count * resonance_sweep.REPORT_PERIOD
    still: Any = Host(late, *[reading()] * count)
    assert resonance_sweep._mean_square(still, 5e-3, still.wait) == (pytest.approx(4.0), False)


def test_a_device_that_fails_is_stopped_before_that_is_told() -> None:
    """Whether or not it still hears that."""
    limits = DISPLAY.drive.limits(33e3, VOLTS)
    for deaf in (False, True):
        did: list[str] = []

        def stop(deaf: bool = deaf, did: list[str] = did) -> None:
            did.append("stopped")
            if deaf:
                raise DeviceError("it hears nothing")

        def arm() -> None:
            raise DeviceError("it faulted")

        host: Any = Host(reading())
        host.open = lambda _: SimpleNamespace(has_pickup=True)
        host.report, host.arm, host.stop = lambda _: None, arm, stop
        carriers = np.array([33e3, 33.1e3])
        with pytest.raises(DeviceError, match="it faulted"):
            sweep_resonance(host, limits, carriers, 1.0, settle=1e-3, wait=host.wait)
        assert did == ["stopped"]
