"""What a plate asks of its amplifier, as rows: quantity, value, remark."""

from __future__ import annotations

from squeezefilm import quantities as si
from squeezefilm.plate.electronics import ElectricalLoad
from squeezefilm.report.kit.numbers import HZ, V, shown

A, FARAD, HENRY, WATT = si.Unit("A"), si.Unit("F"), si.Unit("H"), si.Unit("W")


def electronics_rows(load: ElectricalLoad | None) -> list[tuple[str, str, str]]:
    """Current, power, slew, inductors, and which class of amplifier can do it."""
    if load is None:
        return [
            ("Electrical load", "not known", "it takes a voltage, and an admittance solved near it")
        ]
    at = f"at {shown(load.voltage, V)} and {shown(load.frequency, HZ)}, without a finger"
    each = f"{load.channels} ceramics in parallel, {{}} each on average"
    rows = [("Electrical load", "assumed in part", load.assumed)] if load.assumed else []
    if load.capacitance is not None and load.capacitance_per_channel is not None:
        one = shown(load.capacitance_per_channel, FARAD, 3)
        together = each.format(one) if load.channels > 1 else "beside the mode"
        rows.append(("Electrode capacitance", shown(load.capacitance, FARAD, 3), together))
    split = f"; {each.format(shown(load.current_per_channel, A, 3))}" if load.channels > 1 else ""
    rows += [
        ("Drive current, peak", shown(load.current, A, 3), at + split),
        (
            "Drive power",
            shown(load.real_power, WATT, 3),
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
