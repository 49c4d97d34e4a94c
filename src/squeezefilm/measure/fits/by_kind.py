"""`fit_recording`: the fit that goes with each kind of recording."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import ReadBy, reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.core.progress import SayProgress
from squeezefilm.measure.fits.ceramic.constants import bar_constants, disc_constants
from squeezefilm.measure.fits.circuit.impedance import fit_impedance
from squeezefilm.measure.fits.estimate import FitResult
from squeezefilm.measure.fits.friction.friction_bench import fit_friction_bench
from squeezefilm.measure.fits.friction.friction_curve import compare_friction_curve
from squeezefilm.measure.fits.vibration.frequency_response import fit_frequency_response
from squeezefilm.measure.fits.vibration.line_scan import fit_line_scan
from squeezefilm.measure.fits.vibration.raw_signals import fit_raw_signals
from squeezefilm.measure.fits.vibration.ring_down import fit_ring_down
from squeezefilm.measure.fits.vibration.solved_shapes import DrivenShape, fit_grid_scan, shapes_at
from squeezefilm.measure.fits.vibration.voltage_sweeps import fit_voltage_sweeps
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.read import read_recording
from squeezefilm.physics.display import Display, NamedDisplay
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.working import solid_mode

OF_MANY_PEOPLE = kinds.FrictionDecays | kinds.FingertipImpedances | kinds.DetectionThresholds
"""Kinds that are compared, and not fitted."""

_NEAR: si.Dimensionless = 0.1
"""Distance from a scan's frequency (of it) up to which modes may take part in what is seen."""
_SAME: si.Dimensionless = 0.25
"""Distance from the solved resonance (of it) up to which a line scan may still be of that mode: a
solved plate is off by as much as its elastic constants and its glue."""
# Shapes are much nearer than frequencies on one mesh.
_TOLERANCE = 1e-2

NamedRecording = Annotated[kinds.Recording, ReadBy(read_recording)]
"""A recording, or in its place the path of its file (see `reads_text`)."""


@reads_text
def fit_recording(
    recording: NamedRecording,
    display: NamedDisplay | None = None,
    *,
    progress: SayProgress | None = None,
) -> FitResult:
    """The fit that goes with the kind of a recording: a circuit with an impedance (constants of the
    material with that of a bare ceramic bar or disc, whose shape its description names), modes with
    a frequency response, models of friction with a friction curve; a frozen dataclass whose numbers
    are `Estimate`s, with its `adequacy` and the `observations` for a calibration.

    A grid scan is compared with the solved shapes of a `display`, and needs one; a line scan that
    is no even wave may be, a friction curve without a display of its own is taken for that
    display's; no other kind is given it. A friction curve takes a minute or two before its films
    are kept, and tells `progress`. Raises what `read_recording` raises, and `InputError` for
    a recording that its fit refuses.
    """
    if isinstance(recording, OF_MANY_PEOPLE):
        raise InputError(
            f"'{recording.told.name}' holds numbers of many people, which are compared and not "
            "fitted: squeezefilm reproduce --data FOLDER"
        )
    fit = FITS.get(type(recording))
    if fit is None:
        raise InputError(
            f"{type(recording).__name__} is no kind of recording; give the path of a file, or what "
            "read_recording returned"
        )
    return fit(recording, display, progress)


def response_fit(fit: FitResult) -> FitResult | None:
    """The fit of the frequency response that raw signals give, which has the numbers; None for a
    fit of anything else. Raises what `fit_recording` raises."""
    response = getattr(fit, "response", None)
    return fit_recording(response) if isinstance(response, kinds.FrequencyResponse) else None


def _swept(sweep: kinds.ImpedanceSweep, *_: object) -> FitResult:
    """A circuit, or the constants of a bare ceramic."""
    if sweep.body is None:
        return fit_impedance(sweep)
    if isinstance(sweep.body, kinds.CeramicBar):
        return bar_constants(sweep, sweep.body)
    return disc_constants(sweep, sweep.body)


def _line(scan: kinds.LineScan, display: Display | None, _: object) -> FitResult:
    """A wave along a line, beside the shape of a plate that resonates near the scan's frequency."""
    plate = None if display is None else display.actuator
    if isinstance(plate, RectangularPlate):
        mode = solid_mode(plate)
        if abs(scan.frequency / mode.frequency - 1) <= _SAME:
            return fit_line_scan(scan, DrivenShape.of(mode))
    return fit_line_scan(scan)


def _grid(scan: kinds.GridScan, display: Display | None, _: object) -> FitResult:
    """A scan of a face beside the plate's solved shapes."""
    plate = None if display is None else display.actuator
    if not isinstance(plate, RectangularPlate):
        raise InputError(
            "a grid scan is compared with a plate's solved shapes; name its display, a rectangular "
            "plate: display biet2008-plate, or a TOML file",
            quantity="display",
        )
    band = (scan.frequency * (1 - _NEAR), scan.frequency * (1 + _NEAR))
    modes = solve_modes(plate, band=band, tolerance=_TOLERANCE)
    driven = DrivenShape.of(solid_mode(plate))
    return fit_grid_scan(scan, shapes_at(modes, scan.x, scan.y, driven))


FITS: Mapping[type, Callable[[Any, Display | None, SayProgress | None], FitResult]] = {
    kinds.ImpedanceSweep: _swept,
    kinds.FrequencyResponse: lambda response, *_: fit_frequency_response(response),
    kinds.LineScan: _line,
    kinds.GridScan: _grid,
    kinds.RingDown: lambda decay, *_: fit_ring_down(decay),
    kinds.VoltageSweeps: lambda sweeps, *_: fit_voltage_sweeps(sweeps),
    kinds.RawSignals: lambda signals, *_: fit_raw_signals(signals),
    kinds.FrictionBench: lambda bench, *_: fit_friction_bench(bench),
    kinds.FrictionCurve: lambda curve, display, progress: compare_friction_curve(
        curve, progress, None if curve.display else display
    ),
}
"""The fit of each kind of recording, which is given the display where one was named, and whom to
tell how far it is."""
