"""Terminal output of a friction: the number with its interval first, then why."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import HZ, SPEED, M, N, V, printable, shown
from squeezefilm.core.kit.terminal import heading, plain_console, table
from squeezefilm.design.analysis.report.decisions import interval_rows, wanted_rows
from squeezefilm.design.analysis.report.model_rows import (
    group_words,
    influence_rows,
    show_missed,
    weight_rows,
)
from squeezefilm.design.analysis.report.point_rows import (
    place_rows,
    reduction_row,
)
from squeezefilm.design.plate.report.heat_and_sound import heat_rows

if TYPE_CHECKING:
    from squeezefilm.design.friction.command import FrictionAnalysis
    from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

_RANKED = 6


def show_friction(result: FrictionAnalysis) -> None:
    """Print a friction analysis."""
    console, p = plain_console(), result.prediction
    heading(console, f"{result.display.title} [{result.display.name}]")
    unsure = result.uncertainty
    if unsure is None:
        console.print(f"µ′/µ = {p.relative_friction:.2f} as described")
    else:
        console.print(f"{unsure.sentence}: {si.percent(unsure.level)} interval. {unsure.standing}.")
    for finding in result.verdict:
        console.print(f"{finding.kind}: {finding.text}")
    table(console, ("", "", ""), _rows(result), fixed=(0,))
    heading(console, "The same finger by other models")
    others: list[tuple[str, str]] = [
        (curve.model, "–" if (at := curve.at(p.vibration_amplitude)) is None else f"{at:.3f}")
        for curve in result.curves
    ]
    table(console, ("model", "µ′/µ"), others)
    show_missed(console, p.model)
    if unsure is not None:
        _ranking(unsure)
    for text in p.warnings:
        console.print(f"! {printable(text)}")


def _rows(result: FrictionAnalysis) -> list[tuple[str, str, str]]:
    """The lines of the table: the drive, what carries the finger, its friction."""
    p = result.prediction
    drive = "amplitude given" if p.voltage is None else f"at {shown(p.voltage, V)}"
    rows = [
        ("Vibration amplitude", shown(p.vibration_amplitude, M), f"antinode, finger on, {drive}"),
        *interval_rows(result.uncertainty),
        ("Drive frequency", shown(p.frequency, HZ), ""),
    ]
    if p.touch.mode is not None:
        rows.append(
            (
                "The finger leaves",
                f"{100 * p.touch.kept:.3g} %",
                f"of {shown(p.touch.free_amplitude, M)}; it moves the resonance by "
                f"{p.touch.mode.resonance_frequency - p.touch.mode.free_frequency:+.1f} Hz and Q "
                f"from {p.touch.mode.free_quality_factor:.3g} to {p.touch.mode.quality_factor:.3g}",
            )
        )
    felt = p.touch.impedance
    if felt is not None:
        like = "mass" if felt.imag > 0 else "spring"
        rows.append(
            (
                "Finger's impedance",
                f"{felt.real:.3g} {'+' if felt.imag > 0 else '−'} {abs(felt.imag):.3g}i N·s/m",
                f"at an antinode, damping and {like}",
            )
        )
    rows += [
        ("Surface", p.surface.name, f"roughness {shown(p.surface.roughness, M)}"),
        ("Normal force", shown(p.normal_force, N), ""),
        ("Finger speed", shown(p.speed, SPEED), "of sliding"),
        ("Ambient pressure", shown(result.display.gas.ambient_pressure, si.Unit("Pa")), ""),
    ]
    if p.law.kind.friction == "lift":
        rows.append(("Film carries", f"{100 * (1 - p.relative_friction):.3g} %", "of the load"))
    elif (sharing := p.touch.sharing) is not None:
        rows += [
            ("Film carries", f"{100 * float(sharing.film_share[0]):.3g} %", "of the load"),
            (
                "Asperities carry",
                f"{100 * (1 - float(sharing.film_share[0])):.3g} %",
                f"mean gap {shown(float(sharing.mean_gap[0]), M, 3)}",
            ),
        ]
    rows += _friction_rows(result)
    return rows + heat_rows(p.heat) if p.voltage else rows


def _friction_rows(result: FrictionAnalysis) -> list[tuple[str, str, str]]:
    """The friction itself, between which limits it lies, its ripple, and what was asked for."""
    p = result.prediction
    rows = [
        ("Relative friction µ′/µ", f"{p.relative_friction:.2f}", p.model),
        *place_rows(p, result.active_area),
        reduction_row(p),
        ("Tangential force", shown(p.tangential_force, N, 3), "sliding steadily"),
    ]
    if p.relative_friction_limits is not None:
        own, tied = p.relative_friction_limits
        balance = "each ridge at its own balance, all at one mean gap"
        rows.append(("A softer, a stiffer pad", f"{own:.3f}, {tied:.3f}", balance))
    if (wave := result.ripple) is not None:
        remark = f"every {shown(wave.half_wavelength, M, 3)}, at constant amplitude"
        rows.append(("Ripple of the wave", f"{100 * wave.ripple:.2g} %", remark))
    return rows + wanted_rows(result.wanted)


def _ranking(unsure: UncertainFriction) -> None:
    """Print what makes the friction uncertain, in two groups, and the weights of the laws."""
    console = plain_console()
    for group in unsure.groups:
        heading(console, group_words(group))
        rows = influence_rows(unsure, group.knowledge, _RANKED)
        table(console, ("drawn", "from", "share", ""), rows, fixed=(0,))
    heading(console, "Laws and states that are drawn, by weights that are assumed")
    table(console, ("", "", "weight", "why"), weight_rows(unsure), fixed=(0, 1))
    refused = unsure.refused
    console.print(
        f"{refused.evaluations} draws; seed {unsure.seed}; "
        + (refused.sentence if refused.count else "none was refused")
    )
