"""The finger: what the loads, surfaces and moistures do to its contact, and that old files load."""

import dataclasses
import math
from pathlib import Path

import pytest

from squeezefilm.core import presets
from squeezefilm.core.config import load
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.finger.fingertip import Finger, Skin
from squeezefilm.physics.contact.rough_contact import RoughContact
from squeezefilm.physics.display import Display, load_display

FINGER = Finger(10e-3, 50e-6, 350e-6, 0.5)


def test_the_area_grows_with_the_load() -> None:
    assert FINGER.contact_area() == pytest.approx(1e-4)
    assert FINGER.contact_area(4.0) == pytest.approx(2e-4)
    assert FINGER.plateau_pressure() == pytest.approx(7e3)
    fixed = dataclasses.replace(FINGER, contact_area_exponent=0.0)
    assert fixed.contact_area(2.0) == fixed.contact_area(0.1) == pytest.approx(1e-4)
    soft = dataclasses.replace(FINGER, contact_area_exponent=0.5, contact_area_force=1.0)
    assert soft.contact_area(1.0) == pytest.approx(1e-4)
    assert soft.contact_area(4.0) == pytest.approx(2e-4)
    assert soft.plateau_pressure(4.0) == pytest.approx(2 * soft.plateau_pressure(1.0))


def test_the_asperity_law_is_as_given_on_its_own_roughness_and_scales_elsewhere() -> None:
    assert FINGER.asperity_law(0.6e-6) == RoughContact()
    rough = FINGER.asperity_law(0.0)
    assert rough.decay_length == pytest.approx(RoughContact().decay_length / math.sqrt(2))
    apart = dataclasses.replace(FINGER, asperities=AsperityLaw())
    assert apart.asperity_law(0.6e-6) == AsperityLaw()
    smooth = apart.asperity_law(0.0)
    assert smooth.decay_length == pytest.approx(0.6e-6 / math.sqrt(2))
    assert isinstance(smooth, AsperityLaw)
    assert smooth.reference_gap == pytest.approx(2e-6 / math.sqrt(2))
    bare = dataclasses.replace(apart, skin_roughness=0.0)
    assert bare.asperity_law(0.3e-6).decay_length == pytest.approx(0.3e-6)
    with pytest.raises(InputError, match="perfectly smooth"):
        bare.asperity_law(0.0)


def test_the_contact_s_law_holds_up_to_a_force() -> None:
    finger = Finger(10e-3, 50e-6, 350e-6, 0.5)
    most = finger.largest_force(0.6e-6)
    ends = finger.asperity_law(0.6e-6).largest_pressure
    assert finger.plateau_pressure(most) == pytest.approx(ends)
    # Where the area keeps up with the force the pressure never gets there, or is always beyond.
    for exponent in (0.999, 1.0):
        wide = dataclasses.replace(finger, contact_area_exponent=exponent)
        assert wide.largest_force(0.6e-6) == 1e4
    hard = dataclasses.replace(finger, contact_area_exponent=1.0, normal_force=50.0)
    assert hard.largest_force(0.6e-6) == 0.0


def test_moisture_softens_and_grips() -> None:
    dry, moist = (dataclasses.replace(FINGER, moisture=m) for m in ("dry", "moist"))
    pressures = [f.asperity_law(0.6e-6).pressure(2e-6) for f in (moist, FINGER, dry)]
    assert pressures == sorted(pressures)
    grip = [f.friction_coefficient(0.5, 0.6e-6) for f in (dry, FINGER, moist)]
    assert grip == sorted(grip)
    assert grip[1] == 0.5


def test_friction_of_a_shear_strength_is_that_of_the_real_contact_area() -> None:
    law = RoughContact()
    strong = dataclasses.replace(FINGER, shear_strength=1e6, contact_area_exponent=0.0)
    # In proportion to a small load, so that the coefficient is τ √(8/π)/(E* h'): no surface's.
    light = 1e6 * math.sqrt(8 / math.pi) / (law.modulus * law.rms_slope)
    assert strong.friction_coefficient(0.5, 0.6e-6, 1e-3) == pytest.approx(light, rel=1e-4)
    few = strong.friction_coefficient(0.5, 0.6e-6, 50.0)
    pressure = strong.plateau_pressure(50.0)
    assert few == pytest.approx(1e6 * law.contact_ratio(pressure) / pressure)
    assert few < 0.9 * light
    with pytest.raises(InputError, match="real contact area"):
        dataclasses.replace(strong, asperities=AsperityLaw())


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"contact_area_exponent": 1.5}, "contact_area_exponent"),
        ({"moisture": "wet"}, "moisture = 'wet'"),
        ({"ridge_angle": 4.0}, "ridge_angle"),
        ({"plateau_width": 400e-6}, "plateau_width"),
        ({"contact_area_force": 0.0}, "contact_area_force"),
    ],
)
def test_what_no_finger_has_is_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        dataclasses.replace(FINGER, **changes)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="mass_per_area"):
        Skin(mass_per_area=0.0)


def test_a_display_file_may_say_more_of_the_finger_and_need_not(tmp_path: Path) -> None:
    assert load_display("biet2008-stator").finger.asperities == RoughContact()
    text = presets.path("biet2008-stator").read_text(encoding="utf-8")
    more = (
        'moisture = "dry"\nridge_angle = "90 deg"\ncontact_area_exponent = 0.4\n'
        '[finger.asperities]\ntype = "separate_asperities"\nreference_gap = "1.5 um"\n'
        'heights = "gaussian"\n'
        '[finger.skin]\nmass_per_area = "2 kg/m2"\n\n[gas]'
    )
    file = tmp_path / "mine.toml"
    file.write_text(text.replace("[gas]", more), encoding="utf-8")
    finger = load(Display, file).finger
    assert finger.asperities == AsperityLaw(reference_gap=1.5e-6, heights="gaussian")
    assert finger.skin == Skin(mass_per_area=2.0)
    assert finger.ridge_angle == pytest.approx(math.pi / 2)
    kind = 'type = "separate_asperities"'
    file.write_text(text.replace("[gas]", f'[finger.asperities]\n{kind}\nheight = "1 um"\n[gas]'))
    with pytest.raises(ConfigError, match="Did you mean 'heights'"):
        load(Display, file)


def test_skin_moves_by_its_mass_spring_and_damper() -> None:
    skin = Skin(3.0, 2e10, 4e5)
    omega = 2 * math.pi * 30e3
    stiffness = complex(2e10 - 3.0 * omega**2, 4e5 * omega)
    assert skin.dynamic_stiffness(30e3) == pytest.approx(stiffness)
    with pytest.raises(InputError, match="frequency"):
        skin.dynamic_stiffness(0.0)
