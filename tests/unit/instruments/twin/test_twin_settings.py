"""Settings from TOML, noise by number, the hand's schedule, the record of the truth."""

import math
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.instruments.twin import plant
from squeezefilm.instruments.twin.hand import Hand, hand_from, wanted
from squeezefilm.instruments.twin.plant import TruthRecord
from squeezefilm.instruments.twin.plant_kernel import COLUMNS, gaussian, uniform
from squeezefilm.instruments.twin.settings import (
    PickupModel,
    PlateDrift,
    TwinAmplifier,
    TwinArm,
    TwinSettings,
    load_settings,
)
from squeezefilm.physics.render.motion.stroke import FingerPath, Stroke


def test_settings_come_from_a_file_and_say_what_is_assumed(tmp_path: Path) -> None:
    file = tmp_path / "twin.toml"
    file.write_text(
        'seed = 4\ntick = "200 us"\n'
        '[amplifier]\nhighest_current = "300 mA"\nevidence = "data sheet"\n'
        '[sensor]\nname = "mine"\nrate = "1 kHz"\nlatency = "1 ms"\nnoise = "5 um"\n'
        '[pickup]\nkind = "sensing_patch"\n',
        encoding="utf-8",
    )
    read = load_settings(file)
    assert (read.seed, read.tick_us, read.amplifier.highest_current) == (4, 200, 0.3)
    assert (read.sensor.rate, read.pickup.kind) == (1000.0, "sensing_patch")
    assert read.amplifier.evidence == "data sheet"
    parts = (read.drift, read.arm, read.sensor, read.pickup, TwinSettings().amplifier)
    assert all(part.evidence == "assumed" for part in parts)
    file.write_text('[drift]\noffsett = "1"\n', encoding="utf-8")
    with pytest.raises(ConfigError, match="Did you mean 'offset'"):
        load_settings(file)
    file.write_text('[pickup]\nkind = "ear"\n', encoding="utf-8")
    with pytest.raises(ConfigError, match="motional_current"):
        load_settings(file)


def test_the_settings_on_the_page_are_the_defaults(tmp_path: Path) -> None:
    page = (Path(__file__).parents[4] / "docs" / "reference" / "twin.md").read_text(
        encoding="utf-8"
    )
    file = tmp_path / "twin.toml"
    file.write_text(page.split("```toml\n")[1].split("```")[0], encoding="utf-8")
    read, default = load_settings(file), TwinSettings()
    for part in ("seed", "tick", "drift", "amplifier", "arm", "pickup"):
        assert getattr(read, part) == getattr(default, part)
    for number in ("rate", "latency", "noise"):
        assert getattr(read.sensor, number) == getattr(default.sensor, number)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: TwinSettings(tick=99.5e-6), "whole number of microseconds"),
        (lambda: TwinSettings(steps_per_tick=3), "does not divide"),
        (lambda: TwinSettings(truth_period=150e-6), "whole number of ticks"),
        (lambda: TwinSettings(seed=-1), "seed"),
        (lambda: PlateDrift(thermal_time=0.0), "thermal_time"),
        (lambda: TwinAmplifier(capacitance=0.0), "capacitance"),
        (lambda: TwinArm(mass=0.0), "mass"),
        (lambda: PickupModel(shunt=0.0), "shunt"),
        (lambda: PickupModel(kind="ear"), "kind = 'ear' is not known"),  # type: ignore[arg-type]
        (lambda: hand_from("60 mm/s over 4 cm", normal_force=0.0), "normal_force"),
        (lambda: hand_from("fast"), "no stroke"),
    ],
)
def test_what_cannot_be_used_is_refused(make: object, says: str) -> None:
    with pytest.raises(InputError, match=says):
        make()  # type: ignore[operator]


def test_noise_by_number_is_normal_and_its_streams_are_independent() -> None:
    n = 20_000
    u = np.array([uniform(3, 1, i) for i in range(n)])
    g = np.array([gaussian(3, 1, i) for i in range(n)])
    other = np.array([gaussian(3, 2, i) for i in range(n)])
    seeded = np.array([gaussian(4, 1, i) for i in range(n)])
    assert u.min() > 0
    assert u.max() < 1
    # Five standard errors each.
    assert abs(u.mean() - 0.5) < 5 * math.sqrt(1 / 12 / n)
    assert abs(g.mean()) < 5 / math.sqrt(n)
    assert abs(g.std() - 1) < 5 / math.sqrt(2 * n)
    for one, two in ((g[:-1], g[1:]), (g, other), (g, seeded)):
        assert abs(np.corrcoef(one, two)[0, 1]) < 5 / math.sqrt(n)
    assert abs(float(np.mean(np.abs(g) > 1.96)) - 0.05) < 5 * math.sqrt(0.05 * 0.95 / n)
    assert gaussian(3, 1, 77) == g[77]


def test_the_hand_presses_goes_back_and_forth_and_lifts() -> None:
    hand = Hand(Stroke(0.1, 0.04), 0.5, begin=0.2, press=0.05)
    places, plan = hand.path(100)
    at = lambda seconds: wanted(round(seconds * 1e6), places, plan)  # noqa: E731
    assert at(0.1) == (0.0, 0.0, 0.0)
    assert at(0.225)[2] == pytest.approx(0.5)
    assert at(0.3) == pytest.approx((0.01, 0.0, 1.0))
    assert at(0.2 + 0.4 + 0.1)[0] == pytest.approx(0.03)  # on the way back
    assert at(0.2 + 0.8 + 0.1)[0] == pytest.approx(0.01)  # and there again
    hopping = Hand(Stroke(0.1, 0.04), 0.5, begin=0.0, lift=0.6)
    places, plan = hopping.path(100)
    assert wanted(700_000, places, plan) == pytest.approx((0.04, 0.0, 0.0))
    assert wanted(1_200_000, places, plan)[0] == pytest.approx(0.02)
    far = wanted(1_200_000 + 2_000_000 * 10**6, places, plan)
    assert far == wanted(1_200_000, places, plan)  # after a million cycles to and fro, still exact


def test_a_drawn_path_is_followed_in_the_plane_and_a_closed_one_goes_round() -> None:
    t = np.linspace(0, 1, 101)
    ring = FingerPath(t, 0.01 * np.cos(2 * np.pi * t), 0.01 * np.sin(2 * np.pi * t))
    places, plan = Hand(ring, begin=0.0).path(100)
    for k in range(3):
        x, y, _ = wanted(k * 1_000_000 + 250_000, places, plan)
        assert (x, y) == pytest.approx((0.0, 0.01), abs=1e-9)
    slow = FingerPath(np.array([0.0, 1000.0]), np.array([0.0, 0.1]), np.zeros(2))
    places, plan = Hand(slow, begin=0.0).path(100)
    assert places.shape[1] <= 2_000_001
    assert wanted(500_000_000, places, plan)[0] == pytest.approx(0.05, rel=1e-9)


def test_the_truth_keeps_its_newest_rows_and_the_file_keeps_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plant, "KEPT", 5)
    record = TruthRecord(tmp_path / "truth.csv")
    rows = np.arange(12 * len(COLUMNS), dtype=float).reshape(12, -1) / 7
    record.append(rows[:3])
    np.testing.assert_array_equal(record.rows, rows[:3])
    record.append(rows[3:4])
    record.append(rows[4:])
    record.close()
    np.testing.assert_array_equal(record.rows, rows[-5:])
    read = np.loadtxt(tmp_path / "truth.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(read, rows)
    with pytest.raises(InputError, match="no column"):
        record.column("x")
    with pytest.raises(InputError, match="cannot write"):
        TruthRecord(tmp_path / "nowhere" / "truth.csv")
