"""What must hold for a twin whatever a host sends it, and in whatever pieces time is advanced."""

import random
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer, State
from squeezefilm.instruments.twin.device import TwinDevice
from squeezefilm.instruments.twin.hand import hand_from
from squeezefilm.instruments.twin.plant import Plant
from squeezefilm.instruments.twin.settings import PickupModel, PlateDrift, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.motion.estimator import SensorModel, sensor_stream

SETTINGS = TwinSettings(truth_period=100e-6, seed=9)
LIMITS = Limits(20.0, 10_000.0, 20.0, 100.0, 20e3, 30e3)


@lru_cache(maxsize=2)
def point(name: str = "winfield2007-tpad") -> WorkingPoint:
    return working_point(load_display(name), SETTINGS)


def twin(how: TwinSettings = SETTINGS, stroke: str = "60 mm in 0.75 s") -> TwinDevice:
    hand = hand_from(stroke, begin=0.01)
    return TwinDevice(load_display("winfield2007-tpad"), how, hand=hand, point=point())


class Host:
    """Sends messages to a twin and numbers them."""

    def __init__(self, device: TwinDevice) -> None:
        self.device, self.sequence = device, 0

    def send(self, *messages: m.Message) -> None:
        for message in messages:
            self.sequence += 1
            data = message.frame(self.sequence & 0xFFFF).encoded()
            self.device.receive(data, self.device.now)

    def start(self, ratio: float = 1.0) -> None:
        self.send(m.Hello(1), m.limits_message(LIMITS), m.Arm(self.device.machine.token))
        self.send(m.Start(round(point().mode.resonance_frequency * ratio * 1000)))
        assert self.device.machine.state is State.PLAYING


def session(seed: int) -> list[tuple[int, bytes]]:
    """Bytes at times (µs): a host that plays, with noise on the line."""
    dice, script, now = random.Random(seed), [], 0
    messages = [m.Hello(1), m.limits_message(LIMITS), m.Arm(SETTINGS.seed)]
    messages.append(m.Start(round(point().mode.resonance_frequency * 1000)))
    messages.append(m.Report(dice.choice((0, 200, 1_000, 3_333))))
    messages += [m.TileBegin(0, 2_000, 4), m.TileData(0, (3.0, 20.0, 0.0, 9.0))]
    for _ in range(12):
        if dice.random() < 0.2:
            messages.append(m.Follow())
            continue
        levels = tuple(dice.uniform(0, 20) for _ in range(dice.randint(1, 20)))
        messages.append(m.Envelope(dice.choice((130, 500, 2000)), levels))
    messages.append(m.Stop())
    for number, message in enumerate(messages, start=1):
        now += dice.randrange(12_000)
        data = message.frame(number).encoded()
        if dice.random() < 0.1:
            data = dice.randbytes(9) + b"\0" + data
        script.append((now, data))
    return script


@pytest.mark.slow
@settings(settings.get_profile("dear"))
@given(st.integers(0, 2**32), st.lists(st.integers(1, 30_000), max_size=40))
def test_the_same_bytes_give_the_same_truth_in_whatever_pieces(seed: int, cuts: list[int]) -> None:
    one, other = twin(), twin()
    looks = np.cumsum(cuts)
    said = [bytearray(), bytearray()]
    for now, data in session(seed):
        one.receive(data, now)
        said[0] += one.advance(now)
        for look in looks[(looks > other.now) & (looks < now)]:
            said[1] += other.advance(int(look))
            other.plant.sensed(), other.plant.pickup_level()
        for part in (data[:3], data[3:]):
            other.receive(part, now)
    said[0] += one.advance(250_000)
    said[1] += other.advance(250_000)
    assert said[0] == said[1]
    np.testing.assert_array_equal(one.truth.rows, other.truth.rows)
    assert one.plant.sensed() == other.plant.sensed()
    assert one.plant.pickup_level() == other.plant.pickup_level()


@pytest.mark.slow
@settings(settings.get_profile("dear"))
@given(st.integers(0, 2**32))
def test_amplitude_friction_and_force_stay_where_physics_lets_them(seed: int) -> None:
    device = twin()
    for now, data in session(seed):
        device.receive(data, now)
    device.advance(250_000)
    truth = device.truth
    mode, display = point().mode, point().display
    level, amplitude = truth.column("level_V"), truth.column("amplitude_m")
    assert np.all(amplitude <= np.maximum.accumulate(level) * mode.amplitude_per_volt * (1 + 1e-9))
    touched = truth.column("normal_force_N") > 0
    friction = truth.column("relative_friction")
    assert np.all(np.isnan(friction[~touched]))
    assert np.all((friction[touched] >= 0) & (friction[touched] <= 1))
    surface, force = display.surface(), truth.column("normal_force_N")
    # The finger's µ does not depend on the force, unless a shear strength makes it.
    assert display.finger.shear_strength is None
    most = force * display.finger.friction_coefficient(
        surface.friction_coefficient, surface.roughness, 0.5
    )
    assert np.all(np.abs(truth.column("tangential_force_N")) <= most * (1 + 1e-9) + 1e-12)
    assert device.plant.counts.failed == device.plant.counts.beyond == 0


@pytest.mark.slow
def test_the_same_bytes_with_another_seed_give_other_noise() -> None:
    a, b = twin(), twin(TwinSettings(truth_period=100e-6, seed=10))
    for device in (a, b):
        device.advance(300_000)
    np.testing.assert_array_equal(a.truth.rows[:, 1], b.truth.rows[:, 1])
    assert a.plant.sensed() != b.plant.sensed()


def test_a_silent_host_means_a_plate_at_rest() -> None:
    device = twin()
    host = Host(device)
    host.start()
    host.send(m.Envelope(1000, (20.0,)))
    last = device.now
    device.advance(200_000)
    time, level = device.truth.column("time_s"), device.truth.column("level_V")
    assert level.max() == 20.0
    assert time[np.flatnonzero(level)[-1]] <= last * 1e-6 + 0.060
    tau = point().mode.quality_factor / (np.pi * point().mode.resonance_frequency)
    after = time > 0.060 + 20 * tau
    assert np.all(device.truth.column("amplitude_m")[after] < 1e-12)


def test_the_sensor_reports_as_its_model_says() -> None:
    sensor = SensorModel("test", 1000.0, 8e-3, jitter=0.5e-3, noise=20e-6, loss=0.1)
    plant = Plant(point(), TwinSettings(sensor=sensor), hand_from("80 mm/s over 60 mm", begin=0.0))
    lag, wrong, times = [], [], np.arange(100_000, 700_000, 100)
    for now in times:
        plant.advance(int(now), 0, 0)
        x, _, touching = plant.sensed()
        taken = plant._n[1]
        lag.append(now - taken)
        wrong.append((int(taken), x * 1e-6))
        assert touching
    plant.drain()
    # Arrival after latency and jitter, then up to a period, longer where samples are lost.
    model = sensor_stream(sensor, lambda t: 0.08 * t, 30.0, seed=2)
    newest = np.searchsorted(model.arrival, np.arange(1, 29, 1e-3), side="right") - 1
    expected = np.mean(np.arange(1, 29, 1e-3) - model.taken[newest])
    assert np.mean(lag) * 1e-6 == pytest.approx(expected, rel=0.03)
    rows = plant.truth.rows
    seen = np.array(sorted(dict(wrong).items()))
    error = seen[:, 1] - np.interp(seen[:, 0] * 1e-6, rows[:, 0], rows[:, 1])
    assert np.std(error) == pytest.approx(20e-6, rel=0.15)
    assert abs(np.mean(error)) < 5 * 20e-6 / np.sqrt(error.size)
    assert plant.counts.lost / 700 == pytest.approx(0.1, abs=0.05)


@pytest.mark.parametrize("kind", ["motional_current", "sensing_patch"])
def test_the_pickup_reads_the_amplitude_within_its_noise(kind: str) -> None:
    still = PlateDrift(temperature_coefficient=0.0)
    for noise in (0.0, 1e-3):
        pickup = PickupModel(kind=kind, noise=noise)  # type: ignore[arg-type]
        plant = Plant(point(), TwinSettings(pickup=pickup, drift=still))
        plant.advance(20_000, 20_000_000, round(point().mode.resonance_frequency * 1000))
        metre = plant.pickup_calibration
        read = []
        for _ in range(200):
            plant.advance(plant.now + 100, 20_000_000, 0)
            read.append(plant.pickup_level() * 1e-6 * metre)
        half_a_count = 0.5e-6 * metre
        assert np.mean(read) == pytest.approx(
            plant.amplitude, abs=half_a_count + 5 * noise * metre / np.sqrt(200), rel=1e-6
        )
        assert np.std(read) == pytest.approx(noise * metre, rel=0.3, abs=half_a_count)
    assert Plant(point(), TwinSettings(pickup=PickupModel(kind="none"))).pickup_level() == 0


def test_it_reads_its_own_finger_and_plays_the_tile_under_it() -> None:
    device = twin(TwinSettings(truth_period=100e-6, pickup=PickupModel(noise=0.0)))
    host = Host(device)
    host.send(m.Hello(1), m.Report(500), m.AskInfo())
    device.advance(20_000)
    host.send(m.limits_message(LIMITS), m.Arm(device.machine.token))
    host.send(m.Start(round(point().mode.resonance_frequency * 1000)))
    size = 61  # a grating of 4 mm over the whole stroke
    host.send(m.TileBegin(0, 1_000, size))
    levels = tuple(20.0 if x // 2 % 2 else 0.0 for x in range(size))
    host.send(m.TileData(0, levels[:40]), m.TileData(40, levels[40:]), m.Follow())
    said = bytearray()
    while device.now < 700_000:
        said += device.advance(device.now + 20_000)
        host.send(m.KeepAlive())
    assert device.machine.refused == 0
    frames = [frame for frame in Deframer().take(bytes(said)) if frame is not None]
    read = [m.Reading.read(f.payload) for f in frames if f.type == m.Reading.TYPE]
    readings = [r for r in read if r is not None]
    times = np.array([r.time for r in readings])
    assert np.all(np.diff(times) == 500)
    truth = device.truth
    row = np.searchsorted(truth.column("time_s"), times * 1e-6 - 1e-9)
    # The reading is a touch panel's: a latency behind a finger at 150 mm/s, and 30 µm of noise.
    lag = np.abs(np.array([r.x for r in readings]) * 1e-6 - truth.column("x_m")[row])
    assert lag.max() < 0.16 * 20e-3 + 5 * 30e-6
    amplitude = np.array([r.pickup for r in readings]) * 1e-6 * device.plant.pickup_calibration
    np.testing.assert_allclose(amplitude, truth.column("amplitude_m")[row], atol=2e-9, rtol=1e-3)
    level = np.array([r.level for r in readings])
    settled = (np.diff(level, prepend=-1) == 0) & (np.diff(level, append=-1) == 0)
    assert settled.sum() > 300
    for reading, still in zip(readings, settled, strict=True):
        if still and reading.touching and reading.state == State.PLAYING:
            assert device.machine.tile.level(reading.x) == reading.level
        if still and not reading.touching:
            assert reading.level == 0
    assert level.max() == 20_000_000
    assert device.machine.late_ticks == 0


def test_time_only_rises() -> None:
    device = twin()
    device.advance(1000)
    with pytest.raises(InputError, match="only rises"):
        device.advance(999)
    with pytest.raises(InputError, match="only rises"):
        device.receive(b"", 0)
    with pytest.raises(InputError, match="was asked to go"):
        device.plant.advance(0, 0, 0)
