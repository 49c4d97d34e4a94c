"""What is asked of a blind prediction, read from text."""

from __future__ import annotations

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.measure.calibration.solved_answers import LINES
from squeezefilm.measure.fits.estimate import Observation

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
