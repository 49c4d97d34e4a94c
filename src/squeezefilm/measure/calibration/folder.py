"""Calibration of a display by a folder of recordings, and scores of a prediction."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

from squeezefilm.core.arguments import reads_text
from squeezefilm.core.calibration_record import UsedRecording
from squeezefilm.core.distributions import Distribution
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.hard_limits import RECORDING_BYTES
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.regular_file import read_regular
from squeezefilm.core.results import Result, values_of, write_whole
from squeezefilm.measure.calibration.blind import Score, load_prediction, score
from squeezefilm.measure.calibration.calibrate import calibrate
from squeezefilm.measure.calibration.calibration import Calibration
from squeezefilm.measure.calibration.discrepancy import touching
from squeezefilm.measure.calibration.solved_answers import (
    FRICTION,
    MODE_FREQUENCY,
    PLATE_ANSWERS,
    asked_by,
)
from squeezefilm.measure.calibration.written_display import calibrated_display, calibrated_text
from squeezefilm.measure.fits.by_kind import fit_recording, response_fit
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.measure.recordings.kinds import FrictionCurve
from squeezefilm.measure.recordings.read import check_folder
from squeezefilm.physics.display import Display, NamedDisplay


@dataclass(frozen=True, eq=False)
class FolderObservations:
    """Observations of the recordings of a folder, which of them did, and what of the folder was
    `left_out`, each with its reason."""

    observations: tuple[Observation, ...]
    recordings: tuple[UsedRecording, ...]
    left_out: tuple[str, ...]


@dataclass(frozen=True, eq=False, repr=False)
class FolderCalibration(Result):
    """A calibration on a folder's recordings: the calibration, the recordings that it used, what of
    the folder was `left_out` with its reason, and the file of the calibrated display (None where
    none was written)."""

    calibration: Calibration
    recordings: tuple[UsedRecording, ...]
    left_out: tuple[str, ...]
    file: Path | None = None
    _shown: ClassVar[str] = "calibration.fits calibration.after.interval file"

    @cached_property
    def display(self) -> Display:
        """The calibrated display, with its spreads and the record of its calibration."""
        return calibrated_display(self.calibration, self.recordings)

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values."""
        return {
            **self.calibration.summary(),
            **values_of(self, "file recordings left_out"),
        }


@reads_text
def calibrate_display(
    display: NamedDisplay,
    folder: str | Path,
    out: str | Path | None = None,
    *,
    parameters: Mapping[str, Distribution | None] | None = None,
    seed: int = 1,
    progress: SayProgress | None = None,
) -> FolderCalibration:
    """A display's uncertain values learned from all recordings of a folder.

    Each recording is fitted by its kind. What an inadequate fit observed, and answers that no
    calibration uses, are left out and named. With `out` the calibrated display is written to that
    TOML file; `write_report` writes it with a page. `parameters`, `seed`, validity and time
    are those of `measure.calibration.calibrate.calibrate`: some minutes for eight values.

    Raises `InputError` where nothing is left of the folder, what `load_display` raises for the name
    of a display, and what `calibrate` raises.
    """
    tell = progress or (lambda _: None)
    seen = folder_observations(display, folder, tell)
    if not seen.observations:
        raise InputError(
            f"{folder} holds nothing that a calibration can use: {'; '.join(seen.left_out)}"
        )
    calibration = calibrate(
        display,
        seen.observations,
        parameters=parameters,
        seed=seed,
        progress=progress,
    )
    file = None if out is None else Path(out)
    if file is not None:
        write_whole(file, calibrated_text(calibration, seen.recordings))
    return FolderCalibration(calibration, seen.recordings, seen.left_out, file)


@reads_text
def score_prediction(
    prediction: str | Path,
    folder: str | Path,
    display: NamedDisplay,
    *,
    progress: SayProgress | None = None,
) -> tuple[tuple[Score, ...], tuple[str, ...]]:
    """A prediction's file compared with a folder of recordings made since: error, inside its
    interval or not, log score of every number; and what of the folder was not compared, and why.

    `display` is the one that was predicted: grid scans are fitted by its shapes. A prediction that
    was changed is refused before the data are opened. Raises `InputError` as `load_prediction` and
    `score`, and for a folder without recordings.
    """
    asked = {predicted.answer for predicted in load_prediction(prediction).predictions}
    seen = folder_observations(display, folder, progress or (lambda _: None))
    scores = score(prediction, seen.observations)
    compared = {id(scored.observation) for scored in scores}
    left_out = [
        f"{observed.recording}, its {observed.answer.replace('_', ' ')}: "
        + ("predicted under other conditions" if observed.answer in asked else "not predicted")
        for observed in seen.observations
        if id(observed) not in compared
    ]
    return scores, (*seen.left_out, *left_out)


def folder_observations(
    display: Display, folder: str | Path, tell: SayProgress
) -> FolderObservations:
    """Fit the recordings of a folder and gather what they observed.

    Raises `InputError` for what is no folder, or one without recordings.
    """
    check = check_folder(folder)
    observations: list[Observation] = []
    recordings: list[UsedRecording] = []
    left_out = [f"{refusal.file.name}: {refusal.why}" for refusal in check.refused]
    for recording in check.checks:
        name = recording.file.name
        tell(f"fit of {name}")
        try:
            fit = fit_recording(recording.recording, display, progress=tell)
            fit = response_fit(fit) or fit
        except SqueezefilmError as error:
            left_out.append(f"{name}: {error}")
            continue
        # A friction curve is compared, not fitted: that it differs is what a calibration is for.
        if not fit.adequacy.adequate and not isinstance(recording.recording, FrictionCurve):
            left_out.append(f"{name}: {fit.adequacy.sentence}")
            continue
        used = [dataclasses.replace(seen, recording=name) for seen in fit.observations]
        if not used:
            left_out.append(f"{name}: its fit tells no answer of a display")
        left_out += [
            f"{name}, its {seen.answer.replace('_', ' ')}: {why}"
            for seen in used
            if (why := usable(seen))
        ]
        used = [seen for seen in used if not usable(seen)]
        observations += used
        if used:
            recordings.append(_used(recording.file, recording.kind, recording.recording.told))
    return FolderObservations(tuple(observations), tuple(recordings), tuple(left_out))


def _used(file: Path, kind: str, told: Any) -> UsedRecording:
    digest = hashlib.sha256(read_regular(file, RECORDING_BYTES, "a recording")).hexdigest()
    taken = (told.who, told.when, told.instrument, told.source)
    return UsedRecording(file.name, kind, *taken, digest)


def usable(observation: Observation) -> str:
    """Reason why a calibration cannot use an observation; empty where it can."""
    if observation.answer not in (*PLATE_ANSWERS, MODE_FREQUENCY, FRICTION):
        return "a calibration has no use for it"
    try:
        _ = touching(observation) if observation.answer == FRICTION else asked_by(observation)
    except InputError as error:
        return str(error)
    if not (observation.value > 0 and observation.standard_error > 0):
        return "it is not above 0, or has no error"
    return ""
