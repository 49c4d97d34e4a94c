"""What is uncertain of a friction, how it is drawn, and what becomes of the draws."""

import dataclasses
import math
from collections import Counter
from collections.abc import Callable
from operator import attrgetter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.distributions import Uniform
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.presets import display_names
from squeezefilm.core.quantities import Unit
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.rough_contact import RoughContact
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.working_mode import working_mode
from squeezefilm.physics.uncertainty import draws, free_amplitude, uncertainty
from squeezefilm.physics.uncertainty.draws import (
    Draw,
    Mixture,
    Outcome,
    Refusals,
    outcome_of,
)
from squeezefilm.physics.uncertainty.free_amplitude import FreeAmplitude
from squeezefilm.physics.uncertainty.intervals import GroupInfluence, Influence, quantiles
from squeezefilm.physics.uncertainty.model_choices import HEIGHT_LAW, MOISTURE, SLIP
from squeezefilm.physics.uncertainty.parameters import (
    FORCE,
    SKIN_COMPLIANCE,
    Parameter,
    replaced,
    uncertain_parameters,
    value_at,
)
from squeezefilm.physics.uncertainty.uncertainty import (
    UncertainFriction,
    evaluate,
    friction_bands,
    interval_or_reason,
    sobol_points,
    uncertain_friction,
)


@pytest.fixture(scope="module")
def point(stator: Display) -> Prediction:
    # The model that draws laws of contact and of slip.
    return predict(stator, vibration_amplitude=2e-6, model="partial-levitation")


def _given(display: Display, **ranges: tuple[float, float]) -> Display:
    """The display with these distributions beside its values (a path with __ for its dots)."""
    known = dict(display.provenance)
    for name, (low, high) in ranges.items():
        known[name.replace("__", ".")] = Provenance("test", "measured", Uniform(low, high))
    return dataclasses.replace(display, provenance=known)


def test_values_are_found_and_replaced_by_their_path(stator: Display) -> None:
    changed = replaced(
        stator,
        {
            "surfaces.1.roughness": 1e-6,
            "finger.asperities.modulus": 1e6,
            "gas.viscosity": 2e-5,
        },
    )
    assert value_at(changed, "surfaces.1.roughness")[0] == 1e-6
    assert value_at(changed, "finger.asperities.modulus")[0] == 1e6
    assert changed.gas.viscosity == 2e-5
    assert changed.surfaces[0] == stator.surfaces[0]
    assert stator.surfaces[1].roughness == 0.2e-6
    assert value_at(stator, "finger.plateau_width")[1].symbol == "m"


def test_what_is_given_stands_before_what_is_assumed(stator: Display) -> None:
    names = {p.path: p.origin for p in uncertain_parameters(stator, driven=False)}
    assert names["finger.plateau_width"] == "assumed"
    assert "actuator.quality_factor" not in names
    # A condition, like the voltage.
    assert "finger.speed" not in names
    known = _given(stator, finger__plateau_width=(249e-6, 251e-6), drive__voltage=(130.0, 150.0))
    driven = {p.path: p for p in uncertain_parameters(known, "bare", driven=True)}
    assert driven["finger.plateau_width"].origin == "given"
    assert driven["finger.plateau_width"].distribution.support == (249e-6, 251e-6)
    assert "drive.voltage" in driven
    assert "surfaces.1.roughness" in driven
    assert "surfaces.0.roughness" not in driven
    assert "drive.voltage" not in {p.path for p in uncertain_parameters(known, driven=False)}
    # What a finger takes from the vibration matters where there is one to take from.
    mass = "finger.skin.mass_per_area"
    assert mass not in names
    assert driven[mass].distribution.support == pytest.approx((0.4 * 1.2, 1.5 * 1.2))
    heavy = replaced(known, {mass: 2.0})
    support = {p.path: p for p in uncertain_parameters(heavy, driven=True)}[mass].distribution
    assert support.support == pytest.approx((0.8, 3.0))


def test_a_ceramic_varies_as_makers_grant_unless_a_range_is_given() -> None:
    """All its stiffnesses by 10 %, all its d by 20 %, or the e31 that is believed instead."""
    stiff, charge, stress = (
        f"actuator.ceramic.{one}"
        for one in ("in_plane_stiffness", "charge_coefficient", "stress_coefficient")
    )
    for name in ("touchpad-glass", "winfield2007-tpad", "biet2008-plate"):
        display = load_display(name)
        found = {one.path: one for one in uncertain_parameters(display, driven=True)}
        for path, reach in ((stiff, 0.1), (charge, 0.2)):
            nominal = value_at(display, path)[0]
            ends = sorted(((1 - reach) * nominal, (1 + reach) * nominal))
            assert found[path].distribution.support == pytest.approx(ends, rel=1e-12)
            assert "makers grant" in found[path].source
            assert found[path].origin == "assumed"
        assert stress not in found
        still = {one.path for one in uncertain_parameters(display, driven=False)}
        assert not still & {stiff, charge}
    known = _given(display, actuator__ceramic__charge_coefficient=(-250e-12, -240e-12))
    own = {one.path: one for one in uncertain_parameters(known, driven=True)}[charge]
    assert (own.origin, own.distribution.support) == ("given", (-250e-12, -240e-12))
    ceramic = dataclasses.replace(display.actuator.ceramic, data_set="printed_e31")  # type: ignore[union-attr]
    printed = dataclasses.replace(
        display,
        actuator=dataclasses.replace(display.actuator, ceramic=ceramic),
    )
    of_it = {one.path for one in uncertain_parameters(printed, driven=True)}
    assert of_it & {stiff, charge, stress} == {stiff, stress}
    # A stator's amplitude is measured, whatever its ceramic.
    stator = uncertain_parameters(load_display("biet2008-stator"), driven=True)
    assert not any("ceramic" in one.path for one in stator)


def test_each_law_of_contact_has_its_own_parameters(stator: Display) -> None:
    rough = {p.path.split(".")[-1] for p in uncertain_parameters(stator, driven=False)}
    assert {"roughness", "modulus", "hurst_exponent", "longest_wavelength"} < rough
    assert "decay_length" not in rough
    finger = dataclasses.replace(stator.finger, asperities=AsperityLaw())
    separate = dataclasses.replace(stator, finger=finger)
    found = {p.path.split(".")[-1] for p in uncertain_parameters(separate, driven=False)}
    assert {"decay_length", "reference_gap"} < found
    assert "modulus" not in found


def test_the_force_is_uncertain_around_what_was_asked(stator: Display) -> None:
    own, asked = (
        {p.path: p for p in uncertain_parameters(stator, driven=False, normal_force=force)}[FORCE]
        for force in (None, 2.0)
    )
    # The paper's 0.3 to 0.7 N, and in proportion.
    assert own.distribution.support == pytest.approx((0.3, 0.7))
    assert asked.distribution.support == pytest.approx((1.2, 2.8))
    described = _given(stator, finger__normal_force=(0.45, 0.55))
    own, asked = (
        {p.path: p for p in uncertain_parameters(described, driven=False, normal_force=force)}
        for force in (None, 2.0)
    )
    assert own[FORCE].distribution.support == (0.45, 0.55)
    assert asked[FORCE].distribution.support == pytest.approx((1.2, 2.8))


def test_what_takes_a_table_is_drawn_in_steps() -> None:
    even = Parameter("p", 1.0, Unit("1"), Uniform(0.0, 1.0), "assumed", "", steps=4)
    assert even.drawn(np.array([0.0, 0.24, 0.26, 0.99, 1.0])) == [0.125, 0.125, 0.375, 0.875, 0.875]
    fine = dataclasses.replace(even, steps=None)
    assert fine.drawn(np.array([0.2])) == [0.2]


def test_a_draw_is_a_display_with_other_values_and_laws(stator: Display, point: Prediction) -> None:
    mixture = Mixture(stator, point, driven=False)
    values = {
        "finger.plateau_width": 200e-6, FORCE: 0.6, SKIN_COMPLIANCE: 0.3,
        "surfaces.0.roughness": 1e-6,
    }  # fmt: skip
    chosen = {HEIGHT_LAW: "gaussian", MOISTURE: "moist", SLIP: "veijola"}
    draw = mixture.made(values, chosen)
    finger, law = draw.display.finger, mixture.law(draw)
    assert (finger.plateau_width, finger.moisture) == (200e-6, "moist")
    assert isinstance(finger.asperities, AsperityLaw)
    assert finger.asperities.heights == "gaussian"
    # Of separate asperities no real contact area is known, so no friction by shear of it.
    assert finger.shear_strength is None
    rough = mixture.made({}, {HEIGHT_LAW: "persson"}).display.finger
    assert isinstance(rough.asperities, RoughContact)
    assert rough.shear_strength == stator.finger.shear_strength
    # The contact has its described area at the described force, and grows from there.
    assert finger.normal_force == stator.finger.normal_force
    assert (law.normal_force, law.slip, law.surface.roughness) == (0.6, "veijola", 1e-6)
    assert (law.speed, law.frequency) == (point.speed, point.frequency)
    # What is left out is as described.
    assert mixture.law(mixture.made({}, {})) == point.law


def test_a_model_draws_what_it_depends_on(stator: Display) -> None:
    rigid = predict(stator, vibration_amplitude=2e-6, model="partial-levitation")
    paths = Mixture(stator, rigid, driven=False).paths
    assert "surfaces.0.friction_coefficient" not in paths
    assert HEIGHT_LAW in paths
    held = predict(stator, vibration_amplitude=2e-6, model="paper2008")
    mixture = Mixture(stator, held, driven=False)
    assert mixture.model == "levitation"


def test_the_default_draws_people_and_of_the_contact_what_the_plate_feels(
    stator: Display,
) -> None:
    held = Mixture(stator, predict(stator, vibration_amplitude=2e-6), driven=False).paths
    assert {"finger.contact_decay_length", "finger.decay_speed_exponent"} < set(held)
    assert not [path for path in held if "asperities" in path or path == HEIGHT_LAW]
    driven = Mixture(stator, predict(stator), driven=True).paths
    assert HEIGHT_LAW in driven
    rival = predict(stator, vibration_amplitude=2e-6, model="partial-levitation")
    paths = Mixture(stator, rival, driven=False).paths
    assert "finger.contact_decay_length" not in paths


def test_a_draw_mixes_the_limits_of_the_skin(
    stator: Display, point: Prediction, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Mixture, "law", lambda *_: _Law())
    mixture = Mixture(stator, point, driven=False)
    draw = Draw(stator, 0.5, 0.25, "first", "persson", "levitation")
    value, amplitude, _ = outcome_of(mixture, draw, 3e-6)
    # At 3 µm 0.7 by each ridge's own balance, 0.4 at one gap.
    assert value == pytest.approx(0.25 * 0.7 + 0.75 * 0.4)
    assert amplitude == 3e-6


@dataclasses.dataclass(frozen=True)
class _Mode:
    half_wavelength: float = 9e-3
    modal_mass: float | None = 0.1
    quality_factor: float = 60.0


def test_a_finger_takes_its_share_of_a_driven_amplitude(
    stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the quality factor of the draw; not where the amplitude is given or no mass known."""
    touched: list[tuple[float, float]] = []

    def touch(mode: _Mode, _: Any, free: float, *, tolerance: float) -> Any:
        touched.append((mode.quality_factor, free))
        return SimpleNamespace(amplitude=0.5 * free, mode=None)

    monkeypatch.setattr(draws, "touch", touch)
    other = replaced(stator, {"actuator.quality_factor": 150.0})
    draw = Draw(other, 0.5, 1.0, "first", "persson", "levitation")

    def found(**changes: Any) -> Outcome:
        mixture: Any = SimpleNamespace(
            prediction=_predicted(**changes),
            law=lambda _: _Law(),
            mode=lambda one: dataclasses.replace(
                _Mode(), quality_factor=one.display.actuator.quality_factor
            ),
            power=lambda felt, volts: 2e6 * felt.amplitude * volts,
        )
        return outcome_of(mixture, draw, 3e-6)

    volts = stator.drive.voltage
    assert found(voltage=140.0, mode=_Mode()) == pytest.approx((0.85, 1.5e-6, 3 * volts))
    assert np.isnan(found(mode=_Mode()).power)
    assert touched == [(150.0, 3e-6)]
    assert found(mode=_Mode())[1] == 3e-6
    assert found(voltage=140.0, mode=_Mode(modal_mass=None))[1] == 3e-6
    assert len(touched) == 1


class _Law:
    """A friction law that needs no film: each limit falls with the amplitude by its own slope."""

    def __init__(self, own: float = 1.0, tied: float = 2.0) -> None:
        self.own, self.tied = own, tied

    @property
    def on_even_wave(self) -> Any:
        return self

    def friction_in(self, limit: str, amplitude: Any) -> Any:
        slope = self.own if limit == "own" else self.tied
        return 1 - 0.1 * slope * amplitude / 1e-6


def _predicted(**changes: Any) -> Any:
    values: dict[str, Any] = {
        "voltage": None, "touch": SimpleNamespace(free_amplitude=3e-6), "held_amplitude": 3e-6,
        "mode": SimpleNamespace(half_wavelength=9e-3, modal_mass=None, quality_factor=200.0),
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


@pytest.fixture
def made_up(
    stator: Display, point: Prediction, monkeypatch: pytest.MonkeyPatch
) -> Callable[..., Any]:
    """`uncertain_friction` with µ′/µ of a draw by a function of it."""

    def found(function: Callable[[Draw], float], **more: Any) -> Any:
        def one(_: Any, draw: Draw, free: float) -> Outcome:
            value = function(draw)
            return Outcome(value, 1e-6 * value + free, np.nan)

        monkeypatch.setattr(draws, "outcome_of", one)
        # Of what is made up nothing is kept.
        monkeypatch.setattr(
            uncertainty, "mixture_of", lambda display, p: Mixture(display, p, driven=False)
        )
        return uncertain_friction(stator, point, **more)

    return found


def _length(draw: Draw) -> float:
    return draw.display.finger.contact_length / 10e-3  # 0.8 to 1.2, uniform


@pytest.mark.parametrize("samples", [0, 4, 7, 9, 12, 100, 131072])
def test_a_design_needs_a_power_of_two(stator: Display, point: Prediction, samples: int) -> None:
    with pytest.raises(InputError, match=f"samples = {samples} .* power of two from 8 to 65536"):
        uncertain_friction(stator, point, samples=samples)


@pytest.mark.slow
def test_an_additive_model_has_the_indices_of_its_variances(made_up: Callable[..., Any]) -> None:
    """First and total order are the shares of the variance; of a law that is drawn as well."""
    weight = {"fukui-kaneko": 0.0, "veijola": 0.3, "first": 0.6}

    def additive(draw: Draw) -> float:
        return 0.5 * _length(draw) + 0.2 * draw.skin_compliance + weight[draw.slip]

    told: list[str] = []
    found = made_up(additive, samples=256, seed=3, progress=told.append)
    # Weights 0.5, 0.25, 0.25: mean 0.225, mean square 0.1125.
    variances = {
        "finger.contact_length": 0.2**2 / 12, SKIN_COMPLIANCE: 0.2**2 / 12, SLIP: 0.1125 - 0.225**2,
    }  # fmt: skip
    whole = sum(variances.values())
    shares = {one.parameter.path: one for one in found.influences}
    for path, variance in variances.items():
        assert shares[path].total == pytest.approx(variance / whole, abs=0.03), path
        assert shares[path].first_order == pytest.approx(variance / whole, abs=0.03), path
        assert 0 < shares[path].total_error < 0.1
    assert shares[HEIGHT_LAW].total == 0
    assert found.influences[0].parameter.path == SLIP
    measurable, unknown = found.groups
    known = variances["finger.contact_length"] / whole
    assert (measurable.knowledge, unknown.knowledge) == ("measurable", "unknown")
    assert (measurable.alone, measurable.total) == pytest.approx((known, known), abs=0.02)
    assert (unknown.alone, unknown.total) == pytest.approx((1 - known, 1 - known), abs=0.02)
    # Quantiles of the same sum, by brute force.
    random = np.random.default_rng(0)
    drawn = random.choice(list(weight.values()), p=[0.5, 0.25, 0.25], size=10**6)
    drawn += 0.5 * (0.8 + 0.4 * random.random(10**6)) + 0.2 * random.random(10**6)
    assert found.interval == pytest.approx(np.quantile(drawn, [0.05, 0.95]), abs=0.01)
    assert found.median == pytest.approx(np.median(drawn), abs=0.03)
    # 8 · 256 points for the interval; for the influences A, B, one for each input and two mixed:
    # after a quarter of the rows only the three inputs that explain anything.
    assert found.samples.size == 2048
    columns = len(found.influences) + 4
    assert found.refused.evaluations == 2048 + 64 * columns + 192 * (3 + 4)
    assert found.amplitudes == pytest.approx(2e-6 + 1e-6 * found.samples)
    assert told[0] == f"friction of draw 1 of {2048 + 64 * columns}"
    matters = [text for text in told if text.startswith("which value matters, by draw")]
    assert matters[0].endswith(f" 1 of {192 * (3 + 4)}")
    assert len(told) <= 2 * 25


@pytest.mark.slow
def test_what_matters_only_in_company_has_a_total_and_nothing_alone(
    made_up: Callable[..., Any],
) -> None:
    """A product of two centred values, one of either group."""
    found = made_up(lambda draw: (_length(draw) - 1) * (draw.skin_compliance - 0.5), samples=256)
    for one in found.influences[:2]:
        assert one.parameter.path in ("finger.contact_length", SKIN_COMPLIANCE)
        assert one.first_order == pytest.approx(0, abs=0.2)
        assert one.total == pytest.approx(1, abs=0.2)
    for group in found.groups:
        assert (group.alone, group.total) == pytest.approx((0, 1), abs=0.15)


def test_a_refused_draw_counts_as_outside_at_both_ends() -> None:
    whole = np.linspace(0, 1, 101)[1:-1]  # at the positions k/(n + 1)
    assert quantiles(whole) == pytest.approx([0.05, 0.5, 0.95])
    lost = whole.copy()
    lost[[40, 60]] = np.nan
    low, middle, high = quantiles(lost)
    assert low == pytest.approx(0.03)
    assert high == pytest.approx(0.97)
    assert middle == pytest.approx(0.5)


def _refusing(every: int) -> Callable[[Draw], float]:
    number = iter(range(10**6))

    def friction(draw: Draw) -> float:
        if next(number) % every == 0:
            raise OutOfRangeError("a plateau is pressed through its asperities")
        return draw.skin_compliance

    return friction


def test_refused_draws_are_counted_with_their_reason(made_up: Callable[..., Any]) -> None:
    found = made_up(_refusing(80), samples=8)
    refused = found.refused
    # 14 inputs, each with a column of its own beside four.
    assert (refused.count, refused.evaluations) == (3, 64 + 8 * 18)
    assert refused.reasons == Counter({"pressed through its asperities": 3})
    assert sum(refused.heights.values()) == 3
    assert refused.sentence.startswith(
        "3 of 208 draws (1.4 %) are refused: pressed through its asperities (3); by the law of"
    )
    assert np.all(np.isfinite(found.samples))
    assert found.samples.size == found.amplitudes.size == 63
    assert found.summary()["refused"] == 3
    # A refused draw is not below anything.
    assert found.probability_below(2.0) == pytest.approx(63 / 64)


def test_above_two_per_cent_there_is_no_interval(
    stator: Display, point: Prediction, made_up: Callable[..., Any]
) -> None:
    with pytest.raises(OutOfRangeError, match=r"5 of 208 draws \(2.4 %\) are refused.*Press less"):
        made_up(_refusing(48), samples=8)


def test_why_there_is_no_interval_is_said(
    stator: Display, point: Prediction, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any, **__: Any) -> Any:
        raise OutOfRangeError("nothing holds")

    assert interval_or_reason(stator, point, samples=0) == (None, "no samples were asked for")
    monkeypatch.setattr(uncertainty, "uncertain_friction", refuse)
    assert interval_or_reason(stator, point) == (None, "nothing holds")
    still = dataclasses.replace(point, touch=dataclasses.replace(point.touch, law=None))
    assert interval_or_reason(stator, still)[1].startswith("nothing vibrates")


def test_where_the_described_value_stands_is_said(made_up: Callable[..., Any]) -> None:
    found = made_up(lambda draw: draw.skin_compliance, samples=8)
    inside = dataclasses.replace(found, nominal=0.5)
    assert inside.standing == "50 % of the draws lie below the value as described"
    outside = dataclasses.replace(found, nominal=2.0)
    assert outside.standing.startswith("100 % of the draws lie below")
    assert "outside of the interval" in outside.standing


def test_an_uncertain_friction_is_said_and_listed() -> None:
    parameter = Parameter("finger.p", 2e-4, Unit("m"), Uniform(150e-6, 350e-6), "given", "a paper")
    found = UncertainFriction(
        nominal=0.412, median=0.43, interval=(0.281, 0.549), level=0.9,
        samples=np.array([0.3, 0.7]), amplitudes=np.zeros(2), draws=3,
        influences=(Influence(parameter, 0.1, 0.2, 0.3, 0.4),),
        groups=(GroupInfluence("measurable", 0.5, 0.7, 0.1, 0.1),),
        refused=Refusals(64, Counter({"why": 1})), seed=5, model="a-model",
    )  # fmt: skip
    assert found.sentence == "µ′/µ = 0.41 as described (0.28–0.55, median 0.43)"
    assert found.probability_below(0.5) == pytest.approx(1 / 3)
    assert found.summary() == {
        "relative_friction": 0.412, "relative_friction_median": 0.43,
        "relative_friction_interval": [0.281, 0.549], "interval_level": 0.9, "evaluations": 64,
        "vibration_amplitude_interval_m": None, "power_W": None, "power_interval_W": None,
        "refused": 1, "refused_why": {"why": 1}, "seed": 5,
        "groups": {
            "measurable": {
                "first_order": 0.5, "first_order_error": 0.1,
                "total_order": 0.7, "total_order_error": 0.1,
            }
        },
        "measure_next": [
            {
                "parameter": "finger.p", "knowledge": "measurable", "first_order": 0.1,
                "first_order_error": 0.2, "total_order": 0.3, "total_order_error": 0.4,
                "distribution": "given", "range": ["150 µm", "350 µm"], "source": "a paper",
            }
        ],
    }  # fmt: skip


def test_a_band_ends_where_more_than_two_per_cent_are_refused(
    stator: Display, point: Prediction, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Above 2.5 µm a quarter of the contacts is pressed through: there is no band, elsewhere all
    draws count."""

    class Law:
        def __init__(self, wide: float) -> None:
            self.wide = wide
            self.on_even_wave = self

        def friction_in(self, limit: str, amplitude: np.ndarray) -> Any:
            if self.wide > 1.1 and amplitude.max() > 2.5e-6:
                raise OutOfRangeError("pressed through")
            return _Law(self.wide, self.wide).friction_in(limit, amplitude)

    monkeypatch.setattr(Mixture, "law", lambda _, draw: Law(_length(draw)))
    told: list[tuple[str, float]] = []
    amplitude = np.array([1e-6, 2e-6, 3e-6])
    (band,) = friction_bands(
        stator, point, amplitude, samples=128, progress=lambda *said: told.append(said)
    )
    assert band.amplitude is amplitude
    assert (band.level, band.samples) == (0.9, 128)
    # 1 − 0.1 w over w from 0.8 to 1.2; the 5 % at each end are left out.
    for k, micro in enumerate((1, 2)):
        assert band.low[k] == pytest.approx(1 - 0.1 * micro * 1.18, abs=3e-3)
        assert band.high[k] == pytest.approx(1 - 0.1 * micro * 0.82, abs=3e-3)
    assert np.isnan([band.low[2], band.high[2]]).all()
    assert told[0] == ("draw 1 of 128", 0.0)
    assert told[-1] == ("draw 128 of 128", 127 / 128)


def test_the_nominal_friction_is_as_described(stator: Display, point: Prediction) -> None:
    mixture = Mixture(stator, point, driven=False)
    assert uncertainty._nominal(mixture) == point.relative_friction
    # A model that shares no load has its interval by the default one, over an antinode as it is.
    held = predict(stator, vibration_amplitude=2e-6, model="paper2008")
    assert uncertainty._nominal(Mixture(stator, held, driven=False)) == pytest.approx(
        float(point.law.by("levitation").on_even_wave.at(2e-6))
    )


@pytest.mark.slow
def test_a_range_that_is_known_better_narrows_the_interval(
    stator: Display,
) -> None:
    point = predict(stator, vibration_amplitude=2e-6)
    wide = uncertain_friction(stator, point, samples=8)
    length = stator.finger.contact_decay_length
    ranges = {"finger__contact_decay_length": (0.99 * length, 1.01 * length)}
    narrow = uncertain_friction(_given(stator, **ranges), point, samples=8)
    assert np.ptp(narrow.interval) < 0.9 * np.ptp(wide.interval)
    assert wide.interval[0] < wide.median < wide.interval[1]
    assert uncertain_friction(stator, point, samples=8).interval == wide.interval


@pytest.mark.slow
def test_a_hard_pressed_finger_has_no_interval(stator: Display) -> None:
    hard = predict(stator, vibration_amplitude=3e-6, normal_force=5.0, model="partial-levitation")
    found, why = interval_or_reason(stator, hard, samples=8)
    assert found is None
    assert "pressed through its asperities" in why


def test_a_mode_keeps_its_own_losses_in_a_draw() -> None:
    """Glass has losses of its own: the solved mode's Q is not the assembly's, and a draw scales
    it."""
    display = load_display("touchpad-glass")
    point = predict(display, theory="timoshenko")
    own = dataclasses.replace(point.mode, quality_factor=411.0)
    mixture = Mixture(display, dataclasses.replace(point, mode=own), driven=True)
    assert mixture.mode(mixture.made({}, {})).quality_factor == 411.0
    worse = mixture.made({"actuator.quality_factor": 70.0}, {})
    assert mixture.mode(worse).quality_factor == pytest.approx(0.7 * 411)
    assert mixture.free(worse.display) / mixture.free(display) == pytest.approx(0.7)


@pytest.mark.slow
@pytest.mark.parametrize("name", display_names())
def test_what_a_display_is_described_as_lies_within_its_intervals(name: str) -> None:
    display = load_display(name)
    found = uncertain_friction(display, predict(display), samples=16)
    assert found.interval[0] <= found.nominal <= found.interval[1]
    if found.power_interval is not None:
        assert found.power is not None
        assert found.power_interval[0] <= found.power <= found.power_interval[1]


def test_the_free_amplitude_follows_voltage_quality_and_dimensions(
    stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    plate = load_display("biet2008-plate")
    disc = load_display("winfield2007-tpad")
    monkeypatch.setattr(
        FreeAmplitude, "_per_volt", staticmethod(FreeAmplitude._per_volt.__wrapped__)
    )
    # A made-up actuator moves with its thickness, a plate (as a beam) ten times as far.
    monkeypatch.setattr(
        free_amplitude,
        "beam_response",
        lambda a: SimpleNamespace(amplitude_per_volt=10 * a.thickness, require_driven=lambda: None),
    )
    monkeypatch.setattr(
        free_amplitude, "working_mode",
        lambda a: SimpleNamespace(amplitude_per_volt=getattr(a, "thickness", 1.0)),
    )  # fmt: skip

    def shares(display: Display, *changes: dict[str, float], **more: Any) -> list[float]:
        free = FreeAmplitude(display, _predicted(voltage=15.0, **more))
        return [free(replaced(display, one)) / 3e-6 for one in changes]

    volts = {"drive.voltage": 1.1 * plate.drive.voltage}
    q = {"actuator.quality_factor": 0.8 * plate.actuator.quality_factor}
    thick = {"actuator.thickness": 1.2 * 2e-3}
    found = shares(plate, {}, volts, q, volts | q, thick, volts | thick, {"gas.viscosity": 2e-5})
    assert found == pytest.approx([1, 1.1, 0.8, 0.88, 1.2, 1.32, 1])
    # Q counts in proportion whatever else differs.
    assert shares(plate, q | thick) == pytest.approx([0.96])
    assert shares(disc, {}, {"actuator.thickness": 1.5 * 1.6e-3}) == pytest.approx([1, 1.5])
    # A stator's amplitude is measured: its Q is in it.
    assert shares(stator, {"actuator.quality_factor": 100.0}) == pytest.approx([1])
    # Where the amplitude is given nothing of drive and actuator moves it.
    free = FreeAmplitude(plate, _predicted())
    assert free(replaced(plate, volts | q | thick)) == 3e-6
    # At rest there is nothing to be in proportion to.
    still = dataclasses.replace(plate, drive=dataclasses.replace(plate.drive, voltage=0.0))
    assert FreeAmplitude(still, _predicted(voltage=15.0))(plate) == 3e-6


@pytest.mark.slow
def test_a_disc_of_a_draw_is_told_from_few_solved_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    disc = load_display("winfield2007-tpad")
    solved: list[Any] = []

    def counted(actuator: Any) -> Any:
        solved.append(actuator)
        return working_mode(actuator)

    monkeypatch.setattr(free_amplitude, "working_mode", counted)
    FreeAmplitude._per_volt.cache_clear()  # of what other tests asked for
    free = FreeAmplitude(disc, _predicted(voltage=15.0))
    reference = working_mode(disc.actuator).amplitude_per_volt
    rng = np.random.default_rng(18)
    paths = ("substrate.young_modulus", "substrate.density", "thickness")
    for _ in range(8):
        changes = {
            f"actuator.{path}": getter(disc.actuator) * math.exp(rng.uniform(-0.1, 0.1))
            for path, getter in ((path, attrgetter(path)) for path in paths)
        }
        other = replaced(disc, changes)
        wanted = working_mode(other.actuator).amplitude_per_volt / reference
        assert free(other) / 3e-6 == pytest.approx(wanted, rel=0.03)
    assert len(solved) == 1 + 2 * len(paths)


def test_draws_beyond_the_range_of_their_law_count_without_a_warning_for_each() -> None:
    # Warnings are errors in tests: under 2 N some draws of separate asperities are pressed flat.
    p = predict(
        "biet2008-stator", vibration_amplitude=2e-6, normal_force=2.0, model="partial-levitation"
    )
    mixture = Mixture(load_display("biet2008-stator"), p, driven=False)
    drawn, _ = evaluate(mixture, sobol_points(mixture, 64, 3), lambda _: None)
    assert np.isfinite(drawn.friction).mean() > 0.95
    laws = [mixture.law(draw) for draw in mixture.draws(sobol_points(mixture, 64, 3))]
    assert any(law.finger.largest_force(law.surface.roughness) < law.normal_force for law in laws)
