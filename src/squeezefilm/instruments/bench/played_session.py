"""Judgement of what a session played, from its record; with a twin also from what really happened.

The record knows the finger by its sensor and the vibration by the pickup, or where there is none by
the envelope's model. A twin knows both for true. Each is made a rendered stroke, and judged by the
same `fidelity_report`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import table_from_csv
from squeezefilm.core.results import Result, to_json, values_of
from squeezefilm.instruments.bench.setup import PlaySetup
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.play.plan import PlayPlan
from squeezefilm.instruments.session.record.trace import Trace
from squeezefilm.physics.chain.played_texture import single_period
from squeezefilm.physics.render.fidelity.rendered_stroke import RenderedStroke
from squeezefilm.physics.render.fidelity.report import FidelityReport, fidelity_report
from squeezefilm.physics.render.program.renderer import render

_SMOOTHING: si.Second = 20e-3
_STILL = 0.15
# A pass that is shorter than this says nothing of a texture.
_SHORTEST_PASS: si.Metre = 3e-3


@dataclass(frozen=True, slots=True, eq=False)
class PlayedWay:
    """Record of a finger's way, as somebody saw it; arrays of shape (n,).

    `time` (s, the loop's clock), `x` (m), `wanted` (m, the texture's amplitude there),
    `relative_friction_wanted` and `relative_friction_rendered` (1), `amplitude` (m). `source` says
    who saw it.
    """

    time: si.SecondArray
    x: si.MetreArray
    wanted: si.MetreArray
    amplitude: si.MetreArray
    relative_friction_wanted: si.DimensionlessArray
    relative_friction_rendered: si.DimensionlessArray
    source: str


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """A way and its fidelity; None where it cannot be judged, for the reason in `unjudged`."""

    way: PlayedWay
    fidelity: FidelityReport | None
    unjudged: str | None


@dataclass(frozen=True, slots=True)
class LagSummary:
    """Distance that the finger goes between a sample and the command that rests on it (m)."""

    median: si.Metre
    p99: si.Metre


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PlayedSession(Result):
    """A session's record, judged.

    Attributes:
        setup: what was to be played.
        trace: the record.
        by_record: judged as sensor and pickup (or the envelope's model) saw it.
        by_truth: as it really was; None without a twin's truth, or where the record does not say
            how the device's clock stands to the loop's.
        position_error: RMS of the loop's estimate against the truth while it moves (m); None
            without.
        lag: of the ticks at which the finger was known; None if it never was.
        flags: how many ticks had each flag, by its meaning.
        device_events: what the device's state did.
    """

    setup: PlaySetup
    trace: Trace
    by_record: Judged
    by_truth: Judged | None
    position_error: si.Metre | None
    lag: LagSummary | None
    flags: Mapping[str, int]
    device_events: tuple[Mapping[str, Any], ...]
    _shown: ClassVar[str] = "setup.display.name setup.name position_error"

    def last(self, kind: str) -> Mapping[str, Any]:
        """The fields of the last event of a kind, such as "end", "loop" (what the loop said of
        itself) or "link" (what it counted); empty where there was none."""
        return _last(self.trace, kind)

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values, which summary.json holds; keys carry units."""
        p, plan = self.setup.prediction, self.setup.plan
        return {
            "texture": self.setup.name,
            "display": self.setup.display.name,
            "surface": p.surface.name,
            "finger": self.setup.display.whose_finger,
            **values_of(
                self,
                "setup.plan.mode setup.prediction.voltage setup.plan.frequency "
                "setup.plan.loop.rate setup.plan.loop.compensation setup.plan.loop.output_delay "
                "setup.plan.limits setup.assumed_limits setup.plan.device.sensor lag "
                "position_error flags setup.prediction.warnings",
            ),
            "tile": tile_summary(plan),
            "largest_amplitude_m": plan.loop.envelope.amplitude_limit,
            "envelope_time_constant_s": plan.loop.envelope.rise_time_constant,
            "rows": len(self.trace.rows),
            **{kind: to_json(self.last(kind)) for kind in ("end", "loop", "link", "usability")},
            "device": [dict(device_event) for device_event in self.device_events],
            "by_record": _judged_json(self.by_record),
            "by_truth": None if self.by_truth is None else _judged_json(self.by_truth),
            "damage": list(self.trace.damage.sentences),
            "provenance": dict(self.trace.metadata),
        }


def judge_session(setup: PlaySetup, trace: Trace, truth: Path | None = None) -> PlayedSession:
    """Judge a session from its record, and from a twin's truth (a CSV) where there is one.

    Raises:
        InputError: a record with other columns than a session's, or a truth that is no table.
    """
    missing = [name for name in column.COLUMNS if name not in trace.columns]
    if missing:
        raise InputError(f"the record has no {', '.join(missing)}; it is none of a session")
    rows = trace.rows
    by_record = _judge(setup, recorded_way(setup, trace))
    by_truth, error = None, None
    # How the device's clock stands to the loop's is known from the first answer on.
    offset = _last(trace, "end").get("device_clock_offset_s")
    if truth is not None and offset is not None:
        true_way = _true_way(setup, trace, truth, offset)
        by_truth = _judge(setup, true_way)
        error = _position_error(trace, true_way)
    lag = rows[:, column.LAG]
    lag = lag[np.isfinite(lag)]
    flags = rows[:, column.FLAGS].astype(np.int64)
    counted = {
        meaning: int(np.count_nonzero(flags & flag))
        for flag, meaning in column.FLAG_MEANINGS.items()
        if flag != column.NEW_SAMPLE and np.any(flags & flag)
    }
    return PlayedSession(
        setup=setup,
        trace=trace,
        by_record=by_record,
        by_truth=by_truth,
        position_error=error,
        lag=LagSummary(*(float(q) for q in np.quantile(lag, [0.5, 0.99]))) if lag.size else None,
        flags=counted,
        device_events=tuple(event.fields for event in trace.events if event.kind == "device"),
    )


def recorded_way(setup: PlaySetup, trace: Trace) -> PlayedWay:
    """Way of the finger by the record: places of the estimator, amplitude of the pickup.

    Without a pickup's amplitude in the record it is the envelope's model.
    """
    rows = trace.rows
    time, x, speed = rows[:, column.TIME], rows[:, column.X], rows[:, column.SPEED]
    known = np.isfinite(x)
    if not np.any(known):
        none = np.zeros(0)
        return _way(setup, none, none, none, none, none, "nobody: the finger was not seen")
    if np.any(np.isfinite(rows[:, column.AMPLITUDE])):
        # A reading's amplitude belongs to the moment of its stamp, not to the ticks that carry it.
        stamps = rows[:, column.ROW_SAMPLE_TIME]
        new = np.flatnonzero(np.isfinite(stamps) & (np.diff(stamps, prepend=np.nan) != 0) & known)
        when = stamps[new] + setup.plan.device.sensor.latency
        rising = np.flatnonzero(np.diff(when, prepend=-math.inf) > 0)
        when, amplitude = when[rising], rows[new[rising], column.AMPLITUDE]
        place = np.interp(when, time[known], x[known])
        pace = np.interp(when, time[known], speed[known])
        friction = setup.friction(amplitude, pace)
        source = "the loop's estimate of the finger and the pickup's amplitude"
    else:
        when, place, pace = time[known], x[known], speed[known]
        friction = rows[known, column.FRICTION]
        # The record holds friction; its amplitude is the one of the display's law at that speed.
        amplitude = np.full(friction.shape, np.nan)
        there = np.isfinite(friction) & np.isfinite(pace)
        if np.any(there):
            inverse = setup.prediction.inverse
            held = np.clip(friction[there], inverse.least_friction_at(pace[there]), 1.0)
            amplitude[there] = inverse.amplitude_for(held, pace[there])
        source = "the loop's estimate of the finger and the envelope's model (no pickup)"
    return _way(setup, when, place, pace, amplitude, friction, source)


def _true_way(setup: PlaySetup, trace: Trace, truth: Path, offset: si.Second) -> PlayedWay:
    table = table_from_csv(truth)
    time = table.column("time_s") + offset
    touching = table.column("normal_force_N") > 0.0
    inside = touching & (time >= 0.0) & (time <= _played_until(trace))
    friction = table.column("relative_friction")
    inside &= np.isfinite(friction)
    return _way(
        setup,
        time[inside],
        table.column("x_m")[inside],
        np.abs(table.column("speed_m_per_s")[inside]),
        table.column("amplitude_m")[inside],
        friction[inside],
        "what really happened in the twin",
    )


def tile_summary(plan: PlayPlan) -> Mapping[str, Any] | None:
    """Mapping of what the tile of a plan was made for; None without one."""
    return None if plan.tile is None else plan.tile.made_for.summary()


def _last(trace: Trace, kind: str) -> Mapping[str, Any]:
    return next((event.fields for event in reversed(trace.events) if event.kind == kind), {})


def _played_until(trace: Trace) -> si.Second:
    """Time at which the session began to end (s); after it nothing was to be rendered."""
    fields = _last(trace, "end")
    faded = fields.get("faded_at_s")
    last = float(trace.rows[-1, column.TIME]) if len(trace.rows) else 0.0
    return last if faded is None else min(float(faded), last)


def _way(
    setup: PlaySetup,
    time: si.SecondArray,
    x: si.MetreArray,
    speed: si.FloatArray,
    amplitude: si.MetreArray,
    friction: si.DimensionlessArray,
    source: str,
) -> PlayedWay:
    wanted = np.zeros(0)
    if time.size:
        wanted = render(setup.plan.loop.program, x, 0.0, speed, time).amplitude
    meant = setup.friction(wanted, np.asarray(speed))
    return PlayedWay(time, x, wanted, amplitude, meant, friction, source)


@dataclass(frozen=True, slots=True, repr=False)
class _Recorded:
    """A texture or a motion that is over: what a fidelity report tells of it."""

    name: str
    spatial_period: si.Metre | None = None

    def __repr__(self) -> str:
        return self.name


def _judge(setup: PlaySetup, way: PlayedWay) -> Judged:
    kept = _moving(way)
    if kept.size < 16:
        return Judged(way, None, "the finger did not move far enough along x to judge anything")
    period = single_period(setup.texture.texture)
    if period is not None and float(np.ptp(way.x)) < 5 * period:
        period = None
    time, x = way.time[kept], way.x[kept]
    start = float(time[0])
    texture: Any = _Recorded(setup.name, period)
    motion: Any = _Recorded("a finger as recorded")
    plan = setup.plan.loop
    stroke = RenderedStroke(
        texture=texture,
        trajectory=motion,
        envelope=plan.envelope,
        compensation=plan.compensation,
        control_rate=plan.rate,
        sensor=setup.plan.device.sensor,
        estimator=plan.estimator,
        seed=0,
        time=time - start,
        position=x,
        speed=np.gradient(x, time),
        estimate=None,
        wanted=way.wanted[kept],
        command=way.wanted[kept],
        amplitude=way.amplitude[kept],
        relative_friction_wanted=way.relative_friction_wanted[kept],
        relative_friction_rendered=way.relative_friction_rendered[kept],
        saturated_top=0.0,
        saturated_bottom=0.0,
        silent=float(np.mean(way.amplitude[kept] == 0.0)),
        model=f"a session, by {way.source}",
    )
    try:
        return Judged(way, fidelity_report(stroke), None)
    except InputError as error:
        return Judged(way, None, str(error))


def _moving(way: PlayedWay) -> si.FloatArray:
    """Indices of samples at which the finger goes steadily one way: strictly, pass by pass.

    A recorded place has noise; where the smoothed one turns, a pass ends.
    """
    if way.time.size < 16:
        return np.zeros(0, dtype=np.int64)
    step = float(np.median(np.diff(way.time)))
    width = max(1, round(_SMOOTHING / max(step, 1e-6)))
    kernel = np.ones(width) / width
    smooth = np.convolve(np.pad(way.x, (width, width), mode="edge"), kernel, "same")[width:-width]
    speed = np.gradient(smooth, way.time)
    pace = float(np.quantile(np.abs(speed), 0.9))
    direction = np.where(np.abs(speed) > _STILL * pace, np.sign(speed), 0.0)
    # A hole in the record ends a pass as well.
    holes = np.diff(way.time, prepend=way.time[0]) > 10 * step
    edges = np.flatnonzero((np.diff(direction, prepend=direction[0]) != 0) | holes)
    kept = []
    for part in np.split(np.arange(way.time.size), edges):
        if part.size < 8 or direction[part[0]] == 0.0:
            continue
        along = direction[part[0]] * way.x[part]
        front = np.maximum.accumulate(along)
        rising = part[np.diff(front, prepend=-math.inf) > 0]
        if abs(float(way.x[rising[-1]] - way.x[rising[0]])) >= _SHORTEST_PASS:
            kept.append(rising)
    return np.concatenate(kept) if kept else np.zeros(0, dtype=np.int64)


def _position_error(trace: Trace, truth: PlayedWay) -> si.Metre | None:
    rows = trace.rows
    known = np.isfinite(rows[:, column.X])
    if truth.time.size < 2:
        return None
    time = rows[:, column.TIME]
    inside = known & (time >= truth.time[0]) & (time <= truth.time[-1])
    if not np.any(inside):
        return None
    true = np.interp(time[inside], truth.time, truth.x)
    return float(np.sqrt(np.mean((rows[inside, column.X] - true) ** 2)))


def _judged_json(judged: Judged) -> dict[str, Any]:
    way = judged.way
    error = way.relative_friction_rendered - way.relative_friction_wanted
    finite = error[np.isfinite(error)]
    rms: si.Dimensionless = float(np.sqrt(np.mean(finite**2))) if finite.size else math.nan
    return {
        "source": way.source,
        "samples": int(way.time.size),
        "friction_rms_error": to_json(rms),
        "fidelity": to_json(judged.fidelity),
        "not_judged_because": judged.unjudged,
    }
