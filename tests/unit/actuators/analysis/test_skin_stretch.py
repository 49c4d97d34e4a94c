"""What `analyze` says of a skin-stretch array is what its room computes."""

from __future__ import annotations

import dataclasses
import json
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from tests.shared import shared

from squeezefilm.actuators.analysis import drawn
from squeezefilm.actuators.analysis import skin_stretch as room
from squeezefilm.actuators.analysis.skin_stretch import (
    SkinStretchAnalysis,
    _warnings,
    analyze_skin_stretch,
)
from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.report.page import analyze_actuator
from squeezefilm.actuators.skin_stretch.array import SkinStretchDescription
from squeezefilm.core.errors import OutOfRangeError

DESCRIBED = load_actuator("biet2008-skin-stretch")


assert isinstance(DESCRIBED, SkinStretchDescription)
ARRAY = DESCRIBED.skin_stretch
COLUMNS, ROWS = 5, 3
SMALL = dataclasses.replace(
    DESCRIBED,
    skin_stretch=dataclasses.replace(
        ARRAY, cradle=dataclasses.replace(ARRAY.cradle, columns=COLUMNS, rows=ROWS)
    ),
)


@pytest.fixture(scope="module", params=["small", pytest.param("whole", marks=pytest.mark.slow)])
def found(request: pytest.FixtureRequest) -> SkinStretchAnalysis:
    """The array as described, and fifteen contactors of it, of which few are drawn."""
    if request.param == "small":
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(drawn, "COUNT", 8)
            # Of the skin alone: an actuator that is drawn is solved.
            skin = {path: usual for path, usual in room._USUAL.items() if ".tissue." in path}
            patch.setattr(room, "_USUAL", skin)
            return analyze_skin_stretch(SMALL)
    found = shared(DESCRIBED.name, lambda: analyze_actuator(DESCRIBED.name)).analysis
    assert isinstance(found, SkinStretchAnalysis)
    return found


def test_load_line_and_skin_meet_where_both_say(found: SkinStretchAnalysis) -> None:
    tip, stiffness = found.tip, found.skin.stiffness
    assert tip.force == pytest.approx(stiffness * tip.deflection)
    share = tip.deflection / found.free_deflection
    assert tip.force == pytest.approx(found.blocked_force * (1 - share))
    assert abs(found.motion[0]) == pytest.approx(tip.deflection, rel=1e-4)


def test_the_power_is_that_of_every_actuator(found: SkinStretchAnalysis) -> None:
    heat, burnt = found.power
    bender, voltage, count = found.array.bender, found.voltage, found.array.cradle.count
    tangent = found.array.actuator.loss_tangent
    assert heat == pytest.approx(count * np.pi * 100.0 * bender.capacitance * tangent * voltage**2)
    assert burnt == pytest.approx(count * bender.capacitance * (2 * voltage) ** 2 * 100.0)


def test_the_wave_moves_with_the_finger(found: SkinStretchAnalysis) -> None:
    """A quarter of a period later the strain is what it was a quarter of a wave further on."""
    wave = found.wave
    frames = wave.times.size
    assert wave.strain.shape[0] == frames == wave.displacements.shape[0]
    np.testing.assert_allclose(
        wave.strain[frames // 2], -wave.strain[0], atol=1e-4 * np.abs(wave.strain).max()
    )
    np.testing.assert_allclose(wave.displacements[0], wave.pull.displacements, rtol=1e-9)
    assert np.count_nonzero(wave.slips[0]) == wave.pull.slipping
    assert np.array_equal(wave.slips[0], wave.slips[frames // 2])


def test_what_slips_is_warned_of_and_json_has_units(found: SkinStretchAnalysis) -> None:
    slipping = found.wave.pull.slipping
    assert any(f"{slipping} of" in text for text in found.warnings) == (slipping > 0)
    told = json.loads(json.dumps(found.summary(), allow_nan=False))
    assert told["deflection_on_skin_m"] == found.tip.deflection
    assert told["deflection_on_skin_m"] == found.tip.deflection
    array, count = found.array, found.array.cradle.count
    assert told["lines"]["direct"] == count + 1
    assert told["free_deflection_m"] == found.voltage * array.bender.deflection_per_volt
    assert told["blocked_force_N"] == found.voltage * array.bender.force_per_volt
    assert found.voltage == told["largest_voltage_V"]
    assert told["largest_strain_of_the_wave"] == np.abs(found.wave.strain).max()
    assert told["cradle_radii_across_m"] == list(found.radii or ())
    for name in ("heat_at_100_Hz_W", "driver_power_at_100_Hz_W"):
        assert told[name] > 0
    # ½ (2V)² C f for each: a driver swings from one voltage to the other and back.
    assert told["contactors_that_touch"] == count
    assert found.least_force is not None
    assert 0 < found.least_force <= array.normal_force
    assert found.radii is not None
    assert found.radii[0] < (array.cradle.radius_across or 1.0) <= found.radii[1]


def test_what_is_drawn_scatters_about_what_is_described(found: SkinStretchAnalysis) -> None:
    told = found.summary()
    for name, (low, middle, high) in found.drawn.intervals.items():
        assert low <= middle <= high
        assert low <= told[name] <= high


def test_the_skin_is_as_stiff_as_its_modulus(found: SkinStretchAnalysis) -> None:
    paths = [value.path for value in found.drawn.drawn]
    share = found.drawn.shares["skin_stiffness_N_per_m"]
    assert share[paths.index("skin_stretch.tissue.shear_modulus")] > 0.7


def test_a_voltage_that_undoes_the_poling_is_refused() -> None:
    with pytest.raises(OutOfRangeError, match="poling"):
        analyze_skin_stretch(DESCRIBED, voltage=400.0)


def test_what_contactors_do_not_do_is_said() -> None:
    array: Any = SimpleNamespace(
        cradle=SimpleNamespace(count=60),
        budget=SimpleNamespace(over=("The drive takes more than it may.",)),
        normal_force=0.5,
    )
    still, slipping = SimpleNamespace(slipping=0), SimpleNamespace(slipping=7)
    seating: Any = SimpleNamespace(touching=60)
    wave: Any = SimpleNamespace(pull=slipping)
    said = _warnings(array, cast(Any, still), wave, seating, 0.8)
    assert said[0] == "The drive takes more than it may."
    assert [text for text in said if text.startswith("7 of 60 contactors slip where the wave")]
    assert len(said) == 2
    seating.touching = 41
    (*_, last) = _warnings(array, cast(Any, still), wave, seating, 0.8)
    assert last == "41 of 60 contactors touch under 0.5 N; 0.8 N would seat all."
