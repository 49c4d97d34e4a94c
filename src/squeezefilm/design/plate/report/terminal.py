"""The rows of a solved plate, disc or stator, for its page too, and what the terminal shows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import (
    FARAD,
    HENRY,
    HZ,
    KELVIN,
    OHM,
    PER_VOLT,
    A,
    M,
    Row,
    S,
    V,
    changed,
    printable,
    shown,
    signed,
)
from squeezefilm.core.kit.terminal import heading, say, show_rows, table
from squeezefilm.design.plate.ring import RingAnalysis
from squeezefilm.physics.chain.pad_place import place_words
from squeezefilm.physics.plate.heat_states import COEFFICIENT_SHARES, EMISSIVITIES

if TYPE_CHECKING:
    from squeezefilm.design.plate.solved import ModeRow, SolvedBody
    from squeezefilm.physics.plate.ring.body import StatorFit
    from squeezefilm.physics.plate.sound import SoundField
    from squeezefilm.physics.plate.warming import Warming


def heat_rows(heat: Warming | None) -> list[Row]:
    """Temperature, drift and amplitude of the warm plate: quantity, value, remark."""
    if heat is None:
        return [("Temperature rise", "not known", "nor is the power that the plate loses")]
    follows, stays = heat.tracked, heat.fixed
    at = f"at a fixed {shown(heat.frequency, HZ)}"
    fallen = (
        "a tenth is never gone"
        if heat.time_to_fall is None
        else f"a tenth is gone after {shown(heat.time_to_fall, S, 2)}"
    )
    rises, drifts = "", ""
    if heat.rise_range is not None:
        low, high = EMISSIVITIES
        between = _between(heat.rise_range, KELVIN)
        rises = f"assumed {between} (emissivity {low:g} to {high:g}); "
    if heat.drift_range is not None:
        low, high = COEFFICIENT_SHARES
        between = _between(heat.drift_range, HZ)
        too = ", too" if rises else ""
        drifts = f"assumed {between} (temperature coefficient {low:g} to {high:g} times{too}); "
    resistance = si.format_quantity(heat.thermal_resistance, si.Unit("K/W"), 3)
    return [
        (
            "Temperature rise",
            signed(follows.temperature_rise, KELVIN),
            f"{rises}if the drive follows; {signed(stays.temperature_rise, KELVIN)} if fixed",
        ),
        (
            "Drift of the resonance",
            signed(follows.resonance_drift, HZ),
            f"{drifts}{signed(stays.resonance_drift, HZ)} if fixed; half-bandwidth "
            f"{shown(heat.half_bandwidth, HZ, 3)}",
        ),
        (
            "Amplitude warm",
            shown(follows.amplitude, M, 3),
            "if the drive follows the resonance, without a finger",
        ),
        (
            "",
            shown(stays.amplitude, M, 3),
            f"{at}, of {shown(heat.cold_amplitude, M, 3)} cold; {fallen}",
        ),
        (
            "Thermal resistance",
            resistance,
            f"time constant {shown(heat.thermal_time, S, 2)}; assumed: " + "; ".join(heat.assumed),
        ),
    ]


def _between(ends: tuple[float, float], unit: si.Unit) -> str:
    """A range as people read it, signs shown."""
    low, high = (signed(end, unit) for end in ends)
    same_unit = low.split()[-1] == high.split()[-1]
    return f"{low.split()[0] if same_unit else low} to {high}"


def sound_rows(sound: SoundField, direction: str) -> list[Row]:
    """Sound pressure levels by distance; `direction` says where they are loudest."""
    guidance = sound.guidance
    limit = "no guidance" if guidance is None else f"guidance {guidance.level_dB:.0f} dB"
    return [
        (
            f"Sound at {distance:g} m",
            f"{level:.0f} dB",
            f"{direction}; {limit}" if number == 0 else "",
        )
        for number, (distance, level) in enumerate(
            zip(sound.distances, sound.sound_pressure_level_dB, strict=True)
        )
    ]


# Of the working mode's amplitude per volt: below it a mode is called not driven.
_DRIVEN = 1e-4


def working_rows(result: SolvedBody) -> list[Row]:
    """The working mode of a solved plate, disc or stator: quantity, value, remark."""
    mode, said = result.working, result.remarks
    rows = [
        (
            f"Mode {mode.label}",
            shown(mode.frequency, HZ, 5),
            f"± {shown(mode.frequency_error, HZ, 2)} {said.frequency}",
        ),
        (
            "Amplitude per volt",
            shown(result.amplitude_per_volt, PER_VOLT),
            f"antinode at {place_words(result.mode.lobe)}, without a finger",
        ),
        ("", shown(result.largest_per_volt, PER_VOLT), said.largest),
    ]
    if isinstance(result, RingAnalysis):
        rows += _ring_rows(result)
    rows.append(("Quality factor", f"{mode.quality_factor:.4g}", said.quality))
    error = mode.coupling_coefficient_error
    said_error = "" if error is None else f"± {error:.1g} (estimated)"
    rows.append(("Effective coupling", f"{mode.coupling_coefficient:.3g}", said_error))
    if mode.parallel_resonance_frequency is not None:
        away = mode.parallel_resonance_frequency_error
        remark = "" if away is None else f"± {shown(away, HZ, 2)} (estimated), terminals open"
        rows.append(("Parallel resonance", shown(mode.parallel_resonance_frequency, HZ, 5), remark))
    return rows


def _ring_rows(result: RingAnalysis) -> list[Row]:
    """Rows of what was measured of a stator, and of where a disc or stator stands still."""
    rows, half = [], result.working.half_wavelength
    if result.computed_per_volt is not None:
        computed = shown(result.computed_per_volt, PER_VOLT)
        rows.append(("", computed, "computed there (the value above is measured)"))
    if half is not None:
        rows.append(
            ("Half wavelength", shown(half, M), f"along the {result.half_wavelength_along}")
        )
    if result.circles.size:
        radii = ", ".join(shown(float(r), M, 3) for r in result.circles)
        rows.append(("Nodal circles", radii, "radius"))
    return rows


def drive_rows(result: SolvedBody) -> list[Row]:
    """Current and power at resonance at the display's voltage, the equivalent circuit, warmth."""
    volts, load, c = result.display.drive.voltage, result.load, result.circuit
    rows = [
        (
            f"At {shown(volts, V)}",
            shown(load.current, A, 3),
            f"{load.apparent_power:.3g} VA, {load.real_power:.3g} W",
        )
    ]
    if c is None:
        rows.append(("Equivalent circuit", "none", result.circuit_said.removeprefix("none: ")))
    else:
        motional = (
            f"R1 {shown(c.motional_resistance, OHM, 3)}",
            f"L1 {shown(c.motional_inductance, HENRY, 3)}",
            f"C1 {shown(c.motional_capacitance, FARAD, 3)}",
        )
        static = f"C0 {shown(c.static_capacitance, FARAD, 3)}"
        rows.append(("Equivalent circuit", static, ", ".join(motional)))
        if result.circuit_said:
            rows.append(("", "", result.circuit_said))
    return rows + heat_rows(result.heat)


def fit_sentences(fit: StatorFit) -> tuple[str, ...]:
    """Sentences on the fit of a stator, what the teeth leave uncertain, and what is assumed."""
    a = fit.assumptions
    said = [
        f"Fitted: {shown(fit.ring_thickness, M, 4)} of metal under the teeth, so that "
        f"{fit.mode.label} falls on {shown(fit.mode.frequency, HZ)}, with the mean diameter of "
        f"{shown(fit.section.mean_diameter, M, 4)} from the wavelength. One frequency fits one "
        "dimension and validates nothing."
    ]
    if a.tooth_height > 0:
        low, high = fit.frequency_bounds
        said.append(
            f"Teeth: an equivalent layer of {si.percent(a.tooth_fill)} metal. "
            f"Between teeth without hoop stiffness and teeth as stiff as their share of metal, "
            f"this body lies between {shown(low, HZ)} and {shown(high, HZ)}; real teeth are 7 to "
            "13 % of the way up."
        )
    said.append(
        f"Assumed: {a.metal.name}, {a.ceramic.name} of {shown(a.ceramic_thickness, M)}, teeth of "
        f"{shown(a.tooth_height, M)}, {a.driven_sectors} half-wave sectors on the channel."
    )
    return tuple(said)


def show_guidance(sound: SoundField) -> None:
    """Print where the guidance on airborne ultrasound is from."""
    if sound.guidance is not None:
        say(f"Guidance ({sound.guidance.evidence}): {sound.guidance.source}")


def mode_rows(
    rows: Sequence[ModeRow], amplitude_per_volt: si.MetrePerVolt
) -> list[tuple[str, str, str, str, str, str]]:
    """Label, frequency, its error, quality factor, amplitude per volt alone and coupling of every
    mode.

    `amplitude_per_volt` is the working mode's (m/V).
    """
    return [
        (
            row.label,
            shown(row.frequency, HZ, 5),
            shown(row.frequency_error, HZ, 2),
            f"{row.quality_factor:.3g}",
            "not driven"
            if row.alone_per_volt < _DRIVEN * amplitude_per_volt
            else shown(row.alone_per_volt, PER_VOLT, 3),
            f"{row.coupling_coefficient:.2g}",
        )
        for row in rows
    ]


def show_modes(rows: Sequence[ModeRow], amplitude_per_volt: si.MetrePerVolt) -> None:
    """Print the table of modes; `amplitude_per_volt` is the working mode's (m/V)."""
    heading("Modes in the band, each alone at its antinode")
    head = ("mode", "frequency", "±", "Q", "per volt", "coupling")
    table(head, mode_rows(rows, amplitude_per_volt))


def show_plate(result: SolvedBody) -> None:
    """Print a solved plate, disc or stator: the working mode, then every mode of the band."""
    rows = working_rows(result)
    if (beam := result.mode.beam) is not None:
        against = changed(beam.mode.frequency / result.working.frequency - 1)
        rows.append(("As a Timoshenko beam", shown(beam.mode.frequency, HZ, 5), against))
    rows += drive_rows(result) + sound_rows(result.sound, result.remarks.loudest)
    show_rows(f"{result.display.title} [{result.display.name}]", rows)
    show_guidance(result.sound)
    if isinstance(result, RingAnalysis) and result.body.fit is not None:
        for sentence in fit_sentences(result.body.fit):
            say(sentence)
    show_modes(result.rows, result.amplitude_per_volt)
    if isinstance(result, RingAnalysis):
        say("B(circles, diameters) bends; R and T move in the plane, radially and around.")
    say(f"{result.model}; {result.status}")
    for doubt in (*result.objections, *result.heat.doubts):
        say(f"! {printable(doubt)}")
