"""`analyze`: everything about one display at one working point."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, get_args

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.progress import Deadline, Pace, SayProgress, said_with_time_left
from squeezefilm.design.analysis.analysis import Analysis
from squeezefilm.design.analysis.area_odds import judged_area
from squeezefilm.design.analysis.curves import friction_curve
from squeezefilm.design.analysis.felt import what_survives
from squeezefilm.design.analysis.report.page import in_short
from squeezefilm.design.analysis.sensitivities import Effort
from squeezefilm.design.analysis.verdict import verdict
from squeezefilm.design.analysis.wanted import wanted_friction
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.chain.wanted_voltage import WantedFriction, WorkingPoint
from squeezefilm.physics.plate.working_mode import PlateTheory
from squeezefilm.physics.render.resonator.envelope import envelope_bandwidth
from squeezefilm.physics.uncertainty.intervals import require_samples
from squeezefilm.physics.uncertainty.uncertainty import (
    SAMPLES,
    interval_or_reason,
)

# What the interval takes (s), measured on the presets; a budget without room for it leaves it out.
_INTERVAL = 6.0


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class AnalysisRequest(WorkingPoint):
    """Arguments of `analyze`."""

    theory: PlateTheory | None = None
    strict: bool = False
    samples: int = SAMPLES
    wanted_friction: WantedFriction | None = None
    sensitivities: Effort | None = None
    whole: bool = False
    progress: SayProgress | None = None
    budget: Annotated[si.Second, si.Above(0.0)] | None = None


@reads_text
@called_with(AnalysisRequest)
def analyze(asked: AnalysisRequest) -> Analysis:
    """The whole analysis of a display at one working point.

    Arguments and errors are those of `prediction.predict`; `samples` (0: none) is the base of the
    uncertainty's design, see `uncertain_friction`; `wanted_friction` asks for the voltage that
    reaches it, `sensitivities` what each value does, and how a plate with one thing different is
    computed for that, see `display_sensitivities`; `whole` puts that and other theories of the
    plate into summary and report; `progress` is told each step. With a `budget` (s) half of it
    bounds the plate's solve, and the interval is left out where nothing is left for it: what is
    missing is said.
    """
    budget = asked.budget
    if asked.sensitivities is not None:
        si.require_one_of("sensitivities", asked.sensitivities, get_args(Effort))
    if asked.samples:
        require_samples(asked.samples)
    tell = asked.progress or (lambda _: None)
    deadline = Pace(budget).deadline()
    tell("resonance, amplitude and friction")
    pace = Pace(None if budget is None else budget / 2, said_with_time_left(tell))
    prediction = predict(**asked.point(), theory=asked.theory, strict=asked.strict, pace=pace)
    analysis = _what_follows(asked, prediction, tell, deadline)
    if asked.wanted_friction is None:
        return analysis
    tell("the voltage for the friction wanted")
    wanted = wanted_friction(
        asked.display,
        prediction,
        asked.wanted_friction,
        samples=asked.samples,
        strict=False,
        progress=tell,
    )
    return dataclasses.replace(analysis, wanted=wanted)


def _what_follows(
    asked: AnalysisRequest, prediction: Prediction, tell: SayProgress, deadline: Deadline | None
) -> Analysis:
    """Analysis of a prediction; what a deadline leaves no room for is left out."""
    display, samples, mode = asked.display, asked.samples, prediction.mode
    tau = prediction.envelope_time_constant
    tell("friction against amplitude")
    own = friction_curve(prediction, prediction.surface, prediction.model)
    tell("how sure the friction is")
    if deadline is None or deadline.allows(_INTERVAL):
        unsure, why_not = interval_or_reason(display, prediction, samples=samples)
    else:
        unsure, why_not = None, "the budget left no time for its interval"
    # After the interval, of whose draws its odds are.
    tell("friction over the active area")
    area = judged_area(display, prediction, samples=0 if unsure is None else samples)
    tell("verdict")
    table = what_survives(prediction, tau)
    return Analysis(
        display=display,
        prediction=prediction,
        active_area=area,
        envelope_time_constant=tau,
        envelope_bandwidth=float(envelope_bandwidth(mode.quality_factor, mode.resonance_frequency)),
        own_curve=own,
        uncertainty=unsure,
        fidelity=table,
        verdict=tuple(verdict(display, prediction, area, own, table, unsure, why_not)),
        effort=asked.sensitivities,
        whole=asked.whole,
        notebook=in_short,
    )
