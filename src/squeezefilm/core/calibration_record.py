"""What a calibrated display's file keeps of its calibration: when, on what, and how it went.

It is for people, and for the lab: nothing is computed from it. What is computed with stands in the
values' own spreads and in `core.joint_spread.JointSpread`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

_Ends = tuple[Annotated[si.Dimensionless, si.AtLeast(0)], ...]


@si.checked_numbers
@dataclass(frozen=True)
class UsedRecording:
    """A recording that a calibration learned from: its file's name and SHA-256, its kind, who took
    it when with what, and where it is from (one that was made up says so).

    An empty text is not told.
    """

    file: str
    kind: str = ""
    who: str = ""
    when: str = ""
    instrument: str = ""
    origin: str = ""
    sha256: str = ""


@si.checked_numbers
@dataclass(frozen=True)
class ComparedAnswer:
    """One number that was measured beside what the model alone says of it, before and after.

    `said` names the number in words, `measured` is it with its unit, `error` its standard error as
    a share of it. `before` and `after` are the model's low end, median and high end (90 %), each
    divided by what was measured; empty where the model has none. They are without what the model is
    believed to be off by, so that a model that does not fit is seen. A friction has its conditions.

    Raises `InputError` for ends that are not three in rising order.
    """

    said: str
    measured: str
    error: Annotated[si.Dimensionless, si.AtLeast(0)]
    before: _Ends = ()
    after: _Ends = ()
    recording: str = ""
    relative_friction: Annotated[si.Dimensionless, si.AtLeast(0)] | None = None
    vibration_amplitude: Annotated[si.Metre, si.AtLeast(0)] | None = None

    def __post_init__(self) -> None:
        for name in ("before", "after"):
            ends = getattr(self, name)
            if ends and (len(ends) != 3 or list(ends) != sorted(ends)):
                raise InputError(
                    f"{name} = {list(ends)} is no interval; give its low end, median and high end "
                    "as shares of what was measured, or leave it out",
                    quantity=name,
                )


@si.checked_numbers
@dataclass(frozen=True)
class CalibrationRecord:
    """A calibration as a file remembers it: the day (UTC), the version that made it, whether the
    model explains what was observed, what came out in sentences, the recordings, and every
    observation beside the model."""

    when: str
    version: str
    fits: bool
    said: tuple[str, ...] = ()
    recordings: tuple[UsedRecording, ...] = ()
    compared: tuple[ComparedAnswer, ...] = ()

    @property
    def sentence(self) -> str:
        """When it was calibrated, on what, and whether the model explains that."""
        count, files = len(self.compared), len(self.recordings)
        numbers = f"{count} measured number{'' if count == 1 else 's'}"
        of = f" of {files} recording{'' if files == 1 else 's'}" if files else ""
        how = "The model explains them" if self.fits else "The model does NOT explain them"
        return f"Calibrated on {self.when} from {numbers}{of}. {how}."
