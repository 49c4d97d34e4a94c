"""The numbers of an analysis in words and units: what the page and the terminal both show."""

from __future__ import annotations

import dataclasses
import math
import typing
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from squeezefilm import quantities as si
from squeezefilm.analysis.claims.record import missed_by
from squeezefilm.report.kit.area_rows import place_rows

if typing.TYPE_CHECKING:
    from squeezefilm.analysis.analyze import Analysis
    from squeezefilm.analysis.influences import GroupInfluence
    from squeezefilm.analysis.parameters import Knowledge
    from squeezefilm.analysis.uncertainty import UncertainFriction
    from squeezefilm.chain.prediction import Prediction
    from squeezefilm.display import Display
    from squeezefilm.plate.heat.warming import Warming
    from squeezefilm.plate.working_mode import WorkingMode
    from squeezefilm.render.fidelity.report import FidelityReport

M, HZ, S, N, V = si.Unit("m"), si.Unit("Hz"), si.Unit("s"), si.Unit("N"), si.Unit("V")


@dataclass(frozen=True)
class Value:
    """One value of a display's description: its path, its text, where it is from."""

    path: str
    text: str
    source: str
    evidence: str


def shown(value: float, unit: si.Unit, digits: int = 4) -> str:
    """A quantity as a person reads it, e.g. ``"2 µm"``."""
    text = micro(si.format_quantity(value, unit, digits))
    number, _, symbol = text.partition(" ")
    # 0.6 µm and 0.5 N are what the field says, not 600 nm and 500 mN.
    larger = {"n": "µ", "µ": "m"} | ({"m": ""} if unit.symbol in ("N", "V") else {})
    base = unit.symbol
    known = base in ("m", "s", "N", "V") and symbol != base and symbol[:1] in larger
    if known and abs(float(number)) >= 100:
        return f"{float(number) / 1000:.{digits}g} {larger[symbol[0]]}{base}"
    return text


def micro(text: str) -> str:
    """The text of a quantity with the micro sign in place of the u that is typed for it."""
    head, separator, unit = text.rpartition(" ")
    return f"{head}{separator}µ{unit[1:]}" if separator and unit[:1] == "u" else text


def printable(text: str) -> str:
    """A user's text in one line without control characters (a terminal would obey them)."""
    return " ".join(
        "".join(" " if unicodedata.category(c) in ("Cc", "Cf", "Cs") else c for c in text).split()
    )


def key_numbers(analysis: Analysis) -> list[tuple[str, str, str]]:
    """The results in the order of the chain: drive, vibration, film, friction, texture.

    Each is what it is, its value with unit, a remark or nothing.
    """
    p = analysis.prediction
    here = next(
        c for c in analysis.friction_curves if c.surface == p.surface.name and c.model == p.model
    )
    given = p.voltage is None
    # The resonance is defined to many digits only: an off-resonance drive is worth a line.
    off = abs(p.frequency / p.mode.resonance_frequency - 1) > 1e-6
    drive = "none" if p.voltage is None else shown(p.voltage, V)
    per_volt = shown(p.mode.amplitude_per_volt, si.Unit("m/V"))
    at_criterion = _reached(here.amplitude_for_criterion)
    rows = [
        ("Resonance frequency", shown(p.mode.resonance_frequency, HZ), _mode(p.mode)),
        ("Quality factor", f"{p.mode.quality_factor:.4g}", ""),
        ("Half wavelength", shown(p.mode.half_wavelength, M), ""),
        ("Drive voltage", drive, "amplitude given instead" if given else "zero-to-peak"),
        ("Drive frequency", shown(p.frequency, HZ), "off resonance" if off else "at resonance"),
        ("Amplitude per volt", per_volt, "at resonance"),
        ("Vibration amplitude", shown(p.vibration_amplitude, M), _kept(p)),
        ("Surface", printable(p.surface.name), f"roughness {shown(p.surface.roughness, M)}"),
        ("Normal force", shown(p.normal_force, N), ""),
        speed_row(p),
        ("Squeeze number", f"{p.squeeze_number:.4g}", ""),
        ("Mean pressure", f"{p.mean_pressure:.4f}", "over ambient, contact and period"),
        ("Relative friction µ′/µ", f"{p.relative_friction:.3f}", _sure(analysis)),
        *place_rows(p, analysis.active_area),
        reduction_row(p),
        ("Amplitude for µ′/µ = 0.7", at_criterion, "the paper asks for it"),
        ("Amplitude for no friction", _reached(here.zero_friction_amplitude), "the finger floats"),
        ("Envelope time constant", shown(analysis.envelope_time_constant, S), ""),
        ("Envelope bandwidth", shown(analysis.envelope_bandwidth, HZ), "of a texture's changes"),
    ]
    if (table := analysis.fidelity) is not None:
        wave = f"fundamental {100 * table.fundamental_at_limit:.0f} %"
        remark = f"swing {100 * table.kept:.0f} %, {wave} kept"
        rows += [
            (f"Finest grating at {speed}", shown(period, M, 3), remark)
            for speed, period in analysis.finest_period().items()
        ]
    return rows + heat_rows(p.heat) if p.voltage else rows


def heat_rows(heat: Warming | None) -> list[tuple[str, str, str]]:
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
    resistance = si.format_quantity(heat.thermal_resistance, si.Unit("K/W"), 3)
    return [
        (
            "Temperature rise",
            f"{follows.temperature_rise:+.3g} K",
            f"where the frequency follows; {stays.temperature_rise:+.3g} K {at}",
        ),
        (
            "Drift of the resonance",
            f"{follows.resonance_drift:+.3g} Hz",
            f"{stays.resonance_drift:+.3g} Hz {at}; half-bandwidth "
            f"{shown(heat.half_bandwidth, HZ, 3)}",
        ),
        (
            "Amplitude warm",
            shown(follows.amplitude, M, 3),
            "where the frequency follows, without a finger",
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


def speed_row(p: Prediction) -> tuple[str, str, str]:
    """The finger's speed that the friction is for: quantity, value, remark."""
    return "Finger speed", shown(p.speed, si.Unit("m/s")), "of sliding"


def reduction_row(p: Prediction) -> tuple[str, str, str]:
    """What vibration takes away of the friction."""
    reduction, coefficient = f"{p.friction_reduction:.3f}", f"{p.friction_coefficient:.3g}"
    return "Friction reduction µ − µ′", reduction, f"of µ = {coefficient}"


def _kept(p: Prediction) -> str:
    """What the amplitude is, with what the finger leaves of it where that is known."""
    if p.touch.mode is None:
        return "zero-to-peak, at antinodes"
    return f"zero-to-peak, at antinodes; the finger leaves {100 * p.touch.kept:.3g} %"


def _sure(analysis: Analysis) -> str:
    unsure = analysis.uncertainty
    if unsure is None:
        return "1 without vibration"
    low, high = unsure.interval
    return f"{low:.2f} to {high:.2f} ({unsure.level:.0%} interval, median {unsure.median:.2f})"


def influence_rows(unsure: UncertainFriction, knowledge: Knowledge, most: int) -> list[list[str]]:
    """What of a group makes a friction uncertain, the most important first: its path, what is drawn
    of it, its share of the variance with all its company, and whose range or weights these are."""
    group = [one for one in unsure.influences if one.parameter.knowledge == knowledge]
    return [
        [
            one.parameter.path,
            micro_words(one.parameter.spread, law=hasattr(one.parameter, "options")),
            f"{one.total:.0%} ± {one.total_error:.0%}",
            "as described"
            if one.parameter.origin == "given"
            else "assumed weights"
            if hasattr(one.parameter, "options")
            else "assumed range",
        ]
        for one in group[:most]
    ]


def micro_words(spread: tuple[str, ...], *, law: bool) -> str:
    """Options with their weights, or from where to where a value is drawn."""
    return ", ".join(spread) if law else " to ".join(map(micro, spread))


def group_words(one: GroupInfluence) -> str:
    """What a group of inputs is, and what it carries of the width, as a heading."""
    what = {"measurable": "Could be measured", "unknown": "Nobody knows"}[one.knowledge]
    return (
        f"{what}: {one.total:.0%} ± {one.error:.0%} of the variance, {max(one.alone, 0):.0%} "
        "by itself"
    )


def weight_rows(unsure: UncertainFriction) -> list[list[str]]:
    """The laws and states that are drawn, each with its assumed weight and why."""
    choices = [one.parameter for one in unsure.influences if hasattr(one.parameter, "options")]
    return [
        [choice.path, option.name, f"{option.weight:.0%}", option.why]
        for choice in sorted(choices, key=lambda one: one.path)
        for option in choice.options
    ]


def _mode(mode: WorkingMode) -> str:
    """The mode's label, with the solver's error where one solved it."""
    if mode.frequency_error is None:
        return mode.label
    return f"{mode.label}, solved to ± {shown(mode.frequency_error, HZ, 2)}"


def _reached(amplitude: float | None) -> str:
    return "out of reach" if amplitude is None else shown(amplitude, M, 3)


def models(analysis: Analysis) -> list[tuple[str, str]]:
    """Which model made what, as pairs."""
    p = analysis.prediction
    rows = [
        ("Resonance and mode shape", p.mode.model),
        ("Vibration amplitude", p.amplitude_model),
        ("Pressure and friction", p.model),
    ]
    if analysis.texture is not None:
        rows.append(("Envelope and textures", analysis.texture.model))
    return rows


MISSED_HEADING = "What measurements say and '{}' does not"


def missed_directions(model: str, *, why: bool = False) -> list[str]:
    """The published directions that a friction model misses, as sentences with their sources, and
    `why` where asked for; from the claims on record."""
    missed = missed_by(model)
    if missed is None:
        return [f"Published directions were not asked of the model '{model}'."]
    if not missed:
        return ["None of those on record; `squeezefilm reproduce` lists them."]
    return [
        f"{one.says} ({cited(one.where)})." + (f" In the model: {one.why}." if why else "")
        for one in missed
    ]


def cited(where: str) -> str:
    """A place in the source paper by the paper's name; another source as it stands."""
    return f"Biet et al., {where}" if where.startswith("section") else where


def theory_rows(analysis: Analysis) -> list[tuple[str, str, str, str]]:
    """Model, resonance, half wavelength and amplitude: as used, then by each other theory."""
    p = analysis.prediction
    used = (
        p.mode.model + " (used)",
        p.mode.resonance_frequency,
        p.mode.half_wavelength,
        p.vibration_amplitude,
    )
    others = [
        (other.model, other.resonance_frequency, other.half_wavelength, other.vibration_amplitude)
        for other in analysis.other_models
    ]
    return [
        (
            model,
            shown(frequency, HZ),
            "–" if half is None else shown(half, M),
            "–" if amplitude is None else shown(amplitude, M, 3),
        )
        for model, frequency, half, amplitude in (used, *others)
    ]


def unsaid_warnings(analysis: Analysis) -> list[str]:
    """The warnings that the verdict does not already say word for word."""
    said = {finding.text for finding in analysis.verdict}
    return [text for text in analysis.prediction.warnings if text not in said]


def display_values(display: Display) -> list[Value]:
    """Every value of a display with its unit, its source and the evidence behind it.

    Members of lists are counted from 1, as the messages of `config.load` count them.
    """
    rows = []
    for path, value, hint, _ in leaves(display):
        unit = si.unit_of(hint)
        origin = display.provenance.get(".".join(str(part) for part in path))
        if isinstance(value, float | int) and not isinstance(value, bool):
            text = shown(value, unit, 6) if unit is not None else f"{value}"
        else:
            text = str(value)
        source, evidence = ("", "") if origin is None else (origin.source, origin.evidence)
        rows.append(Value(dotted(path), text, source, evidence))
    return rows


def dotted(path: tuple[str | int, ...]) -> str:
    """A path as people read it: list members counted from 1."""
    return ".".join(str(part + 1) if isinstance(part, int) else part for part in path)


class Leaf(NamedTuple):
    """One value of a description: where it stands, its annotation, its field."""

    path: tuple[str | int, ...]
    value: Any
    hint: Any
    field: dataclasses.Field[Any]


def leaves(node: Any, path: tuple[str | int, ...] = ()) -> Iterator[Leaf]:
    """Every value below a dataclass that a file may hold, in order; none for one left out."""
    hints = typing.get_type_hints(type(node), include_extras=True)
    for field in dataclasses.fields(node):
        if field.metadata.get("loader"):
            continue
        value, here = getattr(node, field.name), (*path, field.name)
        if dataclasses.is_dataclass(value):
            yield from leaves(value, here)
        elif isinstance(value, tuple):
            for index, item in enumerate(value):
                yield from leaves(item, (*here, index))
        elif value is not None:
            yield Leaf(here, value, hints[field.name], field)


def lag_rows(judged: FidelityReport, what: str = "Lag") -> list[tuple[str, str, str]]:
    """How far the rendered pattern trails the finger, in a line; none where that is not known."""
    if not math.isfinite(judged.lag):
        return []
    word = "behind" if judged.lag >= 0 else "ahead of"
    late = f"{shown(abs(judged.lag_time), S, 2)} at {1e3 * judged.mean_speed:.3g} mm/s"
    return [(what, f"{1e3 * judged.lag:.3f} mm", f"{word} the finger, {late}")]


def film_rows(analysis: Analysis) -> list[tuple[str, str, str, str]]:
    """Model, over-pressure with its error, share of the finger carried, relative friction."""
    if analysis.film_models is None:
        return []
    rows: list[tuple[str, str, str, str]] = []
    for item in analysis.film_models.results:
        said = ("not solved", "–", "–")
        if math.isfinite(item.over_pressure):
            error = f" ± {item.over_pressure_error:.1g}" if item.over_pressure_error else ""
            carried = f"{100 * item.load_share:.3g} %"
            said = f"{item.over_pressure:.3g}{error}", carried, f"{item.relative_friction:.3f}"
        rows.append((item.model, *said))
    return rows
