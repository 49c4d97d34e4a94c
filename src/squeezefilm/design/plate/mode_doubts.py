"""Doubts about the mode that a display works in: not driven, audible, crowded, or not the only one
of its name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.design.plate.listed_modes import (
    DRIVEN_SHARE,
    HEARING,
    SAME_LABEL,
    ListedMode,
    chosen,
    listed_mode,
    shown_frequency,
    suggested,
    with_neighbours,
)
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.resonances import DrivenMode, screened_modes
from squeezefilm.physics.plate.solid.symmetry import forbidden_by
from squeezefilm.physics.plate.working_mode import WorkingMode

_HZ, _PER_VOLT = si.Unit("Hz"), si.Unit("m/V")

# A mode that has less of what moves at its own antinode than this is not what moves there.
_OWN_SHARE = 0.5
# So far from the working mode neighbours and modes of the same label are looked for.
_NEAR = 0.15
# Above it and up to three times as high another mode is looked for, where this one is not driven.
_ELSEWHERE: tuple[si.Hertz, si.Hertz] = (HEARING, 60e3)


def why_undriven(display: Display, mode: WorkingMode) -> str | None:
    """Reason why the drive does not move a plate's working mode; None where it does.

    Symmetry may forbid it; or what moves at its antinode at its frequency is mostly other modes, as
    the solved plate tells.
    """
    plate = display.actuator
    if not isinstance(plate, RectangularPlate):
        return None
    if (forbidden := forbidden_by(plate, plate.working_label)) is not None:
        return f"The working mode {mode.label} is not driven: {forbidden}."
    solid = mode.solid
    if solid is None or solid.alone_per_volt >= _OWN_SHARE * solid.amplitude_per_volt:
        return None
    own, all_of_it = (
        si.format_quantity(value, _PER_VOLT, 3)
        for value in (solid.alone_per_volt, solid.amplitude_per_volt)
    )
    return (
        f"The working mode {mode.label} is hardly driven: of {all_of_it} at its antinode it has "
        f"{own}, its neighbours move the rest."
    )


def mode_doubts(display: Display, mode: WorkingMode) -> Iterator[str]:
    """Sentences against the mode that a display works in, the worst first.

    What lies around it is taken from a plate's solution, of a plate that was not solved from
    screening (some tenths of a second); of discs and stators it is said only whether people hear
    them. Empty where nothing is to be said, or the plate cannot be screened.
    """
    plate = display.actuator
    undriven = why_undriven(display, mode)
    if undriven is not None and isinstance(plate, RectangularPlate):
        yield f"{undriven} {_instead(plate)}"
    if mode.resonance_frequency < HEARING:
        yield (
            f"{mode.label} is audible: {si.format_quantity(mode.resonance_frequency, _HZ)} lies "
            f"below {si.format_quantity(HEARING, _HZ)}, where people hear the plate whenever it is "
            "driven. Take a thicker or smaller plate, or a mode with more nodal lines."
        )
    if isinstance(plate, RectangularPlate) and undriven is None:
        yield from _company(plate, mode)


def _company(plate: RectangularPlate, mode: WorkingMode) -> Iterator[str]:
    """Neighbours and modes of the same name."""
    modes, solid = _around(plate, mode), mode.solid
    has = None if solid is None else solid.modes.labels[solid.index]
    if solid is not None and has != plate.working_label:
        lines = "moves in its plane" if has is None else f"has nodal lines ({has[0]},{has[1]})"
        yield (
            f"The mode taken, nearest to the working_frequency, {lines} and not {mode.label}: "
            "nodal lines and half wavelength below are those of its dominant part."
        )
    if (company := mode.company) is not None:
        yield company
    own = chosen(modes, mode.label, mode.resonance_frequency)
    if own is None:
        return
    if solid is None and own.crowded and own.neighbour_distance is not None:
        yield (
            f"{mode.label} is crowded: {own.neighbour} lies {own.neighbour_distance:.2g} "
            f"half-bandwidths away (by screening) and adds about {100 * own.neighbour_share:.0f} % "
            "of the amplitude at resonance. Small changes of the plate mix the two: nodal lines "
            "and amplitude then differ from what is computed."
        )
    same = [
        other
        for other in modes
        if other.label == mode.label
        and other is not own
        and other.alone_per_volt >= SAME_LABEL * own.alone_per_volt
    ]
    if same and plate.working_frequency is None:
        listed = " and ".join(
            f"{shown_frequency(mode)} ({si.format_quantity(mode.alone_per_volt, _PER_VOLT, 3)})"
            for mode in sorted([own, *same], key=lambda mode: mode.frequency)
        )
        yield (
            f"{len(same) + 1} modes near have the label {mode.label}, at {listed}"
            f"{' by screening' if solid is None else ''}: the most strongly driven was taken, at "
            f"{si.format_quantity(mode.resonance_frequency, _HZ)}. To choose, write "
            "working_frequency beside nodal_lines."
        )


def _instead(plate: RectangularPlate) -> str:
    """Advice on what to work in instead."""
    modes = _screened(plate, _ELSEWHERE)
    if not modes:
        return "squeezefilm modes lists what is driven."
    return f"{suggested(modes).text} squeezefilm modes lists what is driven."


def _screened(plate: RectangularPlate, band: tuple[si.Hertz, si.Hertz]) -> tuple[ListedMode, ...]:
    """The driven modes of a band as they are listed; none where the plate cannot be screened."""
    try:
        modes = screened_modes(plate, band)
    except SqueezefilmError:
        return ()
    return _listed(modes)


def _around(plate: RectangularPlate, mode: WorkingMode) -> tuple[ListedMode, ...]:
    """The driven modes around a working mode as they are listed."""
    band = (1 - _NEAR) * mode.resonance_frequency, (1 + _NEAR) * mode.resonance_frequency
    if mode.solid is None:
        return _screened(plate, band)
    return _listed(mode.solid.response.settled_modes(band))


def _listed(modes: Sequence[DrivenMode]) -> tuple[ListedMode, ...]:
    strongest = max((mode.alone_per_volt for mode in modes), default=0.0)
    driven = [mode for mode in modes if mode.alone_per_volt >= DRIVEN_SHARE * strongest > 0]
    return with_neighbours([listed_mode(mode) for mode in driven])
