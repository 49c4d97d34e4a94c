"""Predictions that are written before the data are opened, and scored after.

A prediction's file ends with the SHA-256 of its own content. A change after the data are known is
seen, whoever makes it, where that number was shown to others before.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import DESCRIPTION_BYTES
from squeezefilm.core.progress import SayProgress, ShareProgress
from squeezefilm.core.regular_file import read_json, read_regular_text
from squeezefilm.core.results import stamp, to_json, write_whole
from squeezefilm.measure.calibration.discrepancy import (
    BELIEVED,
    GRID,
    KINDS,
    Touching,
    scales_of,
    touching,
)
from squeezefilm.measure.calibration.friction_posterior import finger_mixture, friction_of_points
from squeezefilm.measure.calibration.plate_fit import prior_scores
from squeezefilm.measure.calibration.priors import (
    NormalScores,
    calibration_parameters,
    with_calibrated,
)
from squeezefilm.measure.calibration.solved_answers import (
    DRAW_TAKES,
    FRICTION,
    PLATE_TAKES,
    asked_by,
    in_parts,
    question,
    solved_answers,
)
from squeezefilm.measure.calibration.written_display import actuator_digest
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, NamedDisplay
from squeezefilm.physics.uncertainty.intervals import LEVEL
from squeezefilm.physics.uncertainty.uncertainty import sobol_points

KIND = "squeezefilm blind prediction"
_SOLVED, _FRICTION = 32, 256
_TAILS = ((1 - LEVEL) / 2, 0.5, (1 + LEVEL) / 2)


@si.checked_numbers
@dataclass(frozen=True)
class Predicted:
    """A predicted number: `answer` and `conditions` as an `Observation` has them (SI), median,
    interval at `level`, and the standard deviation of its draws."""

    answer: str
    conditions: dict[str, float]
    median: float
    interval: tuple[float, float]
    standard_deviation: float
    level: si.Dimensionless = LEVEL


@dataclass(frozen=True)
class BlindPrediction:
    """A prediction as its file has it: of which display, how it was made, and its SHA-256."""

    display: str
    how: str
    predictions: tuple[Predicted, ...]
    stamp: dict[str, Any]
    sha256: str


@dataclass(frozen=True)
class Score:
    """A predicted number beside the measured one.

    `error` is predicted median less measured, relative to the measured value (absolute for µ′/µ);
    `inside` whether the interval holds the measured value; `log_score` the logarithm of the
    predicted density there, as a normal one with the measurement's own error (higher is better).
    """

    predicted: Predicted
    observation: Observation
    error: si.Dimensionless
    inside: bool
    log_score: float

    @property
    def sentence(self) -> str:
        """Sentence about it."""
        low, high = self.predicted.interval
        absolute = self.observation.answer == FRICTION
        error = f"{self.error:+.3f}" if absolute else f"{100 * self.error:+.2g} %"
        where = "inside" if self.inside else "outside of"
        return (
            f"{self.observation.answer.replace('_', ' ')}: predicted {self.predicted.median:.5g} "
            f"({low:.5g} to {high:.5g}), measured {self.observation.value:.5g} (SI): "
            f"error {error}, {where} the {si.percent(self.predicted.level)} interval, log score "
            f"{self.log_score:.2f}"
        )


@reads_text
def predict_measurement(
    display: NamedDisplay,
    ask: str | Sequence[str],
    out: str | Path,
    *,
    seed: int = 1,
    progress: SayProgress | None = None,
) -> BlindPrediction:
    """Write what will be measured of a display, with its interval and a SHA-256, before it is.

    `ask` names answers and their conditions as `question` reads them, such as
    "resonance_frequency" or "relative_friction: vibration_amplitude=1.7 um". `out` is a JSON file
    in SI units that is never overwritten; `score_prediction` compares it with recordings later.
    A calibrated display answers from its calibration's draws, in a second, what these hold; else
    plates are drawn from the display's own spreads and solved: a minute or so. Either has what a
    model is believed to be off by.

    Raises `InputError` for a question that cannot be read or answered, where nothing is asked, and
    for a file that is there already.
    """
    asked = [question(text) for text in ([ask] if isinstance(ask, str) else ask)]
    target = Path(out)
    if target.exists():
        raise InputError(
            f"{target} is there already; a prediction is never overwritten, name another"
        )
    write_whole(target, sealed(predicted(display, asked, seed=seed, progress=progress)))
    return load_prediction(target)


def predicted(
    display: Display,
    what: Sequence[Observation],
    *,
    seed: int = 1,
    progress: SayProgress | None = None,
) -> BlindPrediction:
    """Predict what will be measured, not yet sealed: its SHA-256 is empty. `what` names answers and
    conditions; the values in them are ignored.

    Raises `InputError` where nothing is asked or an answer is not known.
    """
    if not what:
        raise InputError("nothing is to be predicted; name at least one answer")
    for seen in what:
        _ = _touched(seen) if seen.answer == FRICTION else asked_by(seen)
    how = f"plates drawn from the spreads in the description of {display.name}"
    of_friction = [seen for seen in what if seen.answer == FRICTION]
    known = _of_record(display, what)
    drawn = [seen for seen in what if seen.answer != FRICTION and id(seen) not in known]
    if known and not drawn:
        how = f"the calibration in the description of {display.name}"
    solved = _SOLVED * PLATE_TAKES if drawn else 0.0
    seconds = _FRICTION * DRAW_TAKES if of_friction else 0.0, solved
    steps = in_parts(progress, seconds)
    rows = known | _of_friction(display, of_friction, seed, next(steps))
    rows |= _of_plate(display, drawn, seed, next(steps))
    predictions = tuple(_predicted(seen, rows[id(seen)]) for seen in what)
    return BlindPrediction(display.name, how, predictions, stamp(display, seed), "")


def sealed(prediction: BlindPrediction) -> str:
    """The text of a prediction's file, which ends with the SHA-256 of its own content."""
    content = {"kind": KIND, **to_json(prediction)}
    content["sha256"] = _digest(content)
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _predicted(seen: Observation, draws: si.FloatArray) -> Predicted:
    known = draws[np.isfinite(draws)]
    if known.size < 0.5 * draws.size:
        raise InputError(
            f"{seen.answer.replace('_', ' ')} has no value in most draws; ask for another condition"
        )
    low, middle, high = (float(value) for value in np.quantile(known, _TAILS))
    return Predicted(seen.answer, dict(seen.conditions), middle, (low, high), float(np.std(known)))


def _of_record(display: Display, what: Sequence[Observation]) -> dict[int, si.FloatArray]:
    """The answers that a calibrated display's file keeps, unless its actuator was changed since."""
    record = display.calibration
    if record is None or record.actuator != actuator_digest(display):
        return {}
    kept = {answer.said: np.array(answer.draws) for answer in record.answers}
    asked = {id(seen): asked_by(seen).said for seen in what if seen.answer != FRICTION}
    return {key: kept[said] for key, said in asked.items() if said in kept}


def _of_plate(
    display: Display, wanted: Sequence[Observation], seed: int, tell: ShareProgress
) -> dict[int, si.FloatArray]:
    """Answers of plates drawn from the display's spreads, with what a model may be off by."""
    if not wanted:
        return {}
    asked = tuple(dict.fromkeys(asked_by(one) for one in wanted))
    scores = NormalScores(calibration_parameters(display))
    drawn = []
    for number, values in enumerate(
        scores.by_path(prior_scores(len(scores.parameters), _SOLVED, seed))
    ):
        tell(f"plate {number + 1} of {_SOLVED}", number / _SOLVED)
        drawn.append(solved_answers(with_calibrated(display, values).actuator, asked).values)
    random = np.random.default_rng(seed)
    # Many errors of the model for each solved plate: these are cheap.
    many = np.repeat(np.array(drawn), 32, axis=0)
    # One kind at a time is asked: which of the scales does not matter.
    off = scales_of(random.normal(size=(len(many), len(KINDS))))[:, 0]
    answers = {}
    for prediction in wanted:
        column = many[:, asked.index(asked_by(prediction))]
        error = off * BELIEVED[prediction.answer] * random.normal(size=len(many))
        answers[id(prediction)] = column * np.exp(error)
    return answers


def _touched(seen: Observation) -> Touching:
    """The conditions of a friction that is asked for."""
    return touching(Observation(FRICTION, 0.5, 1.0, seen.conditions))


def _of_friction(
    display: Display, wanted: Sequence[Observation], seed: int, tell: ShareProgress
) -> dict[int, si.FloatArray]:
    """µ′/µ of draws of finger and laws, with the laws' error: what a calibration found of it, or
    what is believed of laws nobody compared with anything."""
    if not wanted:
        return {}
    mixture = finger_mixture(display, predict(display))
    where = tuple(_touched(seen) for seen in wanted)
    curves = friction_of_points(mixture, sobol_points(mixture, _FRICTION, seed), where, tell)
    random, joint = np.random.default_rng(seed), display.joint
    if joint is not None and joint.friction_offset_deviation > 0:
        middle, spread = joint.friction_offset, joint.friction_offset_deviation
        off = random.normal(middle, spread, len(curves))
    else:
        scale = random.choice(GRID, len(curves))
        off = scale * BELIEVED[FRICTION] * random.normal(size=len(curves))
    curves = np.clip(curves + off[:, None], 0.0, 1.2)
    return {id(seen): curves[:, k] for k, seen in enumerate(wanted)}


def _digest(content: dict[str, Any]) -> str:
    rest = {key: value for key, value in content.items() if key != "sha256"}
    text = json.dumps(rest, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def load_prediction(path: str | Path) -> BlindPrediction:
    """The prediction in a file of `predict_measurement`.

    Raises `InputError` for a file that is none, or whose content is not what its SHA-256 says.
    """
    content = read_json(path, DESCRIPTION_BYTES, "a prediction")
    try:
        if content["kind"] != KIND:
            raise ValueError
        rows = content["predictions"]
        predictions = tuple(Predicted(**row | {"interval": tuple(row["interval"])}) for row in rows)
        told = {key: value for key, value in content.items() if key != "kind"}
        prediction = BlindPrediction(**told | {"predictions": predictions})
    except (InputError, ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"{path} is no prediction of squeezefilm; write one with measure predict"
        ) from error
    if _digest(content) != prediction.sha256:
        raise InputError(
            f"{path} was changed after it was written: its content's SHA-256 is "
            f"{_digest(content)[:16]}…, the file says {prediction.sha256[:16]}…. It is not scored; "
            "a prediction counts as it was made"
        )
    return prediction


def score(path: str | Path, observations: Sequence[Observation]) -> tuple[Score, ...]:
    """Compare a prediction's file with what was measured; both the file's numbers and the data stay
    as they are.

    Conditions must be those that were predicted, within 1 %. Raises `InputError` as
    `load_prediction`, or where no observation is of anything that was predicted.
    """
    prediction = load_prediction(path)
    scores = []
    for foretold in prediction.predictions:
        for seen in observations:
            if seen.answer == foretold.answer and all(
                math.isclose(value, seen.conditions.get(key, math.nan), rel_tol=0.01)
                for key, value in foretold.conditions.items()
            ):
                scores.append(_scored(foretold, seen))
    if not scores:
        predicted = ", ".join(foretold.answer for foretold in prediction.predictions)
        measured = ", ".join(foretold.answer for foretold in observations) or "nothing"
        raise InputError(
            f"nothing that was measured ({measured}) is what was predicted ({predicted}, under its "
            "conditions); give the recording that the prediction was made for"
        )
    return tuple(scores)


def _scored(predicted: Predicted, seen: Observation) -> Score:
    spread = math.hypot(predicted.standard_deviation, seen.standard_error)
    off = (seen.value - predicted.median) / spread
    absolute = seen.answer == FRICTION
    return Score(
        predicted,
        seen,
        (predicted.median - seen.value) / (1.0 if absolute else seen.value),
        predicted.interval[0] <= seen.value <= predicted.interval[1],
        -(off**2) / 2 - math.log(spread * math.sqrt(2 * math.pi)),
    )


def keep_scores(display: str | Path, prediction: str | Path, scores: Sequence[Score]) -> None:
    """Add a prediction and its scores to a display's TOML file, as comments at its end.

    Raises `InputError` for a file that cannot be read or written.
    """
    target = Path(display)
    known = load_prediction(prediction)
    lines = [f"# blind prediction {Path(prediction).name}, SHA-256 {known.sha256}, {known.how}:"]
    lines += [f"#   {scored.sentence}" for scored in scores]
    text = read_regular_text(target, DESCRIPTION_BYTES, "display")
    write_whole(target, text.rstrip("\n") + "\n\n" + "\n".join(lines) + "\n")
