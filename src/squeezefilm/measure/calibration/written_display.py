"""A calibration as a display's file: values with their spreads, how they go together, a record.

Every value that the data told something of is written as measured, with the posterior's spread.
The rest stays as it was described. What the spreads of single values do not say is in the file's
`joint` (`core.calibration_record.JointSpread`), which draws of friction's interval use; what was
measured stands in its `calibration` (`core.calibration_record.CalibrationRecord`).
"""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np

from squeezefilm import __version__
from squeezefilm.core import quantities as si
from squeezefilm.core.calibration_record import (
    CalibratedAnswer,
    CalibrationRecord,
    JointSpread,
    UsedRecording,
)
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.config.schema import text_of
from squeezefilm.core.distributions import Distribution, Normal, Uniform
from squeezefilm.core.results import config_hash, to_json
from squeezefilm.measure.calibration.calibration import CalibratedValue, Calibration, Joint
from squeezefilm.measure.calibration.friction_posterior import finger_mixture
from squeezefilm.measure.calibration.identified import NOT_TOLD
from squeezefilm.measure.calibration.priors import SHARES, share_of
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.physics.uncertainty.draws import Input
from squeezefilm.physics.uncertainty.model_choices import AMPLITUDE_SHARE, FRICTION_OFFSET
from squeezefilm.physics.uncertainty.parameters import SKIN_COMPLIANCE, Parameter, with_values

_ROWS = 256
"""Draws that the file holds: their 5 % and 95 % ends are within some hundredths of all of them."""
_TOLD_WELL = 0.5
_FRACTION = re.compile(r"-?\d+\.\d+(e[-+]?\d+)?|-?\d+e[-+]?\d+")


def calibrated_display(
    calibration: Calibration, recordings: Sequence[UsedRecording] = ()
) -> Display:
    """The display with the posterior's values, their sources and spreads, its `joint`, and the
    record of its `calibration` on `recordings`.

    What the data said nothing of keeps its value and source; a plate's value that moved with others
    is marked as assumed.
    """
    changed = calibration.display
    stated = dict(changed.provenance)
    # A ceramic's constants that were written out have no place in the description's sources.
    day = datetime.now(UTC).date().isoformat()
    source = f"calibrated {day} from the {len(calibration.observations)} observations below"
    if not calibration.fits:
        source += "; the model does not fit them"
    moved: dict[str, float] = {}
    for learnt in calibration.values:
        if learnt.path in SHARES or learnt.path == SKIN_COMPLIANCE:
            continue
        told = learnt.left <= NOT_TOLD
        if not told and not learnt.path.startswith("actuator."):
            continue
        spread = _spread(learnt)
        if not learnt.path.startswith("actuator."):
            low, high = spread.support
            moved[learnt.path] = float(min(max(learnt.median, low), high))
        origin = (
            Provenance(source, "measured", spread)
            if told
            else Provenance(
                f"not told by what was measured, moved with the rest; {source}", "assumed", spread
            )
        )
        for path in _written_out(changed, learnt.path):
            stated[path] = origin
    changed = with_values(changed, moved)
    stated |= _ceramic_sources(calibration, source)
    changed = dataclasses.replace(changed, provenance=stated, joint=None, calibration=None)
    return dataclasses.replace(
        changed,
        joint=_joint(calibration, changed),
        calibration=CalibrationRecord(
            day,
            __version__,
            calibration.fits,
            calibration.sentences,
            tuple(recordings),
            calibration.compared,
            _answers(calibration.joint),
            actuator_digest(changed),
        ),
    )


def actuator_digest(display: Display) -> str:
    """A SHA-256 of an actuator's values to nine digits, which a file's text keeps."""
    text = json.dumps(to_json(display.actuator), sort_keys=True)
    return config_hash(_FRACTION.sub(lambda number: f"{float(number[0]):.9g}", text))


def _answers(joint: Joint) -> tuple[CalibratedAnswer, ...]:
    """Draws of the plate's answers, spread evenly over all that there are."""
    count = joint.friction.size
    rows = np.linspace(0, count - 1, min(_ROWS, count)).astype(int)
    return tuple(
        CalibratedAnswer(asked.said, tuple(float(f"{value:.7g}") for value in draws[rows]))
        for asked, draws in joint.answers.items()
        if np.all(np.isfinite(draws[rows]))
    )


def calibrated_text(calibration: Calibration, recordings: Sequence[UsedRecording] = ()) -> str:
    """The TOML text of `calibrated_display`. Raises `InputError` as `text_of` does."""
    display = calibrated_display(calibration, recordings)
    head = (
        f"# {display.name}, calibrated: values marked as measured are of its posterior; what was "
        "measured\n# stands below, under calibration.\n\n"
    )
    return head + text_of(display, display.provenance)


def _spread(value: CalibratedValue) -> Distribution:
    """A normal distribution where the data told the value well, else a range."""
    low, high = value.interval
    reach = 3 * value.standard_deviation
    inside = value.prior[0] <= value.median - reach and value.median + reach <= value.prior[1]
    if value.left < _TOLD_WELL and inside:
        return Normal(value.median, value.standard_deviation)
    # As wide as the draws, within the prior: uniform with their interval's 5 % and 95 % ends.
    wider = (high - low) / 18
    return Uniform(max(low - wider, value.prior[0]), min(high + wider, value.prior[1]))


def _written_out(display: Display, path: str) -> list[str]:
    """The paths that one with a star stands for."""
    if ".*." not in path:
        return [path]
    actuator = display.actuator
    count = len(actuator.patches) if isinstance(actuator, RectangularPlate) else 0
    return [path.replace("*", str(number)) for number in range(count)]


def _ceramic_sources(calibration: Calibration, source: str) -> dict[str, Provenance]:
    """Sources of the constants of a ceramic that was moved by shares."""
    actuator = calibration.display.actuator
    shares = [value for value in calibration.values if value.path in SHARES]
    if not shares or not isinstance(actuator, RectangularPlate | DiscPlate):
        return {}
    words = "; ".join(
        f"{SHARES[share.path]}: {share.median:.3f} "
        f"({share.interval[0]:.3f} to {share.interval[1]:.3f})"
        for share in shares
    )
    whole = Provenance(f"{source}. Moved together by shares: {words}", "measured")
    with_it = Provenance(f"with in_plane_stiffness: {source}", "measured")
    ceramic = actuator.ceramic
    names = ["in_plane_stiffness", "charge_coefficient", "relative_permittivity"]
    if ceramic.constants is not None:
        names += [
            f"constants.{entry.name}"
            for entry in dataclasses.fields(ceramic.constants)
            if getattr(ceramic.constants, entry.name) is not None
        ]
    return {f"actuator.ceramic.{name}": whole if name == names[0] else with_it for name in names}


def _joint(calibration: Calibration, display: Display) -> JointSpread | None:
    """The draws, by the spreads that the values of the calibrated `display` have."""
    joint = calibration.joint
    known = np.flatnonzero(np.isfinite(joint.friction))
    if known.size < 2:
        return None
    random = np.random.default_rng(calibration.seed)
    rows = random.choice(known, min(_ROWS, known.size), replace=False)
    prediction = predict(display)
    columns: dict[str, si.FloatArray] = {}
    share, offset = np.ones(joint.friction.size), joint.law_error
    if joint.answers and prediction.voltage is not None:
        share = joint.amplitude / prediction.touch.free_amplitude
        columns[AMPLITUDE_SHARE] = _of_normal(share[known], share[rows])
    if np.std(offset[known]) > 0:
        columns[FRICTION_OFFSET] = _of_normal(offset[known], offset[rows])
    if calibration.laws:
        before = finger_mixture(calibration.display, prediction)
        columns |= _shares(before.inputs, finger_mixture(display, prediction).inputs, joint, rows)
    return JointSpread(
        paths=tuple(columns),
        amplitude_share=float(np.mean(share[known])),
        amplitude_share_deviation=float(np.std(share[known])),
        friction_offset=float(np.mean(offset[known])),
        friction_offset_deviation=float(np.std(offset[known])),
        draws=tuple(
            tuple(round(float(value), 4) for value in row)
            for row in np.stack(list(columns.values()), axis=1)
        )
        if columns
        else (),
    )


def _of_normal(every: si.FloatArray, values: si.FloatArray) -> si.DimensionlessArray:
    """Shares of values by the normal distribution of all of them."""
    return share_of(Normal(float(np.mean(every)), float(np.std(every))), values)


def _shares(
    before: tuple[Input, ...], after: tuple[Input, ...], joint: Joint, rows: si.IntArray
) -> dict[str, si.DimensionlessArray]:
    """Shares of each input of finger and laws of drawn values by its spread after the
    calibration. A law's weights are as they were: its shares say how it was believed."""
    from scipy.special import ndtr

    own = dict(zip(joint.finger_paths, ndtr(joint.finger[rows]).T, strict=True))
    columns = {}
    old = {item.path: item for item in before}
    for item in after:
        if item.path in own:
            drawn = old[item.path]
            if isinstance(item, Parameter) and isinstance(drawn, Parameter):
                values = drawn.distribution.quantile(own[item.path])
                columns[item.path] = share_of(item.distribution, values)
            else:
                columns[item.path] = own[item.path]
    return columns
