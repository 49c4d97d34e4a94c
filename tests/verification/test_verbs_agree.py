"""Every verb says the same of a plate's working mode: one solved mode, one definition a number."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from tests.verification.random_plates import random_glass, random_plate

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.design.analysis.analysis import Analysis
from squeezefilm.design.analysis.analyze import analyze
from squeezefilm.design.analysis.report.first_screen import first_screen
from squeezefilm.design.analysis.report.folds import vibration_rows
from squeezefilm.design.plate.command import PlateAnalysis, solve_plate
from squeezefilm.design.plate.modes import list_modes
from squeezefilm.design.search.criteria import numbers_of_prediction, numbers_of_solved
from squeezefilm.design.search.requirements import load_requirements
from squeezefilm.design.sweep.answers import numbers_of
from squeezefilm.design.sweep.points import Point, answer_of
from squeezefilm.lab.designing.form import preset_text
from squeezefilm.lab.designing.numbers import DesignPoint, designed, predicted
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.chain.wanted_voltage import voltage_for_friction
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.electronics import load_of_mode
from squeezefilm.physics.plate.layout import CeramicPatch, GlueLayer, RectangularPlate
from squeezefilm.physics.plate.working_mode import CROWDED, working_mode

GLASS = ElasticMaterial("soda-lime glass", 72e9, 0.23, 2500)
CERAMIC = Piezoceramic("PZT", 61e9, 0.31, 21e9, 7750, -171e-12, 1700, 75)
WEAK = RectangularPlate(
    105e-3, 22e-3, 3.3e-3, 7, 80, GLASS, CERAMIC,
    (
        CeramicPatch(0, 0, 5e-3, 22e-3, 0.5e-3, 1),
        CeramicPatch(100e-3, 0, 5e-3, 22e-3, 0.5e-3, -1),
    ),
    lines_across="length", glue=GlueLayer(20e-6, 3e9),
)  # fmt: skip
"""Two strips at the ends, which hardly move (7,0): its neighbour (1,2) takes part."""


def on(plate: RectangularPlate) -> Display:
    display = load_display("biet2008-plate")
    return dataclasses.replace(display, actuator=plate)


def same(*numbers: float) -> None:
    """Assert that numbers are alike to rounding."""
    assert list(numbers) == pytest.approx([numbers[0]] * len(numbers), rel=1e-9, abs=0.0)


def check(plate: RectangularPlate) -> None:
    """Assert that `working_mode`, `modes`, `plate` and `predict` agree on a plate, and that what
    `predict` answers returns itself."""
    display = on(plate)
    try:
        mode = working_mode(plate)
    except InputError:
        # What nobody can solve nobody answers.
        with pytest.raises(InputError):
            solve_plate(display)
        return
    solid, volts = mode.solid, display.drive.voltage
    assert solid is not None
    band = 0.8 * mode.resonance_frequency, 1.25 * mode.resonance_frequency
    p, alone = predict(display), solve_plate(display, points=90)
    same(mode.resonance_frequency, p.mode.resonance_frequency, alone.working.frequency)
    same(mode.quality_factor, p.mode.quality_factor, alone.working.quality_factor)
    same(
        mode.amplitude_per_volt, p.mode.amplitude_per_volt, alone.amplitude_per_volt,
        p.touch.free_amplitude / volts, p.summary()["amplitude_per_volt_m_per_V"],
        alone.summary()["amplitude_per_volt_m_per_V"],
        float(np.max(solid.response.amplitude_at(*mode.lobe)[[solid.resonance]])),
    )  # fmt: skip
    same(solid.alone_per_volt, alone.working.alone_per_volt)
    assert solid.largest_per_volt >= solid.amplitude_per_volt * (1 - 1e-3)
    same(solid.largest_per_volt, alone.largest_per_volt)
    assert p.summary()["neighbour"] == alone.summary()["neighbour"]
    if p.heat is not None:
        same(p.heat.speed, alone.heat.speed)
        same(
            p.heat.speed,
            2 * math.pi * mode.resonance_frequency * volts * mode.amplitude_per_volt / math.sqrt(2),
        )
        same(p.heat.tracked.temperature_rise, alone.heat.tracked.temperature_rise)
    load = load_of_mode(plate, mode, volts, mode.resonance_frequency)
    assert load is not None
    same(load.current, solve_plate(display).load.current)
    analysis = analyze(display, samples=0)
    # What stands beside these numbers, and takes seconds.
    vars(analysis).update(ears=None, felt=None, sensitivities=None)
    vars(analysis).update(other_models=(), friction_curves=())
    check_summaries(display, p, alone, analysis)
    check_rows(analysis)
    check_criteria(display, p, load.current)
    check_listed(display, mode, band)
    check_circuit(mode)
    given = predict(display, vibration_amplitude=p.vibration_amplitude)
    same(p.relative_friction, given.relative_friction)
    same(p.touch.free_amplitude, given.touch.free_amplitude)
    if p.relative_friction < 0.999:
        found, amplitude = voltage_for_friction(display, p.relative_friction)
        same(volts, found)
        same(p.vibration_amplitude, amplitude)


SHARED = (
    "resonance_frequency_Hz", "amplitude_per_volt_m_per_V", "quality_factor", "half_wavelength_m",
    "vibration_amplitude_m", "relative_friction", "neighbour.frequency_Hz", "neighbour.share",
    "heat.speed_m_per_s", "heat.tracked.amplitude_m", "heat.tracked.temperature_rise_K",
)  # fmt: skip


def check_summaries(
    display: Display, p: Prediction, alone: PlateAnalysis, analysis: Analysis
) -> None:
    """Assert that the JSON of predict, analyze and plate, the points of a sweep that ask them, and
    the lab have the same under the same names."""
    plate = alone.summary()
    swept = [answer_of(Point(display, {}, verb)) for verb in ("predict", "plate")]
    assert [answer.reason for answer in swept] == ["", ""]
    summaries = [
        dict(numbers_of(summary))
        for summary in (
            p.summary(), analysis.summary(), plate | {"resonance_frequency_Hz": None},
            predicted(display, "solved", DesignPoint(text="")).summary(),
        )
    ] + [dict(answer.numbers) for answer in swept]  # fmt: skip
    same(p.mode.resonance_frequency, plate["frequency_Hz"], swept[1].numbers["frequency_Hz"])
    for name in SHARED:
        there = [numbers.get(name, math.nan) for numbers in summaries]
        known = [value for value in there if not math.isnan(value)]
        if known or not name.startswith(("neighbour", "heat")):
            same(*known)
    best = analysis.active_area
    if best is not None and best.area.best is not None:
        # The map reads the law between knots.
        assert p.summary()["place"]["is_best_of_area"]
        assert p.relative_friction == pytest.approx(best.area.best, abs=2e-4)


def check_rows(analysis: Analysis) -> None:
    """Assert that the report's rows say, to the digits that they have, what the JSON has."""
    p = analysis.prediction
    rows = {label: (text, remark) for label, text, remark in first_screen(analysis).numbers}
    rows |= {label: (text, remark) for label, text, remark in vibration_rows(p)}
    metre, volts = si.Unit("m"), p.voltage
    for label, value, unit in (
        ("Resonance frequency", p.mode.resonance_frequency, si.Unit("Hz")),
        ("Amplitude, free", volts * p.mode.amplitude_per_volt, metre),
        ("Peak amplitude, finger on", p.vibration_amplitude, metre),
        ("Relative friction µ′/µ", p.relative_friction, si.Unit("1")),
    ):
        told = si.parse_quantity(rows[label][0], unit)
        assert told == pytest.approx(value, rel=5.1e-3, abs=5.1e-3 if unit.symbol == "1" else 0)
    per_volt = si.parse_quantity(rows["Amplitude, free"][1].split(" × ")[0], si.Unit("m/V"))
    assert per_volt == pytest.approx(p.mode.amplitude_per_volt, rel=5.1e-3)


def check_criteria(display: Display, p: Prediction, current: float) -> None:
    """Assert that what a search judges a design by is what the verbs say of it."""
    wanted = load_requirements("biet2008-plate")
    judged = numbers_of_prediction(wanted, display, p) | numbers_of_solved(wanted, display, p)
    summary, beside = p.summary(), p.mode.neighbour
    for key, name in (
        ("relative_friction", "relative_friction"),
        ("resonance_frequency", "resonance_frequency_Hz"),
        ("vibration_amplitude", "vibration_amplitude_m"),
        ("half_wavelength", "half_wavelength_m"),
    ):
        same(judged[key], summary[name])
    same(judged["current"], current)
    crowded = beside is not None and beside.share >= CROWDED
    assert judged["neighbour"] == (abs(beside.distance) if crowded and beside else math.inf)
    if p.heat is not None:
        same(judged["temperature_rise"], summary["heat"]["tracked"]["temperature_rise_K"])
        same(judged["power"], summary["heat"]["cold_power_W"])


def check_listed(display: Display, mode: Any, band: tuple[float, float]) -> None:
    """Assert that the list of modes has the working one as it was solved, if it is driven."""
    try:
        listed = list_modes(display, band)
    except InputError:
        return
    if listed.forbidden is not None:
        return
    row = listed.working_mode
    assert row is not None
    assert listed.solved is not None
    same(mode.resonance_frequency, row.frequency, listed.solved.resonance_frequency)
    same(mode.amplitude_per_volt, listed.solved.amplitude_per_volt)
    same(mode.solid.alone_per_volt, row.alone_per_volt)
    beside = mode.neighbour
    if beside is not None:
        assert (row.neighbour, row.neighbour_share) == (beside.name, beside.share)
        assert row.crowded == (mode.company is not None)


def check_circuit(mode: Any) -> None:
    """Assert that a circuit is physical, with frequency and Q of its mode, or said to be none."""
    circuit, said = mode.solid.circuit, mode.solid.circuit_said
    if circuit is None:
        assert said.startswith("none: ")
        return
    omega = 2 * math.pi * mode.resonance_frequency
    assert min(
        circuit.motional_resistance, circuit.motional_inductance, circuit.motional_capacitance,
        circuit.static_capacitance,
    ) > 0  # fmt: skip
    same(omega**-2, circuit.motional_inductance * circuit.motional_capacitance)
    same(mode.quality_factor, omega * circuit.motional_inductance / circuit.motional_resistance)


@pytest.mark.slow
def test_the_verbs_agree_on_a_mode_that_is_hardly_driven() -> None:
    check(WEAK)
    mode = working_mode(WEAK)
    assert mode.solid is not None
    assert "of the conductance at its resonance" in mode.solid.circuit_said
    assert mode.neighbour is not None
    assert mode.neighbour.name == "(1,2)"


@pytest.mark.slow
def test_the_lab_says_of_a_plate_what_predict_says() -> None:
    shown = dict(numbers_of(designed(DesignPoint(text=preset_text("biet2008-plate")), "solved")))
    p = dict(numbers_of(predict("biet2008-plate").summary()))
    for name in SHARED:
        if not math.isnan(p.get(name, math.nan)):
            same(shown[name], p[name])


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 3])
def test_the_verbs_agree_on_two_random_plates(seed: int) -> None:
    check(random_plate(seed))


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(50))
def test_the_verbs_agree_on_fifty_random_plates(seed: int) -> None:
    check(random_plate(seed) if seed % 2 else random_glass(seed))
