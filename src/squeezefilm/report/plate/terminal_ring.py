"""What the terminal shows of a solved disc or stator."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.quantities import Unit
from squeezefilm.report.kit.numbers import shown
from squeezefilm.report.kit.terminal import heading, plain_console, table
from squeezefilm.report.plate.terminal_modes import show_guidance, show_modes, sound_rows

if TYPE_CHECKING:
    from squeezefilm.analysis.plate.ring import RingAnalysis
    from squeezefilm.plate.ring.stator import StatorFit

_HZ, _M, _PER_VOLT = Unit("Hz"), Unit("m"), Unit("m/V")


def show_ring(result: RingAnalysis) -> None:
    """Print a solved ring: the working mode, how it was fitted, then every mode of the band."""
    console, mode = plain_console(), result.working
    heading(console, f"{result.display.title} [{result.display.name}]")
    rows = [
        (
            f"Mode {mode.label}",
            shown(mode.frequency, _HZ, 5),
            f"± {shown(mode.frequency_error, _HZ, 2)} (estimated)"
            + ("; fitted, not predicted" if result.body.fit is not None else ""),
        ),
        (
            "Amplitude per volt",
            shown(result.amplitude_per_volt, _PER_VOLT),
            "largest, touched face",
        ),
        (
            "",
            shown(result.centreline_per_volt, _PER_VOLT),
            "antinodes of the mean circumference" if result.mode.harmonic else "inner lobe",
        ),
    ]
    if result.described_amplitude_per_volt is not None:
        rows.append(
            ("", shown(result.described_amplitude_per_volt, _PER_VOLT), "described as measured")
        )
    if mode.half_wavelength is not None:
        rows.append(
            (
                "Half wavelength",
                shown(mode.half_wavelength, _M),
                f"along the {result.half_wavelength_along}",
            )
        )
    if result.circles.size:
        rows.append(
            ("Nodal circles", ", ".join(shown(float(r), _M, 3) for r in result.circles), "radius")
        )
    volts = result.display.drive.voltage
    rows += [
        (
            "Quality factor",
            f"{mode.quality_factor:.4g}",
            "from the losses of its materials"
            if result.body.quality_factor is None
            else "of the assembly, as described",
        ),
        ("Effective coupling", f"{mode.coupling:.3g}", ""),
        (
            f"At {shown(volts, Unit('V'))}",
            shown(result.response.current(volts), Unit("A"), 3),
            f"{result.response.apparent_power(volts):.3g} VA, "
            f"{result.response.input_power(volts):.3g} W",
        ),
    ]
    if result.circuit is not None:
        c = result.circuit
        rows.append(
            (
                "Equivalent circuit",
                f"C0 {shown(c.static_capacitance, Unit('F'), 3)}",
                f"R1 {shown(c.motional_resistance, Unit('ohm'), 3)}, "
                f"L1 {c.motional_inductance:.3g} H, "
                f"C1 {shown(c.motional_capacitance, Unit('F'), 3)}",
            )
        )
    rows += sound_rows(result.sound, "loudest direction, touched face only")
    table(console, ("", "", ""), rows, fixed=(0,))
    show_guidance(console, result.sound)
    if result.body.fit is not None:
        for sentence in fit_sentences(result.body.fit):
            console.print(sentence)
    show_modes(console, result.rows, result.amplitude_per_volt)
    console.print("B(circles, diameters) bends; R and T move in the plane, radially and around.")
    console.print(f"{result.model}; {result.status}")


def fit_sentences(fit: StatorFit) -> tuple[str, ...]:
    """What was fitted of a stator, what the teeth leave uncertain, and what is assumed."""
    a = fit.assumptions
    said = [
        f"Fitted: {shown(fit.ring_thickness, _M, 4)} of metal under the teeth, so that "
        f"{fit.mode.label} falls on {shown(fit.mode.frequency, _HZ)}, with the mean diameter of "
        f"{shown(fit.derived['mean_diameter'], _M, 4)} from the wavelength. One frequency fits one "
        "dimension and validates nothing."
    ]
    if a.tooth_height > 0:
        low, high = fit.frequency_bounds
        said.append(
            f"Teeth: an equivalent layer of {a.tooth_fill:.0%} metal ({a.tooth_model}). Between "
            f"teeth without hoop stiffness and teeth as stiff as their share of metal, this body "
            f"lies between {shown(low, _HZ)} and {shown(high, _HZ)}; real teeth are 7 to 13 % of "
            "the way up."
        )
    said.append(
        f"Assumed: {a.metal.name}, {a.ceramic.name} of {shown(a.ceramic_thickness, _M)}, teeth of "
        f"{shown(a.tooth_height, _M)}, {a.driven_sectors} half-wave sectors on the channel."
    )
    return tuple(said)
