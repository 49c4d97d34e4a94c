"""What the terminal shows of a solved disc or stator."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm import quantities as si
from squeezefilm.report.kit.numbers import HZ, M, shown
from squeezefilm.report.kit.terminal import heading, plain_console, table
from squeezefilm.report.plate.terminal_modes import PER_VOLT, show_guidance, show_modes, sound_rows

if TYPE_CHECKING:
    from squeezefilm.analysis.plate.ring import RingAnalysis
    from squeezefilm.plate.ring.stator import StatorFit


def show_ring(result: RingAnalysis) -> None:
    """Print a solved ring: the working mode, how it was fitted, then every mode of the band."""
    console = plain_console()
    heading(console, f"{result.display.title} [{result.display.name}]")
    rows = _mode_rows(result) + _drive_rows(result)
    rows += sound_rows(result.sound, "loudest direction, touched face only")
    table(console, ("", "", ""), rows, fixed=(0,))
    show_guidance(console, result.sound)
    if result.body.fit is not None:
        for sentence in fit_sentences(result.body.fit):
            console.print(sentence)
    show_modes(console, result.rows, result.amplitude_per_volt)
    console.print("B(circles, diameters) bends; R and T move in the plane, radially and around.")
    console.print(f"{result.model}; {result.status}")


def _mode_rows(result: RingAnalysis) -> list[tuple[str, str, str]]:
    """The working mode: its frequency, its amplitude per volt, where it stands still."""
    mode = result.working
    rows = [
        (
            f"Mode {mode.label}",
            shown(mode.frequency, HZ, 5),
            f"± {shown(mode.frequency_error, HZ, 2)} (estimated)"
            + ("; fitted, not predicted" if result.body.fit is not None else ""),
        ),
        (
            "Amplitude per volt",
            shown(result.amplitude_per_volt, PER_VOLT),
            "largest, touched face",
        ),
        (
            "",
            shown(result.centreline_per_volt, PER_VOLT),
            "antinodes of the mean circumference" if result.mode.harmonic else "inner lobe",
        ),
    ]
    if result.described_amplitude_per_volt is not None:
        rows.append(
            ("", shown(result.described_amplitude_per_volt, PER_VOLT), "described as measured")
        )
    if mode.half_wavelength is not None:
        rows.append(
            (
                "Half wavelength",
                shown(mode.half_wavelength, M),
                f"along the {result.half_wavelength_along}",
            )
        )
    if result.circles.size:
        rows.append(
            ("Nodal circles", ", ".join(shown(float(r), M, 3) for r in result.circles), "radius")
        )
    return rows


def _drive_rows(result: RingAnalysis) -> list[tuple[str, str, str]]:
    """What drives it: losses, coupling, current and power at the voltage, equivalent circuit."""
    mode, volts = result.working, result.display.drive.voltage
    rows = [
        (
            "Quality factor",
            f"{mode.quality_factor:.4g}",
            "from the losses of its materials"
            if result.body.quality_factor is None
            else "of the assembly, as described",
        ),
        ("Effective coupling", f"{mode.coupling:.3g}", ""),
        (
            f"At {shown(volts, si.Unit('V'))}",
            shown(result.response.current(volts), si.Unit("A"), 3),
            f"{result.response.apparent_power(volts):.3g} VA, "
            f"{result.response.input_power(volts):.3g} W",
        ),
    ]
    if result.circuit is not None:
        c = result.circuit
        rows.append(
            (
                "Equivalent circuit",
                f"C0 {shown(c.static_capacitance, si.Unit('F'), 3)}",
                f"R1 {shown(c.motional_resistance, si.Unit('ohm'), 3)}, "
                f"L1 {c.motional_inductance:.3g} H, "
                f"C1 {shown(c.motional_capacitance, si.Unit('F'), 3)}",
            )
        )
    return rows


def fit_sentences(fit: StatorFit) -> tuple[str, ...]:
    """What was fitted of a stator, what the teeth leave uncertain, and what is assumed."""
    a = fit.assumptions
    said = [
        f"Fitted: {shown(fit.ring_thickness, M, 4)} of metal under the teeth, so that "
        f"{fit.mode.label} falls on {shown(fit.mode.frequency, HZ)}, with the mean diameter of "
        f"{shown(fit.derived['mean_diameter'], M, 4)} from the wavelength. One frequency fits one "
        "dimension and validates nothing."
    ]
    if a.tooth_height > 0:
        low, high = fit.frequency_bounds
        said.append(
            f"Teeth: an equivalent layer of {a.tooth_fill:.0%} metal ({a.tooth_model}). Between "
            f"teeth without hoop stiffness and teeth as stiff as their share of metal, this body "
            f"lies between {shown(low, HZ)} and {shown(high, HZ)}; real teeth are 7 to 13 % of "
            "the way up."
        )
    said.append(
        f"Assumed: {a.metal.name}, {a.ceramic.name} of {shown(a.ceramic_thickness, M)}, teeth of "
        f"{shown(a.tooth_height, M)}, {a.driven_sectors} half-wave sectors on the channel."
    )
    return tuple(said)
