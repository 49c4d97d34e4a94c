"""`fit_recording`: the fit that goes with each kind of recording."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import Annotated, Any, Protocol, cast

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.from_text import ReadBy, reads_text
from squeezefilm.measure.fits.estimate import Adequacy, Observation
from squeezefilm.measure.fits.vibration.driven_shape import DrivenShape
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.ceramic_bar import CeramicBar
from squeezefilm.measure.recordings.read import read_recording
from squeezefilm.physics.display import Display, NamedDisplay
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.working import solid_mode

OF_MANY_PEOPLE = kinds.FrictionDecays | kinds.FingertipImpedances | kinds.DetectionThresholds
"""What is compared, and not fitted."""
# The module of `measure.fits` and its function; imported when a recording of the kind is fitted.
FITS: dict[type, tuple[str, str]] = {
    kinds.ImpedanceSweep: ("circuit.impedance", "fit_impedance"),
    kinds.FrequencyResponse: ("vibration.frequency_response", "fit_frequency_response"),
    kinds.LineScan: ("vibration.line_scan", "fit_line_scan"),
    kinds.GridScan: ("vibration.grid_scan", "fit_grid_scan"),
    kinds.RingDown: ("vibration.ring_down", "fit_ring_down"),
    kinds.VoltageSweeps: ("vibration.voltage_sweeps", "fit_voltage_sweeps"),
    kinds.RawSignals: ("vibration.raw_signals", "fit_raw_signals"),
    kinds.FrictionBench: ("friction.friction_bench", "fit_friction_bench"),
    kinds.FrictionCurve: ("friction.friction_curve", "compare_friction_curve"),
}

CERAMICS: dict[type, tuple[str, str]] = {
    CeramicBar: ("ceramic.bar", "bar_constants"),
    CeramicDisc: ("ceramic.disc", "disc_constants"),
}
"""The same for a sweep of a bare ceramic, by its body."""

_NEAR: si.Dimensionless = 0.1
"""How far from a scan's frequency (of it) modes may take part in what is seen."""
_SAME: si.Dimensionless = 0.25
"""How far from the solved resonance (of it) a line scan may still be of that mode: a solved plate
is off by as much as its elastic constants and its glue."""
# Shapes are much nearer than frequencies on one mesh.
_TOLERANCE = 1e-2

NamedRecording = Annotated[kinds.Recording, ReadBy(read_recording)]
"""A recording, or in its place the path of its file (see `reads_text`)."""


class Fit(Protocol):
    """What every fit has, whatever was fitted: estimates are its fields of that type."""

    @property
    def adequacy(self) -> Adequacy:
        """Whether the fitted model describes what was recorded."""

    @property
    def observations(self) -> tuple[Observation, ...]:
        """What a calibration may use."""


@reads_text
def fit_recording(recording: NamedRecording, display: NamedDisplay | None = None) -> Fit:
    """What goes with the kind of a recording: a circuit with an impedance (constants of the
    material with that of a bare ceramic bar or disc, whose shape its description names), modes with
    a frequency response, models of friction with a friction curve; a frozen dataclass whose numbers
    are `Estimate`s, with its `adequacy` and the `observations` for a calibration.

    A grid scan is compared with the solved shapes of a `display`, and needs one; a line scan that
    is no even wave may be, a friction curve without a display of its own is taken for that
    display's; no other kind is given it. Raises what `read_recording` raises, and `InputError` for
    a recording that its fit refuses.
    """
    known = FITS.get(type(recording))
    if isinstance(recording, OF_MANY_PEOPLE):
        raise InputError(
            f"'{recording.told.name}' holds numbers of many people, which are compared and not "
            "fitted: squeezefilm reproduce --data FOLDER"
        )
    if known is None:
        raise InputError(
            f"{type(recording).__name__} is no kind of recording; give the path of a file, or what "
            "read_recording returned"
        )
    body = recording.body if isinstance(recording, kinds.ImpedanceSweep) else None
    module, name = known if body is None else CERAMICS[type(body)]
    fits = import_module(f"squeezefilm.measure.fits.{module}")
    if body is not None:
        return cast(Fit, getattr(fits, name)(recording, body))
    return cast(Fit, getattr(fits, name)(recording, **_of_display(recording, display, fits)))


def response_fit(fit: Fit) -> Fit | None:
    """The fit of the frequency response that raw signals give, which has the numbers; None for a
    fit of anything else. Raises what `fit_recording` raises."""
    response = getattr(fit, "response", None)
    return fit_recording(response) if isinstance(response, kinds.FrequencyResponse) else None


def _of_display(
    recording: kinds.Recording, display: Display | None, fits: ModuleType
) -> dict[str, Any]:
    """What a fit is given of the display, by name. Raises `InputError` for a grid scan without a
    plate."""
    if isinstance(recording, kinds.FrictionCurve):
        return {"display": None if recording.display else display}
    if not isinstance(recording, kinds.GridScan | kinds.LineScan):
        return {}
    plate = None if display is None else display.actuator
    if isinstance(recording, kinds.LineScan) and not isinstance(plate, RectangularPlate):
        return {}
    if not isinstance(plate, RectangularPlate):
        raise InputError(
            "a grid scan is compared with a plate's solved shapes; name its display, a rectangular "
            "plate: display biet2008-plate, or a TOML file",
            quantity="display",
        )
    mode = solid_mode(plate)
    if isinstance(recording, kinds.LineScan):
        other = abs(recording.frequency / mode.frequency - 1) > _SAME
        return {} if other else {"shape": DrivenShape.of(mode)}
    band = (recording.frequency * (1 - _NEAR), recording.frequency * (1 + _NEAR))
    modes = solve_modes(plate, band=band, tolerance=_TOLERANCE)
    return {"shapes": fits.shapes_at(modes, recording.x, recording.y, DrivenShape.of(mode))}
