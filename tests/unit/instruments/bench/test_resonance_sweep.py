"""The resonance of a device, swept through its link on a simulated clock."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.bench import resonance_sweep
from squeezefilm.instruments.bench.resonance_sweep import ResonanceSweep, peak, sweep_resonance
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.wire.link import Link
from squeezefilm.instruments.device.wire.states import State
from squeezefilm.instruments.session.play.simulated import VirtualStream
from squeezefilm.instruments.twin.device import TwinDevice
from squeezefilm.instruments.twin.hand import hand_from
from squeezefilm.instruments.twin.settings import PickupModel, PlateDrift, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.motion.sensor import LVDT_10_KHZ

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
