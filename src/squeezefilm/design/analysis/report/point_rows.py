"""Rows of a working point that several verbs show: place, heat, sound, what a plate asks of its
amplifier; each a quantity, its value, a remark."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.config.schema import leaves
from squeezefilm.core.kit.numbers import HZ, A, Row, V, W, dotted, shown
from squeezefilm.physics.chain.active_area import CRITERIA, percent
from squeezefilm.physics.chain.pad_place import place_words
from squeezefilm.physics.display import Display

if TYPE_CHECKING:
    from squeezefilm.design.analysis.area_odds import JudgedArea
    from squeezefilm.physics.chain.prediction import Prediction
    from squeezefilm.physics.plate.electronics import ElectricalLoad

FARAD, HENRY = si.Unit("F"), si.Unit("H")


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
