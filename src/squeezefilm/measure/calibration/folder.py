"""From a folder of recordings to a calibrated display."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from squeezefilm.display import Display, NamedDisplay
from squeezefilm.distributions import Distribution
from squeezefilm.errors import InputError, SqueezefilmError
from squeezefilm.from_text import reads_text
from squeezefilm.measure.calibration.calibrate import calibrate
from squeezefilm.measure.calibration.calibration import Calibration
from squeezefilm.measure.calibration.friction_likelihood import touching
from squeezefilm.measure.calibration.solved_answers import FRICTION, asked_by
from squeezefilm.measure.calibration.written_display import write_calibrated
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.measure.recordings.kinds import FrictionCurve
from squeezefilm.progress import SayProgress


@dataclass(frozen=True, eq=False)
class FolderCalibration:
    """A calibration on a folder's recordings, the file it was written to, and what of the folder
    was `left_out` with its reason."""

    calibration: Calibration
    file: Path
    left_out: tuple[str, ...]

    def summary(self) -> dict[str, Any]:
        """The numbers for ``--json``."""
        return {
            **self.calibration.summary(),
            "file": str(self.file),
            "left_out": list(self.left_out),
        }


@reads_text
def calibrate_folder(
    display: NamedDisplay,
    folder: str | Path,
    out: str | Path,
    *,
    parameters: Mapping[str, Distribution | None] | None = None,
    seed: int = 1,
    progress: SayProgress | None = None,
) -> FolderCalibration:
    """`calibrate` on all recordings of a folder; writes the calibrated display to `out`.

    Each recording is fitted by its kind. What an inadequate fit observed, and answers that no
    calibration uses, are left out and named. Raises `InputError` where nothing is left, and what
    `calibrate` raises.
    """
    tell = progress or (lambda _: None)
    observations, left_out = folder_observations(display, folder, tell)
    if not observations:
        raise InputError(
            f"{folder} holds nothing that a calibration can use: {'; '.join(left_out)}"
        )
    found = calibrate(display, observations, parameters=parameters, seed=seed, progress=progress)
    return FolderCalibration(found, write_calibrated(found, out), left_out)


def folder_observations(
    display: Display, folder: str | Path, tell: SayProgress
) -> tuple[tuple[Observation, ...], tuple[str, ...]]:
    """What the recordings of a folder observed, and what was left out with its reason.

    Raises `InputError` for what is no folder, or one without recordings.
    """
    # Readers and fits are imported when there is something to read: some take a second.
    check = import_module("squeezefilm.measure.recordings.read").check_folder(folder)
    by_kind = import_module("squeezefilm.measure.fits.by_kind")
    observations: list[Observation] = []
    left_out = [f"{one.file.name}: {one.why}" for one in check.refused]
    for one in check.checks:
        tell(f"fit of {one.file.name}")
        try:
            fit = by_kind.fit_recording(one.recording, display)
            fit = by_kind.response_fit(fit) or fit
        except SqueezefilmError as error:
            left_out.append(f"{one.file.name}: {error}")
            continue
        # A friction curve is compared, not fitted: that it differs is what a calibration is for.
        if not fit.adequacy.adequate and not isinstance(one.recording, FrictionCurve):
            left_out.append(f"{one.file.name}: {fit.adequacy.sentence}")
            continue
        for seen in fit.observations:
            why = usable(seen)
            if why:
                left_out.append(f"{one.file.name}: {why}")
            else:
                observations.append(seen)
    return tuple(observations), tuple(left_out)


def usable(observation: Observation) -> str:
    """Why a calibration cannot use an observation; empty where it can."""
    try:
        _ = touching(observation) if observation.answer == FRICTION else asked_by(observation)
    except InputError as error:
        return str(error)
    if not (observation.value > 0 and observation.standard_error > 0):
        return f"{observation.answer} is not above 0, or has no error"
    return ""
