"""A friction in the terminal, its interval first, and its figures: models, map, draws, ripple."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.model_looks import look_of
from squeezefilm.core.kit.numbers import HZ, SPEED, M, N, V, decimals, printable, shown
from squeezefilm.core.kit.page_style import FigureOf, drawn_figures, picture_files
from squeezefilm.core.kit.terminal import heading, say, table
from squeezefilm.design.analysis.report.rows import (
    group_words,
    influence_rows,
    interval_rows,
    place_rows,
    reduction_row,
    show_missed,
    wanted_rows,
    weight_rows,
)
from squeezefilm.design.plate.report.terminal import heat_rows
from squeezefilm.physics.chain.pad_law import MODEL_KINDS
from squeezefilm.physics.uncertainty.parameters import parameter_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from squeezefilm.design.friction import FrictionAnalysis
    from squeezefilm.physics.chain.friction import FrictionLaw
    from squeezefilm.physics.chain.prediction import Prediction
    from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

_RANKED = 6


@style.drawn
def models(result: FrictionAnalysis) -> Figure:
    """Every model's µ′/µ against amplitude, the working point with its interval."""
    curves, p, unsure = result.curves, result.prediction, result.uncertainty
    said = f"µ′/µ = {p.relative_friction:.2f}" if unsure is None else unsure.sentence
    figure, axes = style.new_axes(
        f"At {shown(p.vibration_amplitude, M, 3)} on {style.plain(p.surface.name, 20)} {said}: the "
        "model decides; two are fitted to measured curves",
        f"as in the legend; {shown(p.normal_force, N)}",
        5.4,
    )
    for curve in curves:
        color, dashes, name = look_of(curve.model)
        name += f", at {shown(p.speed, SPEED)}" if MODEL_KINDS[curve.model].fitted else ""
        x, width = 1e6 * curve.amplitude, 2.4 if curve.model == p.model else 1.4
        axes.plot(x, curve.relative_friction, color=color, ls=dashes, lw=width, label=name)
    at, words = 1e6 * p.vibration_amplitude, f"{p.relative_friction:.2f}"
    if unsure is not None:
        low, high = unsure.interval
        style.interval(axes, at, low, high)
        words += f" ({low:.2f}–{high:.2f}, {si.percent(unsure.level)}, median {unsure.median:.2f})"
    style.mark(axes, at, p.relative_friction, 8, f"this display, {p.model}: {words}")
    style.friction_axes(axes, 1e6 * float(curves[0].amplitude[-1]))
    style.legend_below(axes, columns=2)
    return figure


@style.drawn
def predictions(every: Sequence[Prediction]) -> Figure:
    """Predicted friction against amplitude: each law, and on it the working points."""
    first = every[0]
    said = f"µ′/µ = {first.relative_friction:.2f} at {shown(first.vibration_amplitude, M, 3)}"
    if len(every) > 1:
        frictions = [prediction.relative_friction for prediction in every]
        said = f"{len(every)} predictions: µ′/µ from {min(frictions):.2f} to {max(frictions):.2f}"
    figure, axes = style.new_axes(
        said, ", ".join(dict.fromkeys(prediction.model for prediction in every)), 4.4
    )
    reach: dict[FrictionLaw, float] = {}
    for prediction in every:
        reach[prediction.law] = max(
            reach.get(prediction.law, 0.5e-6), prediction.vibration_amplitude
        )
    for number, (law, highest) in enumerate(reach.items()):
        color, dashes = style.LINES[number % len(style.LINES)]
        table = law.table(highest)
        axes.plot(1e6 * table.amplitude, table.at_speed(law.speed), color=color, ls=dashes)
    for prediction in every:
        style.mark(axes, 1e6 * prediction.vibration_amplitude, prediction.relative_friction, 7)
    style.friction_axes(axes)
    return figure


@style.drawn
def friction_map(result: FrictionAnalysis) -> Figure:
    """µ′/µ over amplitude and force, the working point marked."""
    grid, p = result.map, result.prediction
    figure, axes = style.new_axes(
        f"µ′/µ is {p.relative_friction:.2f} at {shown(p.vibration_amplitude, M, 3)} and "
        f"{shown(p.normal_force, N, 3)}; over these ranges it goes from "
        f"{np.nanmin(grid.relative_friction):.2f} to {np.nanmax(grid.relative_friction):.2f}",
        grid.model,
        4.8,
    )
    levels = np.linspace(0, 1, 11)
    surface = 1e6 * grid.amplitude, grid.normal_force, grid.relative_friction
    filled = axes.contourf(*surface, levels=levels, cmap="cividis")
    lines = axes.contour(*surface, levels=levels[1:-1:2], colors=style.PAPER, linewidths=1.0)
    axes.clabel(lines, fmt=lambda v: f"{v:.1f}", fontsize=9)
    here = 1e6 * p.vibration_amplitude, p.normal_force
    style.mark(axes, *here, 9, "this display", color=style.ORANGE, clip_on=True)
    figure.colorbar(filled, ax=axes, label="relative friction µ′/µ")
    axes.set(yscale="log", xlabel="vibration amplitude, zero-to-peak (µm)")
    axes.set(ylabel="normal force (N)")
    style.legend_below(axes)
    return figure


@style.drawn
def uncertainty(result: FrictionAnalysis) -> Figure:
    """Figure of the distribution of µ′/µ (left), and of the parameters that make it so (right)."""
    unsure = result.uncertainty
    assert unsure is not None, "asked without samples"
    low, high = unsure.interval
    first = next(
        influence
        for influence in unsure.influences
        if influence.parameter.knowledge == "measurable"
    )
    figure = style.new_figure(
        f"{unsure.sentence}; to know it better, measure the {parameter_name(first.parameter.path)}",
        f"{unsure.model}, {unsure.refused.evaluations} draws",
        4.8,
    )
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.15])
    left.hist(unsure.samples, bins=24, range=(0, 1), color=style.BLUE, alpha=0.85)
    left.axvspan(
        low, high, color=style.BAND, zorder=0, label=f"{si.percent(unsure.level)} interval"
    )
    name = f"as described: {unsure.nominal:.2f}"
    left.axvline(unsure.nominal, color=style.INK, lw=1.6, label=name)
    name = f"median: {unsure.median:.2f}"
    left.axvline(unsure.median, color=style.INK, lw=1.6, ls=(0, (4, 2)), label=name)
    left.set(xlabel="relative friction µ′/µ", ylabel="draws", xlim=(0, 1))
    style.legend_below(left, columns=1)
    ranked = unsure.influences[:8][::-1]
    rows = np.arange(len(ranked))
    whole = [100 * max(i.total, 0) for i in ranked]
    errors = [100 * i.total_error for i in ranked]
    known = [i.parameter.knowledge == "measurable" for i in ranked]
    for of_group, color, name in (
        (known, style.BLUE, "could be measured"),
        ([not measurable for measurable in known], style.ORANGE, "nobody knows"),
    ):
        here = np.flatnonzero(of_group)
        look = {**style.BARS, "color": color}
        right.barh(
            here,
            np.take(whole, here),
            xerr=np.take(errors, here),
            ecolor=style.MUTED,
            label=name,
            **look,
        )
    right.set_yticks(rows, [parameter_name(i.parameter.path) for i in ranked])
    right.set(xlabel="share of the variance of µ′/µ (%)", xlim=(0, None))
    right.grid(visible=False, axis="y")
    style.legend_below(right, columns=1)
    return figure


@style.drawn
def ripple(result: FrictionAnalysis) -> Figure:
    """The friction as the pad moves along the standing wave, at constant amplitude."""
    wave = result.ripple
    assert wave is not None, "nothing vibrates"
    half = wave.half_wavelength
    x = np.concatenate([wave.position, wave.position + half, [2 * half]])
    y = np.concatenate([wave.relative_friction] * 2 + [wave.relative_friction[:1]])
    figure, axes = style.new_axes(
        f"The wave itself is felt: {100 * wave.ripple:.2g} % of ripple every "
        f"{shown(half, M, 3)} under a contact of {shown(wave.contact_length, M, 3)}",
        f"{result.prediction.model}, ridge by ridge",
        4.0,
    )
    axes.plot(1e3 * x, y, color=style.BLUE, label="relative friction of the whole pad")
    axes.axhline(wave.mean, **style.REFERENCE, label=f"mean {wave.mean:.2f}")
    for node in (0.5 * half, 1.5 * half):
        name = "nodal lines" if node < half else None
        axes.axvline(1e3 * node, color=style.INK, lw=0.9, ls=(0, (1, 2)), label=name)
    axes.set(xlabel="centre of the pad, from an antinode (mm)", ylabel="relative friction µ′/µ")
    axes.set(xlim=(0, 2e3 * half), ylim=(0, 1.04))
    style.legend_below(axes)
    return figure


FIGURES = (
    FigureOf("models", "Friction by every model", models),
    FigureOf("map", "Friction over amplitude and force", friction_map),
    FigureOf(
        "uncertainty", "How sure it is", uncertainty, has=lambda friction: friction.uncertainty
    ),
    FigureOf("ripple", "The standing wave", ripple, has=lambda friction: friction.ripple),
)


def write_friction(result: FrictionAnalysis, folder: Path) -> Path:
    """Write friction.json, and the figures as PNG, into `folder`; the folder."""
    summary = result.summary()
    grid = result.map
    summary["map"] = {
        "vibration_amplitude_m": grid.amplitude,
        "normal_force_N": grid.normal_force,
        "relative_friction": grid.relative_friction,
    }
    pictures = picture_files(drawn_figures(FIGURES, result, "friction-"))
    write_folder(folder, {"friction.json": json_text(summary), **pictures})
    return folder


def show_friction(result: FrictionAnalysis) -> None:
    """Print a friction analysis."""
    p = result.prediction
    heading(f"{result.display.title} [{result.display.name}]")
    unsure = result.uncertainty
    if unsure is None:
        say(f"µ′/µ = {p.relative_friction:.2f} as described")
    else:
        say(f"{unsure.sentence}: {si.percent(unsure.level)} interval. {unsure.standing}.")
    for finding in result.verdict:
        say(f"{finding.kind}: {finding.text}")
    table(("", "", ""), _rows(result), fixed=(0,))
    heading("The same finger by other models")
    others: list[tuple[str, str]] = [
        (curve.model, decimals(curve.at(p.vibration_amplitude), 3)) for curve in result.curves
    ]
    table(("model", "µ′/µ"), others)
    show_missed(p.model)
    if unsure is not None:
        _ranking(unsure)
    for text in p.warnings:
        say(f"! {printable(text)}")


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
    for group in unsure.groups:
        heading(group_words(group))
        rows = influence_rows(unsure, group.knowledge, _RANKED)
        table(("drawn", "from", "share", ""), rows, fixed=(0,))
    heading("Laws and states that are drawn, by weights that are assumed")
    table(("", "", "weight", "why"), weight_rows(unsure), fixed=(0, 1))
    refused = unsure.refused
    say(
        f"{refused.evaluations} draws; seed {unsure.seed}; "
        + (refused.sentence if refused.count else "none was refused")
    )
