"""The methods section of a paper, written out from what a study did, with its citations."""

from __future__ import annotations

import math

from squeezefilm import __version__
from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.design.tasks.task import JUDGED
from squeezefilm.study.record.answers import Answers

_MATCHED = {"real gratings": "real gratings", "stimuli": "surfaces known from before"}
_ORDERS = {
    "williams": "in the order of a Williams square (Williams 1949, 10.1071/CH9490149)",
    "latin-square": "in the order of a Latin square",
    "shuffled": "in random order",
}
_UNLIKE = (
    "Surfaces had no amount in common to be compared by: each participant has a d′ over all pairs "
    "by the differencing model of Macmillan and Creelman (2005), and its mean has Student's "
    "interval over participants."
)
_PSI = "Kontsevich and Tyler 1999, 10.1016/S0042-6989(98)00285-5"
_QUEST_PLUS = "Watson 2017, 10.1167/17.3.10"


def methods_text(answers: Answers, display: int) -> str:
    """Methods section on a display's trials: participants, stimuli, task, orders, analysis.

    Written from the design and from the answers that there are: of what was not recorded nothing
    is said.
    """
    design, main = answers.design, answers.main(display)
    alike = design.task == "same-different"
    people = len(set(main.participant.tolist()))
    named = design.displays[display]
    who = "simulated participants" if "simulated" in answers.origin else "participants"
    parts = [
        f"{people} {who} took part on the display '{named}'.",
        _stimuli(design),
        design.described.presents.format(
            alternatives=len(design.answers),
            matched=_MATCHED[design.matched_with],
            reference=design.reference or "none",
            judged=JUDGED[design.judged].words,
        )
        + f" (“{design.spoken_question}”).",
        *_adaptive(design),
        _trials(design, answers, display),
        _UNLIKE
        if alike and not design.on_a_scale
        else design.described.analysed.format(judged=JUDGED[design.judged].words),
        f"Orders and analysis were made with squeezefilm {__version__} "
        f"(design SHA-256 {design.sha256[:12]}).",
    ]
    return " ".join(parts)


def _stimuli(design: StudyDesign) -> str:
    free = " They were explored freely over the face." if design.exploring == "free" else ""
    # Beside the reference of adaptive series they are for practice and familiarisation only.
    every = [
        stimulus
        for stimulus in design.stimuli
        if not design.adaptive or stimulus.name == design.reference
    ]
    simple = all(one.kind in ("square grating", "sine grating") for one in every)
    listed = []
    for stimulus in every:
        period, depth = si.format_quantity(stimulus.period, si.Unit("m")), _depth(stimulus)
        listed.append(f"{period} ({depth})" if simple else _surface(stimulus))
    shapes = " and ".join(sorted({stimulus.waveform for stimulus in every}))
    if design.adaptive:
        kind = f"a {shapes} grating of friction with the period" if simple else "the surface"
        return f"The reference was {kind} {', '.join(listed)}.{free}"
    if not simple:
        return f"Stimuli were surfaces of friction: {'; '.join(listed)}.{free}"
    return f"Stimuli were {shapes} gratings of friction with the periods {', '.join(listed)}.{free}"


def _depth(stimulus: Stimulus) -> str:
    return f"{100 * stimulus.friction_depth:.3g} % change of relative friction"


def _surface(one: Stimulus) -> str:
    """A shape, map or crossed grating by name, kind and periods."""
    lengths = [x for x in (one.period, one.second_period) if not math.isnan(x)]
    periods = " by ".join(si.format_quantity(x, si.Unit("m")) for x in lengths)
    said = [one.kind, *([periods] if lengths else []), *([] if one.texture else [_depth(one)])]
    return f"“{one.name}” ({', '.join(said)}; SHA-256 {one.surface_sha256[:12]})"


def _adaptive(design: StudyDesign) -> list[str]:
    said = []
    alike = design.task == "same-different"
    for series in design.adaptive:
        if series.method == "staircase":
            target = 100 * 0.5 ** (1 / series.down)
            how = (
                f"a staircase, {series.down} down and 1 up, that settles at {target:.1f} % correct "
                f"(Levitt 1971, 10.1121/1.1912375), from {100 * series.start:g} %"
            )
        elif series.in_runs:
            how = (
                f"{'adjustments' if series.method == 'adjustment' else 'the method of limits'}, in "
                f"runs of steps of {100 * series.step:g} %, that began alternately at either end"
            )
        else:
            by = _QUEST_PLUS if alike else _PSI
            how = f"a Bayesian choice of the most informative difference ({by})"
            how += "; every fourth went through all differences in turn" if alike else ""
        said.append(
            f"The series '{series.name}' of {series.count} trials chose the comparison by {how}, "
            f"within {100 * series.lowest:g} and {100 * series.highest:g} % of the reference"
            + ("; half of its trials presented the reference twice." if alike else ".")
        )
    if len(design.adaptive) > 1:
        said.append("The series were interleaved at random.")
    return said


def _trials(design: StudyDesign, answers: Answers, display: int) -> str:
    here = answers.take(answers.display == display)
    people = max(len(set(here.participant.tolist())), 1)
    counts = {phase: int((here.phase == phase).sum()) for phase in ("practice", "main", "catch")}
    said = f"There were {counts['main'] / people:.4g} trials a participant"
    extra = [
        f"{counts[phase] / people:.3g} {words}"
        for phase, words in (("practice", "of practice with feedback"), ("catch", "catch trials"))
        if counts[phase]
    ]
    said += f" beside {' and '.join(extra)}" if extra else ""
    order = "" if design.adaptive else f", {_ORDERS[design.order]}"
    blocks = f" in {design.blocks} blocks" if design.blocks > 1 else ""
    return f"{said}{blocks}{order}."
