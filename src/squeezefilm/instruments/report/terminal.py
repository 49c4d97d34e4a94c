"""Terminal output of a device, and of a session on it, while it plays and after."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import HZ, M, S, V, decimals, printable, shown
from squeezefilm.core.kit.terminal import heading, say, show_rows, table
from squeezefilm.physics.render.fidelity.report import contrast_rows, lag_rows

if TYPE_CHECKING:
    from squeezefilm.instruments.bench.play import PlayResult
    from squeezefilm.instruments.bench.played_session import Judged, PlayedSession
    from squeezefilm.instruments.bench.timing_checks import DeviceCheck
    from squeezefilm.instruments.session.play.plan import PlayView
    from squeezefilm.instruments.session.record.trace import TraceExport

_LINE_PERIOD = 1.0
_SPEED = si.Unit("m/s")


def show_export(done: TraceExport) -> None:
    """Print what was exported, and what the trace had lost."""
    say(f"{done.to}: {done.rows} rows of {len(done.columns)} columns, {done.events} events")
    for sentence in done.damage:
        say(f"! {sentence}")


def show_check(check: DeviceCheck) -> None:
    """Print a device's checks as a table, and what to do about those that did not pass."""
    heading(f"Device on {check.drive}")
    rows = [
        (result.verdict, result.name, result.measured, result.allowed) for result in check.results
    ]
    table(
        ("", "check", "measured", "allowed"),
        rows,
        fixed=(0,),
        styles=lambda row: {"pass": "green", "doubt": "yellow"}.get(str(row[0]), "bold red"),
    )
    for result in check.results:
        if not result.passed:
            say(f"! {result.name}: {result.doubt or result.advice}")
    count, verdicts = len(check.results), [result.verdict for result in check.results]
    doubts = verdicts.count("doubt")
    told = f", {doubts} in doubt" if doubts else ""
    say(f"{verdicts.count('pass')} of {count} checks passed{told}")


def line_a_second() -> Callable[[PlayView], None]:
    """Function that is shown a session while it plays, and tells it by a line a second.

    On standard error, so that what a program reads stays clean.
    """
    told = -math.inf

    def line(view: PlayView) -> None:
        nonlocal told
        if view.time - told >= _LINE_PERIOD:
            told = view.time
            print(f"  {view_line(view)}", file=sys.stderr, flush=True)

    return line


def view_line(view: PlayView) -> str:
    """A moment of a session in one line."""
    parts = [
        f"{view.time:7.2f} s",
        view.state.name.lower() + (f" ({view.fault.name.lower()})" if view.fault else ""),
        f"x {decimals(1e3 * view.x, 2):>7} mm",
        f"µ′/µ {decimals(view.relative_friction, 3)}",
        f"amplitude {decimals(1e6 * view.amplitude, 2)} µm",
        f"lag {decimals(1e3 * view.lag, 3)} mm",
        f"late {decimals(1e6 * view.lateness, 0)} µs",
        *(() if view.held is None else (view.held.words,)),
        *view.flags,
    ]
    return ", ".join(parts)


def show_play(result: PlayResult) -> None:
    """Print a session: how it ended, what was rendered, how late, how far behind."""
    setup = result.session.setup
    title = f"{setup.name} on {setup.display.title} [{setup.display.name}]"
    show_rows(title, play_rows(result), play_warnings(result.session), fixed=(0, 1))


def play_rows(result: PlayResult) -> list[tuple[str, str, str]]:
    """The lines of the table: quantity, value, remark."""
    session, outcome = result.session, result.outcome
    plan = session.setup.plan
    ended = outcome.ending.value
    volts = plan.loop.voltage_limit
    rows = [
        ("Ended", ended, outcome.message),
        ("Usable", "yes" if outcome.usable else "NO", _usable_because(result)),
        (
            "Played",
            shown(_duration(session), S, 3),
            f"mode {plan.mode}, {shown(plan.loop.rate, HZ, 3)}, compensation "
            f"{plan.loop.compensation}, up to {shown(volts, V, 3)} at {shown(plan.frequency, HZ)}",
        ),
    ]
    rows.append(("Finger", "", session.setup.display.whose_finger))
    if plan.tile is not None:
        rows.append(("Tile", f"{plan.tile.amplitude.size} places", plan.tile.made_for.sentence()))
    rows += _judged_rows("Record", session.by_record)
    if session.by_truth is not None:
        rows += _judged_rows("Truth", session.by_truth)
    if session.position_error is not None:
        rows.append(
            ("Position error", shown(session.position_error, M, 3), "of the estimate, RMS, truth")
        )
    if session.lag is not None:
        far = f"from newest sample to its command at the plate; {1e3 * session.lag.p99:.2f} mm"
        rows.append(("Way predicted", f"{1e3 * session.lag.median:.2f} mm", f"{far} at 99 %"))
    rows += _loop_rows(session.last("loop")) + _link_rows(session)
    return rows


def _usable_because(result: PlayResult) -> str:
    """The numbers that say whether a session can be used, or why it cannot."""
    usability = result.outcome.usability
    if usability is None or result.outcome.failed:
        return ""
    return usability.sentence or (
        f"{100 * usability.share_made:.1f} % of {usability.ticks} ticks made, longest gap "
        f"{shown(usability.longest_gap, S, 3)}, {100 * usability.share_late:.1f} % too late"
    )


def _duration(session: PlayedSession) -> float:
    rows = session.trace.rows
    return float(rows[-1, 1] - rows[0, 1]) if len(rows) else 0.0


def _judged_rows(who: str, judged: Judged) -> list[tuple[str, str, str]]:
    fidelity = judged.fidelity
    if fidelity is None:
        return [(f"{who}: contrast, lag", "–", judged.unjudged or "")]
    rows = contrast_rows(fidelity, f"{who}: contrast at")
    said = f"RMS of µ′/µ, swing wanted {fidelity.wanted_swing:.2f}; by {judged.way.source}"
    rows.append((f"{who}: friction error", f"{fidelity.rms_error:.3f}", said))
    return rows + lag_rows(fidelity, f"{who}: lag")


def _loop_rows(loop: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    late = loop.get("lateness")
    if not late:
        return [("Loop", "–", "it could not say how late it was")]
    due = late["made"] + late["lost"]
    rows = [
        (
            "Ticks lost",
            f"{100 * late['lost'] / max(due, 1):.3f} %",
            f"{late['lost']} of {due}; late {shown(late['p50_s'], S, 3)} median, "
            f"{shown(late['p99_s'], S, 3)} at 99 %, {shown(late['p99_9_s'], S, 3)} at 99.9 %, "
            f"{shown(late['longest_s'], S, 3)} at most",
        )
    ]
    if "real_time_priority" in loop:
        granted = "with" if loop["real_time_priority"] else "WITHOUT"
        rows.append(
            (
                "Loop process",
                f"{100 * loop['processor_share']:.0f} %",
                f"of a processor, {granted} real-time priority; {loop['dropped_commands']} "
                f"commands and {loop['dropped_rows']} rows dropped, {loop['stale_commands']} stale",
            )
        )
    return rows


def _link_rows(session: PlayedSession) -> list[tuple[str, str, str]]:
    link, end = session.last("link"), session.last("end")
    rows = []
    if link:
        rows.append(
            (
                "Link",
                f"{link.get('lost', 0)} lost",
                f"of {link.get('sent', 0)} frames; {link.get('damaged', 0)} damaged, "
                f"{link.get('refused', 0)} refused; round trip "
                f"{shown(link.get('mean_round_trip_s'), S, 3)} on average, "
                f"{shown(link.get('longest_round_trip_s'), S, 3)} at most",
            )
        )
    if end:
        rows.append(
            (
                "Device",
                f"{end.get('readings', 0)} readings",
                f"{end.get('late_commands', 0)} commands too late to send, "
                f"{end.get('device_late_ticks', 0)} late ticks of its own",
            )
        )
    return rows


def play_warnings(session: PlayedSession) -> list[str]:
    """Sentences on what is doubtful of a session, one each."""
    said = []
    if session.setup.assumed_limits:
        said.append(
            "the display's drive does not give "
            + ", ".join(session.setup.assumed_limits)
            + "; the device was given assumed limits"
        )
    for meaning, count in session.flags.items():
        said.append(f"{count} ticks: {meaning}")
    for event in session.device_events:
        if event.get("fault") not in (None, "none"):
            said.append(f"the device faulted at {event.get('time_s', 0.0):.3f} s: {event['fault']}")
    said += list(session.trace.damage.sentences)
    said += list(session.setup.prediction.warnings)
    return [printable(text) for text in said]
