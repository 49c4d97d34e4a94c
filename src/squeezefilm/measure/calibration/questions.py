"""What is asked of a blind prediction, read from text, and the prediction itself."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.from_text import reads_text
from squeezefilm.core.progress import SayProgress
from squeezefilm.measure.calibration.blind import BlindPrediction, predict_blind
from squeezefilm.measure.calibration.solved_answers import LINES
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.display import NamedDisplay

CONDITIONS: dict[str, si.Unit] = {
    "vibration_amplitude": si.Unit("m"),
    "normal_force": si.Unit("N"),
    "finger_speed": si.Unit("m/s"),
    LINES[0]: si.Unit("1"),
    LINES[1]: si.Unit("1"),
}
"""What may be said of the conditions, and in which unit."""


def question(text: str) -> Observation:
    """An answer with its conditions, such as ``"relative_friction: vibration_amplitude=1.7 um"``;
    conditions are parted by commas. The value is left at 0.

    Raises `InputError` for a condition that is not known or has no number with its unit.
    """
    answer, _, rest = text.partition(":")
    conditions: dict[str, float] = {}
    for part in filter(None, (one.strip() for one in rest.split(","))):
        name, equals, value = (one.strip() for one in part.partition("="))
        if name not in CONDITIONS or not equals:
            raise InputError(
                f"'{part}' is no condition of {answer.strip()}."
                f'{si.did_you_mean(name, tuple(CONDITIONS))} Write them as in "relative_friction: '
                f'vibration_amplitude=1.7 um, normal_force=0.5 N"; known are '
                f"{', '.join(CONDITIONS)}",
                quantity="ask",
            )
        conditions[name] = si.parse_quantity(value, CONDITIONS[name])
    return Observation(answer.strip(), 0.0, 0.0, conditions)


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
    Plates are drawn from the display's own spreads (a calibrated display: the posterior's) and
    solved: a minute or so. See `measure.calibration.blind.predict_blind`.

    Raises `InputError` for a question that cannot be read or answered, where nothing is asked, and
    for a file that is there already.
    """
    asked = [question(one) for one in ([ask] if isinstance(ask, str) else ask)]
    return predict_blind(display, asked, out, seed=seed, progress=progress)
