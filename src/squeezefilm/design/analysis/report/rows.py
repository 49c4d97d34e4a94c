"""Rows of a working point and what one decides from: place, load, intervals, influences, models."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.config.schema import leaves
from squeezefilm.core.kit.numbers import FARAD, HENRY, HZ, A, M, Row, V, W, decimals, dotted, shown
from squeezefilm.core.kit.terminal import bullets, heading
from squeezefilm.design.analysis.published_claims import missed_by
from squeezefilm.physics.chain.active_area import CRITERIA, percent
from squeezefilm.physics.chain.pad_place import place_words
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.senses import FINEST_TRIED

if TYPE_CHECKING:
    from squeezefilm.design.analysis.analysis import Analysis
    from squeezefilm.design.analysis.area_odds import JudgedArea
    from squeezefilm.design.analysis.felt import FeltAt, FeltGratings
    from squeezefilm.design.analysis.sensitivities import DisplaySensitivities, DisplaySensitivity
    from squeezefilm.design.analysis.wanted import Wanted
    from squeezefilm.physics.chain.prediction import Prediction
    from squeezefilm.physics.plate.electronics import ElectricalLoad
    from squeezefilm.physics.uncertainty.intervals import GroupInfluence
    from squeezefilm.physics.uncertainty.parameters import Knowledge
    from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

SHOWN = 12
OUT_OF_REACH = "out of reach"


def interval_rows(unsure: UncertainFriction | None) -> list[Row]:
    """The intervals of amplitude and power: quantity, value, remark."""
    if unsure is None or unsure.amplitude_interval is None:
        return []
    low, high = (shown(end, M, 3) for end in unsure.amplitude_interval)
    rows = [("", f"{low} to {high}", f"{si.percent(unsure.level)} interval of the amplitude")]
    if unsure.power is not None:
        rows.append(("Power taken", shown(unsure.power, W, 3), "plate and finger, cold"))
    if unsure.power_interval is not None:
        low, high = (shown(end, W, 3) for end in unsure.power_interval)
        rows.append(("", f"{low} to {high}", f"{si.percent(unsure.level)} interval of the power"))
    return rows


def wanted_rows(wanted: Wanted | None) -> list[Row]:
    """Rows of what a wanted friction takes, as described and over the draws."""
    if wanted is None:
        return []
    label = f"For µ′/µ = {wanted.relative_friction:.3g}"
    if wanted.voltage is None or wanted.vibration_amplitude is None:
        rows = [(label, "not reached", wanted.why_not)]
    else:
        amplitude = f"{shown(wanted.vibration_amplitude, M, 3)}, as described"
        rows = [(label, shown(wanted.voltage, V, 3), amplitude)]
    unsure = wanted.uncertain
    if unsure is None:
        why = wanted.why_no_interval
        return [*rows, ("", "no interval", why)] if why else rows
    low, high, median = (
        shown(volts, V, 3, OUT_OF_REACH) for volts in (*unsure.interval, unsure.median)
    )
    level = f"{si.percent(unsure.level)} interval, median {median}"
    rows.append(("", f"{low} to {high}", level))
    within = si.percent(1 - unsure.beyond)
    never = f"; in {si.percent(unsure.never)} no voltage does" if unsure.never else ""
    remark = f"of the draws reach it at the drive's {shown(unsure.limit, V)}{never}"
    return [*rows, ("", within, remark)]


def felt_rows(felt: FeltGratings | None, speed: si.MetrePerSecond | None = None) -> list[Row]:
    """The finest grating that is felt, by finger speed; at one of them only (m/s) if asked."""
    if felt is None:
        return []
    return [
        (
            f"Finest grating felt at {1e3 * at_speed.speed:g} mm/s",
            _period(at_speed.felt),
            _felt_remark(felt, at_speed),
        )
        for at_speed in felt.at
        if speed in (None, at_speed.speed)
    ]


def _felt_remark(felt: FeltGratings, at_speed: FeltAt) -> str:
    survives = f"; {shown(at_speed.survives, M, 2)} survives the resonator"
    if at_speed.interval is None:
        return f"by the senses of '{felt.observer}'{survives}"
    low, high = (_period(end) for end in at_speed.interval)
    said = "in all draws"
    if low != high:
        said = f"{low} at best and {high} at worst ({si.percent(felt.level)} interval)"
    never = f"; none is felt in {si.percent(at_speed.never)} of the draws" if at_speed.never else ""
    return said + never + survives


def _period(value: si.Metre | None) -> str:
    if value is None:
        return "none"
    if value < 1.001 * FINEST_TRIED:
        return f"{shown(FINEST_TRIED, M, 3)} or finer"
    return shown(value, M, 2)


def sensitivity_rows(sensitivities: DisplaySensitivities) -> list[list[str]]:
    """The values that change the friction or the frequency most: path, from where to where,
    shifts of frequency and amplitude, µ′/µ, and whose range it is."""
    most = sorted(sensitivities.rows, key=_weight, reverse=True)[:SHOWN]
    return [
        [
            row.path,
            " to ".join(_value(end.value, row.unit) for end in (row.low, row.high)),
            _shifts(row.low.frequency_shift, row.high.frequency_shift),
            _shifts(row.low.amplitude_shift, row.high.amplitude_shift),
            ", ".join(decimals(end.relative_friction, 2) for end in (row.low, row.high)),
            "as described" if row.origin == "given" else "assumed",
        ]
        for row in most
    ]


def _weight(sensitivity: DisplaySensitivity) -> float:
    """A change of friction by 0.1 stands beside one of the frequency by 2 %; what could not be
    told stands last."""
    moved = [sensitivity.low.frequency_shift, sensitivity.high.frequency_shift]
    if None in moved:
        return -1.0
    return max(sensitivity.friction_change / 0.1, *(abs(shift or 0.0) / 0.02 for shift in moved))


def _value(value: float, unit: str) -> str:
    return f"{value:.3g}" if unit == "1" else si.format_quantity(value, si.Unit(unit), 3)


def _shifts(low: float | None, high: float | None) -> str:
    if low is None or high is None:
        return "not known"
    if low == high == 0:
        return "–"
    return f"{100 * low:+.2g} %, {100 * high:+.2g} %".replace("-", "−")


MISSED_HEADING = "What measurements say and '{}' does not"


def models(analysis: Analysis) -> list[tuple[str, str]]:
    """Names of what was computed and of its models, as pairs."""
    p = analysis.prediction
    rows = [
        ("Resonance and mode shape", p.mode.model),
        ("Vibration amplitude", p.amplitude_model),
        ("Pressure and friction", p.model),
    ]
    if analysis.fidelity is not None:
        rows.append(("Envelope and textures", "first-order envelope at resonance, open loop"))
    return rows


def missed_directions(model: str, *, why: bool = False) -> list[str]:
    """The published directions that a friction model misses, as sentences with their sources, and
    `why` where asked for; from the claims on record."""
    missed = missed_by(model)
    if missed is None:
        return [f"Published directions were not asked of the model '{model}'."]
    if not missed:
        return ["None of those on record; `squeezefilm reproduce` lists them."]
    return [
        f"{claim.says} ({cited(claim.where)})." + (f" In the model: {claim.why}." if why else "")
        for claim in missed
    ]


def cited(where: str) -> str:
    """A place in the source paper by the paper's name; another source as it stands."""
    return f"Biet et al., {where}" if where.startswith("section") else where


def theory_rows(analysis: Analysis) -> list[tuple[str, str, str, str]]:
    """Model, resonance, half wavelength and amplitude without a finger, driven at that resonance:
    as used, then by each other theory."""
    p = analysis.prediction
    free = p.touch.free_amplitude
    used = (
        p.mode.model + " (used)",
        p.mode.resonance_frequency,
        p.mode.half_wavelength,
        free if p.voltage is None else p.voltage * p.mode.amplitude_per_volt,
    )
    others = [
        (other.model, other.resonance_frequency, other.half_wavelength, other.vibration_amplitude)
        for other in analysis.other_models
    ]
    return [
        (
            model,
            shown(frequency, HZ),
            shown(half, M),
            shown(amplitude, M, 3),
        )
        for model, frequency, half, amplitude in (used, *others)
    ]


def influence_rows(unsure: UncertainFriction, knowledge: Knowledge, most: int) -> list[list[str]]:
    """Rows of what in a group makes a friction uncertain, the most important first: path, what is
    drawn of it (options with their weights, or from where to where), its share of the variance with
    all its company, and whose range or weights these are."""
    rows = []
    for influence in unsure.influences:
        drawn = influence.parameter
        if drawn.knowledge != knowledge:
            continue
        law = hasattr(drawn, "options")
        assumed = "assumed weights" if law else "assumed range"
        rows.append(
            [
                drawn.path,
                (", " if law else " to ").join(drawn.spread),
                f"{100 * influence.total:.0f} ± {si.percent(influence.total_error)}",
                "as described" if drawn.origin == "given" else assumed,
            ]
        )
    return rows[:most]


def group_words(influence: GroupInfluence) -> str:
    """Heading that names a group of inputs, and what it carries of the width."""
    what = {"measurable": "Could be measured", "unknown": "Nobody knows"}[influence.knowledge]
    return (
        f"{what}: {100 * influence.total:.0f} ± {si.percent(influence.error)} of the variance, "
        f"{100 * max(influence.alone, 0):.0f} ± {si.percent(influence.alone_error)} by itself"
    )


def weight_rows(unsure: UncertainFriction) -> list[list[str]]:
    """The laws and states that are drawn, each with its assumed weight and why."""
    choices = [
        influence.parameter
        for influence in unsure.influences
        if hasattr(influence.parameter, "options")
    ]
    return [
        [choice.path, option.name, si.percent(option.weight), option.why]
        for choice in sorted(choices, key=lambda choice: choice.path)
        for option in choice.options
    ]


def show_missed(model: str) -> None:
    """Print what measurements say and a friction model does not."""
    heading(MISSED_HEADING.format(model))
    bullets([("–", text, "yellow") for text in missed_directions(model)])


def place_rows(p: Prediction, judged: JudgedArea | None) -> list[Row]:
    """Rows of the place meant and of friction over the active area: quantity, value, remark."""
    where = place_words(p.place)
    said = p.place_said.replace(f"{where}, ", "").replace(f", {where}", "")
    rows = [("Place of the finger", where, said)]
    area = None if judged is None else judged.area
    if area is None or area.best_place is None or area.worst_place is None:
        return [
            *rows,
            ("µ′/µ over the active area", "not known", "" if area is None else area.why_not),
        ]
    places = f"at {place_words(area.best_place)} and {place_words(area.worst_place)}"
    shares = ", ".join(
        f"{percent(area.share_below(criterion))} below {criterion:.2f}" for criterion in CRITERIA
    )
    return [
        *rows,
        (
            "µ′/µ over the active area",
            f"{area.best:.2f} to {area.worst:.2f}",
            f"{places}; median {area.median:.2f}; {shares}",
        ),
    ]


def reduction_row(p: Prediction) -> Row:
    """Row of what vibration takes away of the friction."""
    reduction, coefficient = f"{p.friction_reduction:.3f}", f"{p.friction_coefficient:.3g}"
    return "Friction reduction µ − µ′", reduction, f"of µ = {coefficient}"


def electronics_rows(load: ElectricalLoad | None) -> list[Row]:
    """Current, power, slew, inductors, and which class of amplifier can do it."""
    if load is None:
        return [
            ("Electrical load", "not known", "it takes a voltage, and an admittance solved near it")
        ]
    at = f"at {shown(load.voltage, V)} and {shown(load.frequency, HZ)}, without a finger"
    each = f"{load.channels} ceramics in parallel, {{}} each on average"
    rows = [("Electrical load", "assumed in part", load.assumed)] if load.assumed else []
    if load.capacitance is not None and load.capacitance_per_channel is not None:
        own = shown(load.capacitance_per_channel, FARAD, 3)
        together = each.format(own) if load.channels > 1 else "beside the mode"
        rows.append(("Electrode capacitance", shown(load.capacitance, FARAD, 3), together))
    split = f"; {each.format(shown(load.current_per_channel, A, 3))}" if load.channels > 1 else ""
    rows += [
        ("Drive current, peak", shown(load.current, A, 3), at + split),
        (
            "Drive power",
            shown(load.real_power, W, 3),
            f"of {load.apparent_power:.3g} VA apparent; power factor {load.power_factor:.2f}",
        ),
        ("Slew rate", f"{load.slew_rate / 1e6:.3g} V/µs", "the sine's steepest slope"),
    ]
    if load.parallel_inductance is not None and load.series_inductance is not None:
        rows += [
            (
                "Matching inductor",
                f"{shown(load.parallel_inductance, HENRY, 3)} parallel",
                f"the amplifier then gives {shown(load.matched_current, A, 3)} at the same voltage",
            ),
            (
                "",
                f"{shown(load.series_inductance, HENRY, 3)} in series",
                f"the amplifier then gives {shown(load.matched_voltage, V, 3)} for "
                f"{shown(load.voltage, V, 3)} at the ceramics",
            ),
        ]
    for number, check in enumerate(load.amplifiers):
        rows.append(
            (
                "Amplifier" if number == 0 else "",
                "can" if check.suffices else "cannot",
                f"{check.kind}, such as {check.part}: {check.why} ({check.source})",
            )
        )
    return rows


@dataclass(frozen=True)
class Value:
    """A value of a display's description: its path, its text, where it is from."""

    path: str
    text: str
    source: str
    evidence: str


def display_values(display: Display) -> list[Value]:
    """Every value of a display with its unit, its source and the evidence behind it.

    Members of lists are counted from 1, as the messages of `core.config.load` count them.
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
