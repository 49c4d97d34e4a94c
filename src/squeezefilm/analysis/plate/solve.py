"""Whatever plate a display has, solved: a rectangle, a disc or a stator."""

from __future__ import annotations

from collections.abc import Callable

from squeezefilm import quantities as si
from squeezefilm.analysis.plate.command import PlateAnalysis, analyze_plate
from squeezefilm.analysis.plate.ring import RingAnalysis, analyze_ring
from squeezefilm.analysis.plate.tracking import TrackRequest
from squeezefilm.display import NamedDisplay
from squeezefilm.errors import InputError
from squeezefilm.from_text import reads_text
from squeezefilm.plate.layout import RectangularPlate


@reads_text
def solve_plate(
    display: NamedDisplay,
    *,
    mode: tuple[int, int] | None = None,
    band: tuple[si.Hertz, si.Hertz] | None = None,
    points: int = 200,
    sensitivity: bool = False,
    track: TrackRequest | None = None,
    progress: Callable[[str], None] | None = None,
) -> PlateAnalysis | RingAnalysis:
    """The modes of a display's plate, disc or stator in a band (Hz), and its working mode's
    response at `points` frequencies.

    Arguments and errors are those of `analyze_plate` and `analyze_ring`; `sensitivity` and `track`
    are for rectangular plates. Raises `InputError` where they are asked of another.
    """
    actuator = display.actuator
    if isinstance(actuator, RectangularPlate):
        return analyze_plate(
            display,
            mode=mode,
            band=band,
            points=points,
            sensitivity=sensitivity,
            track=track,
            progress=progress,
        )
    if sensitivity or track is not None:
        raise InputError(
            f"sensitivity and track are for rectangular plates; '{display.name}' is a "
            f"{actuator.type.replace('_', ' ')}"
        )
    return analyze_ring(display, mode=mode, band=band, points=points, progress=progress)
