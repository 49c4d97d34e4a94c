"""Results of `squeezefilm friction`: the friction of a display, how sure it is, and its maps."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.progress import Pace, SayProgress, said_with_time_left
from squeezefilm.core.results import Result, stamp
from squeezefilm.design.analysis.area_odds import JudgedArea, judged_area
from squeezefilm.design.analysis.curves import ModelCurve, model_curves
from squeezefilm.design.analysis.published_claims import missed_by
from squeezefilm.design.analysis.verdict import (
    Finding,
    as_json,
    friction_verdict,
    held_back,
    why_not_good,
)
from squeezefilm.design.analysis.wanted import Wanted, wanted_friction
from squeezefilm.physics.chain.friction import where_known
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.chain.wanted_voltage import WantedFriction, WorkingPoint
from squeezefilm.physics.contact.sharing.pad import FrictionRipple
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.intervals import require_samples
from squeezefilm.physics.uncertainty.uncertainty import (
    SAMPLES,
    UncertainFriction,
    interval_or_reason,
)


@dataclass(frozen=True, eq=False)
class FrictionMap:
    """µ′/µ over vibration amplitude (columns) and normal force (rows), shape (forces, amplitudes).

    NaN where the asperities are pressed through.
    """

    amplitude: si.MetreArray
    normal_force: si.NewtonArray
    relative_friction: si.DimensionlessArray
    model: str


@dataclass(frozen=True, eq=False, repr=False)
class FrictionAnalysis(Result):
    """The friction at a working point: models side by side, uncertainty, map and ripple.

    `ripple` is what the pad feels of the standing wave itself as it moves along it. `verdict` says
    how probable the paper's criterion is, or why there is no interval; `apart`, where it was asked
    for, which experiment would tell the laws apart.
    """

    display: Display
    prediction: Prediction
    curves: tuple[ModelCurve, ...]
    uncertainty: UncertainFriction | None
    map: FrictionMap
    ripple: FrictionRipple | None
    wanted: Wanted | None
    verdict: tuple[Finding, ...]
    active_area: JudgedArea | None = None
    _shown: ClassVar[str] = (
        "display.name prediction.model prediction.voltage prediction.vibration_amplitude "
        "prediction.relative_friction uncertainty.interval wanted.voltage"
    )

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values; keys carry units."""
        p = self.prediction
        lifted = p.law.kind.friction == "lift"
        sharing = None if lifted else p.touch.sharing
        unsure = self.uncertainty
        return {
            **p.summary(),
            "ambient_pressure_Pa": self.display.gas.ambient_pressure,
            "free_amplitude_m": p.touch.free_amplitude,
            "amplitude_kept": p.touch.kept,
            "active_area": None if self.active_area is None else self.active_area.summary(),
            "relative_friction_interval": None if unsure is None else list(unsure.interval),
            "interval_level": None if unsure is None else unsure.level,
            "relative_friction_limits": None
            if p.relative_friction_limits is None
            else {
                "each_ridge_at_its_own_balance": p.relative_friction_limits[0],
                "all_ridges_at_one_mean_gap": p.relative_friction_limits[1],
            },
            "load_shares": {"film": 1 - p.relative_friction, "asperities": p.relative_friction}
            if lifted
            else None
            if sharing is None
            else {
                "film": float(sharing.film_share[0]),
                "asperities": 1 - float(sharing.film_share[0]),
                "mean_gap_m": float(sharing.mean_gap[0]),
                "residual": sharing.residual,
                "relative_friction_error": float(sharing.relative_friction_error[0]),
            },
            "standing_wave_ripple": None if self.ripple is None else self.ripple.ripple,
            "wanted": None if self.wanted is None else self.wanted.summary(),
            "models": [
                {
                    "model": curve.model,
                    "relative_friction": curve.at(p.vibration_amplitude),
                }
                for curve in self.curves
            ],
            "measurements_missed": _missed(p.model),
            "uncertainty": None if unsure is None else unsure.summary(),
            "verdict": as_json(self.verdict),
            "provenance": stamp(self.display),
        }


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class FrictionRequest(WorkingPoint):
    """Arguments of `analyze_friction`."""

    position: si.Metre | None = None
    ambient_pressure: si.Pascal | None = None
    wanted_friction: WantedFriction | None = None
    samples: int = SAMPLES
    seed: int = 1
    points: int = 40
    progress: SayProgress | None = None


@reads_text
@called_with(FrictionRequest)
def analyze_friction(asked: FrictionRequest) -> FrictionAnalysis:
    """The friction of a display at a working point, with everything around it.

    Arguments as `prediction.predict`; `ambient_pressure` (Pa) puts display and finger into another
    atmosphere, `speed` (m/s) is the finger's for the competing mechanism, `wanted_friction` asks
    for the voltage that reaches it, `samples` (0: none) is the base of the uncertainty's design,
    `points` is the side of the map.
    Raises what `predict` and `voltage_for_friction` raise, and `InputError` for `samples` that are
    no power of two.
    """
    tell, display = asked.progress or (lambda _: None), asked.display
    if asked.samples:
        require_samples(asked.samples)
    if asked.ambient_pressure is not None:
        gas = display.gas.at_pressure(asked.ambient_pressure)
        display = dataclasses.replace(display, gas=gas)
    tell("amplitude and load balance")
    pace = Pace(tell=said_with_time_left(tell))
    point = asked.point() | {"display": display}
    prediction = predict(**point, position=asked.position, pace=pace)
    wanted = (
        None
        if asked.wanted_friction is None
        else wanted_friction(
            display,
            prediction,
            asked.wanted_friction,
            samples=asked.samples,
            seed=asked.seed,
            progress=asked.progress,
        )
    )
    tell("models side by side")
    curves = model_curves(prediction)
    tell("map over amplitude and force")
    maps = friction_map(prediction, asked.points)
    unsure, why_not = interval_or_reason(
        display, prediction, samples=asked.samples, seed=asked.seed, progress=asked.progress
    )
    why = why_not_good(display, prediction)
    tell("ripple of the standing wave, and the active area")
    area = judged_area(display, prediction, samples=asked.samples, seed=asked.seed)
    return FrictionAnalysis(
        display,
        prediction,
        curves,
        unsure,
        maps,
        _ripple(prediction),
        wanted,
        tuple(
            held_back(finding, why)
            for finding in friction_verdict(prediction, unsure, why_not, area)
        ),
        area,
    )


def _missed(model: str) -> list[dict[str, str]] | None:
    """The measured directions that the model misses; None where they were not asked of it."""
    directions = missed_by(model)
    if directions is None:
        return None
    return [{"says": item.says, "where": item.where, "why": item.why} for item in directions]


def friction_map(prediction: Prediction, points: int = 40) -> FrictionMap:
    """µ′/µ over amplitudes up to twice the working one (3 µm at the least) and over forces.

    Forces from a tenth of the working one to four times it, spaced evenly in their logarithm.
    """
    p = prediction
    amplitude = np.linspace(0, max(3e-6, 2 * p.vibration_amplitude), points)
    force = np.geomspace(0.1 * p.normal_force, 4 * p.normal_force, points)
    law = p.law if p.law.kind.shares_load else p.law.by(DEFAULT_MODEL)
    rows = np.empty((points, points))
    for number, newtons in enumerate(force):
        at = dataclasses.replace(law, normal_force=float(newtons))
        rows[number] = where_known(at.curve, amplitude)
    return FrictionMap(amplitude, force, rows, law.model)


def _ripple(p: Prediction) -> FrictionRipple | None:
    # The paper's models know the finger over an antinode only.
    if p.touch.law is None or p.place_was_asked or not p.law.kind.shares_load:
        return None
    return p.law.ripple(p.vibration_amplitude)
