"""The chain: what depends on what, which model is named, and what is refused."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import brentq

from squeezefilm.core.errors import (
    ContradictionError,
    InputError,
    OutOfRangeError,
    UnreachableError,
)
from squeezefilm.physics.chain.friction import FrictionLaw, friction_law
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.chain.wanted_voltage import voltage_for_friction
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import RectangularPlate


@pytest.fixture(scope="module")
def plate() -> Display:
    return load_display("biet2008-plate")


def test_no_vibration_leaves_friction_as_it_is(plate: Display) -> None:
    still = predict(plate, voltage=0.0)
    assert still.relative_friction == pytest.approx(1, abs=1e-12)
    assert still.mean_pressure == pytest.approx(1, abs=1e-12)
    assert still.friction_reduction == pytest.approx(0, abs=1e-12)


def test_amplitude_is_linear_in_the_voltage_and_falls_off_resonance(plate: Display) -> None:
    full, half = predict(plate), predict(plate, voltage=7.5)
    assert half.touch.free_amplitude == pytest.approx(full.touch.free_amplitude / 2)
    # The finger takes more of a small amplitude, which leaves it a smaller gap.
    assert half.vibration_amplitude < full.vibration_amplitude / 2
    assert half.relative_friction > full.relative_friction
    off = predict(plate, frequency=1.01 * full.mode.resonance_frequency)
    # 1/√(Q²(1−1.01²)²+1) with Q = 60 for this mode alone; its neighbours add a few percent
    alone = 1 / np.sqrt((60 * (1.01**2 - 1)) ** 2 + 1)
    assert off.vibration_amplitude / full.vibration_amplitude == pytest.approx(alone, rel=0.06)
    # ... in the beam far less, whose neighbours are further.
    beam = predict(plate, theory="timoshenko").frequency
    full, off = (predict(plate, theory="timoshenko", frequency=f * beam) for f in (1, 1.01))
    assert off.vibration_amplitude / full.vibration_amplitude == pytest.approx(alone, rel=0.03)


def test_the_models_are_named(plate: Display, stator: Display) -> None:
    assert predict(plate).amplitude_model == "piezoelectric_solid_3d"
    assert predict(plate, theory="timoshenko").amplitude_model == "timoshenko_beam_plane_strain"
    assert predict(plate, theory="euler_bernoulli").amplitude_model.startswith("euler_bernoulli")
    assert predict(stator).amplitude_model == "measured_stator"
    assert predict(stator, vibration_amplitude=1e-6).amplitude_model == "given"
    for model in ("paper2008", "paper2008-printed", "levitation-2016"):
        assert predict(stator, model=model).model == model  # type: ignore[arg-type]


def test_the_paper_s_model_gives_the_corrected_number(stator: Display) -> None:
    paper = predict(stator, model="paper2008")
    assert paper.validity.failed
    assert paper.mean_pressure_error == 0
    assert paper.relative_friction == pytest.approx(0.702, abs=5e-4)


def test_the_levitation_of_2016_is_its_own_balance(stator: Display) -> None:
    """Solved for the lift itself: skin of 5 µm, a length of 2 µm, the finger's own pressure."""
    law = predict(stator, model="levitation-2016", position=0.0).law
    pressure, ambient = 0.5 / stator.finger.contact_area(0.5), stator.gas.ambient_pressure
    rest = 2e-6 * np.log(500e3 / pressure)
    met, shares = law.ridge_swings
    for amplitude in (0.5e-6, 2e-6):
        left = 0.0
        for share, ridge in zip(shares, met * amplitude, strict=True):

            def excess(lift: float, ridge: float = ridge) -> float:
                film = 1.25 * ambient * ridge**2 / (rest + lift) ** 2
                return float(pressure * -np.expm1(-lift / 2e-6) - film)

            left += share * np.exp(-brentq(excess, 0.0, 1e-3, xtol=1e-18) / 2e-6)
        assert law.at(amplitude) == pytest.approx(left, abs=2e-5)
    slow, fast = law.over_speeds(np.array([2e-6]), np.array([0.01, 0.2]))
    assert slow == fast


def test_the_film_lifts_the_contact_off_by_default(stator: Display, plate: Display) -> None:
    for display in (stator, plate):
        p = predict(display)
        assert p.model == "levitation"
        # Film and contact carry the finger between them.
        pressure = p.normal_force / display.finger.contact_area(p.normal_force)
        lifted = (p.mean_pressure - 1) * display.gas.ambient_pressure / pressure
        assert lifted == pytest.approx(1 - p.relative_friction)
        # A slow finger is lifted by less; beyond the measured speeds nothing is known to change.
        slow, fast, faster = (predict(display, speed=v).relative_friction for v in (0.01, 0.2, 3.0))
        assert slow < p.relative_friction < fast == faster
        assert p.relative_friction_limits is not None
        own, tied = p.relative_friction_limits
        assert own == p.relative_friction
        # One film over the whole contact meets its root mean square, and friction is convex.
        assert own - 0.1 < tied < own


def test_film_and_asperities_share_the_load_where_a_rival_is_asked_for(
    stator: Display, plate: Display
) -> None:
    for display in (stator, plate):
        p = predict(display, model="partial-levitation")
        sharing = p.touch.sharing
        assert sharing is not None
        assert p.relative_friction == pytest.approx(float(sharing.relative_friction[0]))
        assert p.relative_friction == pytest.approx(1 - float(sharing.film_share[0]), abs=1e-6)
        # No speed enters.
        assert predict(display, speed=0.01, model=p.model).relative_friction == p.relative_friction
        assert p.relative_friction_limits is not None
        own, tied = p.relative_friction_limits
        assert own == pytest.approx(p.relative_friction)
        # A stiff pad hangs on its antinodes; a soft one sinks into the nodes.
        assert tied < own
        assert p.tangential_force == pytest.approx(
            p.friction_coefficient * p.relative_friction * p.normal_force
        )


def test_a_stiff_pad_out_of_range_does_not_take_the_friction_with_it() -> None:
    p = predict("biet2008-stator", vibration_amplitude=45e-6, model="partial-levitation")
    with pytest.raises(OutOfRangeError, match="pressed through"):
        p.law.friction_in("one-gap", np.array([45e-6]))
    assert p.relative_friction_limits is None
    assert p.relative_friction == pytest.approx(float(p.law.sharing(45e-6).relative_friction[0]))
    assert [one for one in p.warnings if "all ridges hang on one mean gap is out" in one]


def test_the_finger_takes_some_of_the_vibration_of_a_plate(plate: Display) -> None:
    p = predict(plate)
    assert p.touch.mode is not None
    assert p.vibration_amplitude == p.touch.amplitude
    assert 0.9 < p.touch.kept < 1
    # Where the amplitude is given, it is the one with the finger on.
    given = predict(plate, vibration_amplitude=p.vibration_amplitude)
    assert given.touch.kept == pytest.approx(p.touch.kept, rel=1e-9)
    assert given.relative_friction == pytest.approx(p.relative_friction, rel=1e-9)
    # A heavier touch takes more.
    assert predict(plate, normal_force=2.0).touch.kept < p.touch.kept


def test_only_a_measured_amplitude_leaves_out_what_a_finger_takes(
    plate: Display, stator: Display
) -> None:
    says = "what a finger takes from it is not known"
    assert [says in one for one in predict(stator).warnings].count(True) == 1
    for other in (predict(stator, vibration_amplitude=1e-6), predict(plate)):
        assert not any(says in one for one in other.warnings)


def test_the_voltage_for_a_friction_gives_that_friction(plate: Display, stator: Display) -> None:
    for wanted in (0.9, 0.6):
        for frequency in (None, 33.8e3):
            volts, amplitude = voltage_for_friction(plate, wanted, frequency=frequency)
            p = predict(plate, voltage=volts, frequency=frequency)
            assert p.relative_friction == pytest.approx(wanted, abs=1e-4)
            assert p.vibration_amplitude == pytest.approx(amplitude, rel=1e-5)
    assert voltage_for_friction(plate, 1.0) == (0.0, 0.0)
    with pytest.raises(UnreachableError, match="at the least"):
        voltage_for_friction(plate, 0.001, model="partial-levitation")
    with pytest.raises(UnreachableError, match="2000 V"):
        voltage_for_friction(stator, 0.6, frequency=30e3)


def test_a_finger_over_a_node_meets_more_friction(plate: Display) -> None:
    quarter = predict(plate).mode.half_wavelength / 2
    over_antinode, over_node = (predict(plate, position=x) for x in (0.0, quarter))
    assert over_node.relative_friction > over_antinode.relative_friction
    with pytest.raises(InputError, match="over an antinode only"):
        predict(plate, position=quarter, model="paper2008")


def test_moisture_changes_the_friction_without_vibration(plate: Display) -> None:
    moist = dataclasses.replace(plate, finger=dataclasses.replace(plate.finger, moisture="moist"))
    assert predict(moist).friction_coefficient > predict(plate).friction_coefficient


def test_a_vacuum_takes_less_from_films_over_single_ridges(stator: Display) -> None:
    thin = dataclasses.replace(stator, gas=stator.gas.at_pressure(2e3))
    here, there = (predict(one, model="partial-levitation") for one in (stator, thin))
    assert 1 - there.relative_friction < 0.2 * (1 - here.relative_friction)
    here, there = predict(stator), predict(thin)
    # Measured at a sixtieth of an atmosphere: 0.60 to 0.82, which this model cannot give.
    assert 0.2 < (1 - there.relative_friction) / (1 - here.relative_friction) < 0.5
    # Films over single ridges are far from their asymptote, and give it.
    here, there = (predict(one, model="levitation-ridges") for one in (stator, thin))
    assert 0.5 < (1 - there.relative_friction) / (1 - here.relative_friction) < 0.9


def test_unknown_models_are_refused(stator: Display) -> None:
    with pytest.raises(InputError, match="Did you mean 'levitation'"):
        predict(stator, model="levitaton")  # type: ignore[arg-type]


def test_the_reduction_carries_the_base_friction(stator: Display) -> None:
    # The adhesive lowers relative friction less than the bare stator, and absolute friction more
    # only through its larger base coefficient.
    rough, bare = (
        predict(stator, surface=name, model="paper2008") for name in ("adhesive", "bare")
    )
    assert rough.relative_friction > bare.relative_friction
    for p in (rough, bare):
        assert p.friction_reduction == pytest.approx(
            p.friction_coefficient * (1 - p.relative_friction)
        )


def test_contradicting_data_warn_or_are_refused(plate: Display) -> None:
    assert any("printed_e31" in text for text in predict(plate).warnings)
    with pytest.raises(ContradictionError):
        predict(plate, strict=True)


@pytest.mark.slow
def test_a_beam_carries_ceramic_where_the_plate_does(plate: Display) -> None:
    """Three ceramics of seven: a beam that carried them everywhere would be a seventh too quick."""
    assert isinstance(plate.actuator, RectangularPlate)
    few = dataclasses.replace(
        plate,
        actuator=dataclasses.replace(plate.actuator, patches=plate.actuator.patches[:3]),
    )
    beam, solved = predict(few, theory="timoshenko").mode, predict(few).mode
    assert beam.resonance_frequency == pytest.approx(solved.resonance_frequency, rel=0.03)
    covered = predict(plate, theory="timoshenko").mode
    assert covered.resonance_frequency > 1.1 * beam.resonance_frequency


def test_an_asymptote_out_of_range_warns_or_is_refused(stator: Display) -> None:
    p = predict(stator, model="paper2008")
    assert any("σ → ∞" in text for text in p.warnings)
    with pytest.raises(OutOfRangeError, match="strict=False"):
        predict(stator, model="paper2008", strict=True)
    # Without a model asked for, strictness has nothing to refuse: the film is solved.
    assert predict(stator, strict=True).model == "levitation"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"voltage": -1.0}, "voltage"),
        ({"voltage": float("nan")}, "voltage"),
        ({"normal_force": 0.0}, "normal_force"),
        ({"frequency": 0.0}, "frequency"),
        ({"vibration_amplitude": -1e-6}, "vibration_amplitude"),
        ({"voltage": 1.0, "vibration_amplitude": 1e-6}, "both"),
        ({"surface": "glass"}, "adhesive, bare"),
    ],
)
def test_impossible_working_points_are_refused(
    plate: Display, arguments: dict[str, object], says: str
) -> None:
    with pytest.raises(InputError, match=says):
        predict(plate, **arguments)  # type: ignore[arg-type]


def _law(stator: Display, surface: str = "adhesive", **changes: object) -> FrictionLaw:
    arguments = {"surface": stator.surface(surface), "model": "paper2008", **changes}
    return friction_law(stator, 9.35e-3, 40.5e3, **arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("surface", ["adhesive", pytest.param("bare", marks=pytest.mark.slow)])
@pytest.mark.parametrize(("model", "error"), [("paper2008", 1e-4), ("partial-levitation", 1e-3)])
def test_the_tabulated_law_is_within_its_stated_error(
    stator: Display, surface: str, model: str, error: float
) -> None:
    law = _law(stator, surface, model=model)
    table = law.table(6e-6)
    between = np.linspace(0, 6e-6, 777 if model == "paper2008" else 41)
    assert np.max(np.abs(table(between) - law.curve(between))) < error
    with pytest.raises(OutOfRangeError, match="tabulate"):
        table(np.array([6.1e-6]))


@pytest.mark.slow
def test_amplitude_for_a_friction_gives_that_friction(stator: Display) -> None:
    for model in ("paper2008", "levitation-2016", "partial-levitation"):
        law = _law(stator, model=model)
        for wanted in (0.95, 0.7):
            assert law.at(law.amplitude_for(wanted)) == pytest.approx(wanted, abs=1e-4)
        assert law.amplitude_for(1.0) == 0.0
    with pytest.raises(UnreachableError, match="at the least"):
        _law(stator, model="partial-levitation").amplitude_for(0.001)
    with pytest.raises(InputError, match="relative_friction"):
        _law(stator).amplitude_for(1.5)


def test_an_amplitude_is_found_for_what_is_nearly_the_friction_at_rest(stator: Display) -> None:
    finger = dataclasses.replace(stator.finger, asperities=AsperityLaw())
    law = _law(dataclasses.replace(stator, finger=finger), model="partial-levitation")
    slow = _law(stator, speed=1e-6)
    for one, wanted in ((law, 0.99999), (law, 1 - 1e-12), (slow, 0.999), (slow, 0.9)):
        assert one.at(one.amplitude_for(wanted)) == pytest.approx(wanted, abs=1e-5)


def test_the_asymptote_as_printed_adds_no_friction(stator: Display) -> None:
    """Its mean pressure of a small vibration lies a hair below the ambient one."""
    law = _law(stator, model="paper2008-printed", normal_force=0.02)
    assert law.at(1e-9) == law.table(1e-8)(np.array([1e-9]))[0] == 1.0


def test_an_area_that_grows_as_fast_as_the_force_keeps_the_pressure(stator: Display) -> None:
    finger = dataclasses.replace(stator.finger, contact_area_exponent=1.0)
    wide = dataclasses.replace(stator, finger=finger)
    light, firm = (predict(wide, vibration_amplitude=2e-6, normal_force=f) for f in (0.25, 0.5))
    pressures = [finger.plateau_pressure(p.normal_force) for p in (light, firm)]
    assert pressures[0] == pytest.approx(pressures[1])
    # Half of the pad lies nearer to the antinode, where all of it swings.
    assert light.relative_friction < firm.relative_friction < 1


def test_force_and_roughness_act_as_they_must(stator: Display) -> None:
    a = np.linspace(0, 5e-6, 41)
    light = _law(stator, normal_force=0.3).curve(a)
    heavy = _law(stator, normal_force=0.7).curve(a)
    assert np.all(light[1:] < heavy[1:])
    assert np.all(np.diff(light) <= 0)
    smooth, rough = _law(stator, "bare").curve(a), _law(stator).curve(a)
    assert np.all(smooth[1:] < rough[1:])


def test_a_display_needs_surfaces_with_different_names(plate: Display) -> None:
    with pytest.raises(InputError, match="empty"):
        dataclasses.replace(plate, surfaces=())
    twice = (plate.surfaces[0], plate.surfaces[0])
    with pytest.raises(InputError, match="same name twice"):
        dataclasses.replace(plate, surfaces=twice)
