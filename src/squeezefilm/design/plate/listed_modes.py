"""Driven modes as they are listed, which to work in, and doubts about one that is chosen."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.kit.numbers import HZ, PER_VOLT, shown
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.elements.nodal_lines import profiles
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate
from squeezefilm.physics.plate.solid.resonances import (
    SCREENING_ERROR,
    DrivenMode,
    Moving,
    screened_modes,
    strongest_neighbour,
)
from squeezefilm.physics.plate.solid.symmetry import forbidden_by, symmetry_in_words
from squeezefilm.physics.plate.working_mode import CROWDED, WorkingMode

HEARING: si.Hertz = 20e3
"""Frequency below which people hear a plate; the young and animals somewhat above it too."""

SAME_LABEL: si.Dimensionless = 0.1
"""Two modes of one label are worth telling apart if the weaker has this share of the stronger."""

DRIVEN_SHARE: si.Dimensionless = 1e-3
"""Share of the strongest mode's amplitude per volt below which a mode counts as not driven."""

# A product of one profile along and one across makes this share of a shape with straight lines.
_STRAIGHT = 0.6
# A mode that has less of what moves at its own antinode than this is not what moves there.
_OWN_SHARE = 0.5
# So far from the working mode neighbours and modes of the same label are looked for.
_NEAR = 0.15
# Above it and up to three times as high another mode is looked for, where this one is not driven.
_ELSEWHERE: tuple[si.Hertz, si.Hertz] = (HEARING, 60e3)


@dataclass(frozen=True)
class ListedMode:
    """A driven mode: its label, frequency, Q and amplitude per volt on the drive at resonance.

    `alone_per_volt` is at its antinode, of this mode alone, zero to peak, without a finger.
    `neighbour` is the mode that adds most at this one's resonance, `neighbour_distance` how far it
    lies in half-bandwidths f/2Q of its own, `neighbour_share` how much it adds, over this mode's
    amplitude. `unique` is whether no other mode of the list with at least a tenth of its amplitude
    has the label. `straightness` is the share of the shape that has straight nodal lines, `choice`
    what to write into the display's file to work in this mode; None where there is no such thing. A
    mode is `perhaps_audible` where the error of its frequency reaches into the hearing range.
    """

    label: str
    frequency: si.Hertz
    quality_factor: si.Dimensionless
    alone_per_volt: si.MetrePerVolt
    symmetry: str
    audible: bool
    neighbour: str | None = None
    neighbour_distance: si.Dimensionless | None = None
    neighbour_share: si.Dimensionless = 0.0
    unique: bool = True
    straightness: si.Dimensionless | None = None
    choice: str | None = None
    perhaps_audible: bool = False

    @property
    def half_bandwidth(self) -> si.Hertz:
        """f/2Q: so far from resonance the amplitude is down to 71 %."""
        return self.frequency / (2 * self.quality_factor)

    @property
    def crowded(self) -> bool:
        """True where a neighbour takes part in what moves at this mode's resonance."""
        return self.neighbour_share >= CROWDED

    @property
    def hidden(self) -> bool:
        """True where a neighbour moves more than this mode does at its own resonance."""
        return self.neighbour_share >= 1


@dataclass(frozen=True)
class Suggestion:
    """Suggestion for the display's file, and its reason; `mode` is None where nothing fits."""

    mode: ListedMode | None
    text: str


_Mode = TypeVar("_Mode", DrivenMode, ListedMode)


def listed_mode(mode: DrivenMode) -> ListedMode:
    """A screened mode as it is listed, its neighbours not looked at yet."""
    return ListedMode(
        label=mode.name,
        frequency=mode.frequency,
        quality_factor=mode.quality_factor,
        alone_per_volt=mode.alone_per_volt,
        symmetry=symmetry_in_words(mode.parity),
        audible=mode.frequency < HEARING,
        straightness=mode.straightness,
        choice=_choice(mode.label),
        # Screened frequencies are too high if anything.
        perhaps_audible=HEARING <= mode.frequency < HEARING * (1 + SCREENING_ERROR),
    )


def driven_modes(modes: Sequence[_Mode]) -> list[_Mode]:
    """Those of some modes that the drive moves, by `DRIVEN_SHARE`."""
    strongest = max((mode.alone_per_volt for mode in modes), default=0.0)
    return [mode for mode in modes if mode.alone_per_volt >= DRIVEN_SHARE * strongest > 0]


def listed_modes(modes: Sequence[DrivenMode]) -> tuple[ListedMode, ...]:
    """Screened or solved modes as they are listed, those that are driven."""
    return with_neighbours([listed_mode(mode) for mode in driven_modes(modes)])


def with_working_mode(
    modes: Sequence[ListedMode], working: WorkingMode, plate: RectangularPlate
) -> tuple[tuple[ListedMode, ...], ListedMode]:
    """Screened modes with a display's own as it was solved in place of what screening has of it;
    and that one.

    The one replaced is of those with its label, or else of all, the nearest in frequency, as far as
    screening lies off; where none is so near the solved mode is added.
    """
    solid, frequency = working.solid, working.resonance_frequency
    assert solid is not None
    row = ListedMode(
        label=working.label,
        frequency=frequency,
        quality_factor=working.quality_factor,
        alone_per_volt=solid.alone_per_volt,
        symmetry=symmetry_in_words(solid.modes.parities[solid.index]),
        audible=frequency < HEARING,
        straightness=profiles(solid.modes.shapes[solid.index])[2],
        choice=_choice(plate.working_label),
    )
    near = [mode for mode in modes if abs(mode.frequency / frequency - 1) < 1.2 * SCREENING_ERROR]
    same = [mode for mode in near if mode.label == row.label] or near
    screened = min(same, key=lambda mode: abs(mode.frequency - frequency), default=None)
    others = [mode for mode in modes if mode is not screened]
    listed = with_neighbours(sorted([*others, row], key=lambda mode: mode.frequency))
    beside = working.neighbour
    own = next(mode for mode in listed if mode.frequency == frequency)
    if beside is None:
        return listed, own
    told = dataclasses.replace(
        own,
        neighbour=beside.name,
        neighbour_distance=beside.distance,
        neighbour_share=beside.share,
    )
    return tuple(told if mode is own else mode for mode in listed), told


def _choice(label: tuple[int, int] | None) -> str | None:
    """Setting to write to work in a mode: only lines across one side can be asked for."""
    if label is None or min(label) > 0 or max(label) < 2:
        return None
    if label[1] == 0:
        return f"nodal_lines = {label[0]}"
    return f'nodal_lines = {label[1]}, lines_across = "width"'


def with_neighbours(modes: Sequence[ListedMode]) -> tuple[ListedMode, ...]:
    """Modes with what each has for its neighbour, and whether its label is its own."""
    return tuple(_beside(mode, [other for other in modes if other is not mode]) for mode in modes)


def _beside(mode: ListedMode, others: Sequence[ListedMode]) -> ListedMode:
    neighbour = strongest_neighbour(_moving(mode), map(_moving, others))
    if neighbour is None:
        return mode
    same = [other for other in others if other.label == mode.label != "in plane"]
    return dataclasses.replace(
        mode,
        neighbour=neighbour.name,
        neighbour_distance=neighbour.distance,
        neighbour_share=neighbour.share,
        unique=all(other.alone_per_volt < SAME_LABEL * mode.alone_per_volt for other in same),
    )


def _moving(mode: ListedMode) -> Moving:
    return Moving(mode.label, mode.frequency, mode.half_bandwidth, mode.alone_per_volt)


def chosen(
    modes: Sequence[ListedMode], label: str, near: si.Hertz | None = None
) -> ListedMode | None:
    """Mode nearest to a frequency (Hz) of those with a label; without a frequency the strongest."""
    matching = [mode for mode in modes if mode.label == label]
    if near is not None:
        return min(matching, key=lambda mode: abs(mode.frequency - near), default=None)
    return max(matching, key=lambda mode: mode.alone_per_volt, default=None)


def wanted_frequency(actuator: Actuator) -> si.Hertz | None:
    """The frequency (Hz) at which a described plate asks for its mode, where it does."""
    return actuator.working_frequency if isinstance(actuator, RectangularPlate) else None


def suggested(modes: Sequence[ListedMode], described: ListedMode | None = None) -> Suggestion:
    """The mode to work in: of those that are driven (`driven_modes`), can be asked for, are
    inaudible and have straight nodal lines, the one that moves most when what its neighbours take
    part with is held against it.

    `described` is the mode that the display's file asks for: then there is nothing to write."""
    able = [
        mode
        for mode in driven_modes(modes)
        if mode.choice is not None
        and not (mode.audible or mode.perhaps_audible)
        and (mode.straightness is None or mode.straightness >= _STRAIGHT)
    ]
    if not able:
        return Suggestion(
            None,
            "No driven mode in this band is surely above the hearing range and has straight nodal "
            "lines across one side only, so that none can be suggested: look in a wider band "
            "(band), or change the ceramics' polarity, place or size.",
        )
    best = max(able, key=lambda mode: mode.alone_per_volt / (1 + 4 * mode.neighbour_share))
    # A screened frequency in as many digits as it has.
    frequency = shown(best.frequency, HZ, 3)
    straight = "" if best.straightness is None else ", its nodal lines cross one side only"
    others = (
        f", and of {len(able)} such modes it moves most, counting against it what neighbours add"
        if len(able) > 1
        else ", the only such mode here"
    )
    if best is described:
        write = f"Keep {best.choice}, as described"
    else:
        alone = "" if best.unique else f', working_frequency = "{frequency}"'
        write = f"Write {best.choice}{alone}"
    said = (
        f"{write}: at {frequency} {best.label} is above the hearing range{straight}{others} "
        f"({shown(best.alone_per_volt, PER_VOLT, 3)} at an antinode"
    )
    if best.neighbour is not None and best.neighbour_distance is not None:
        said += (
            f"; {best.neighbour} lies {best.neighbour_distance:.3g} half-bandwidths away and adds "
            f"{100 * best.neighbour_share:.2g} % of that"
        )
    said += ")."
    if best.crowded:
        said += (
            " It is crowded all the same: what moves at its resonance is partly the other mode. "
            "Other ceramics or another size of the plate may part them."
        )
    return Suggestion(best, said)


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
        shown(value, PER_VOLT, 3) for value in (solid.alone_per_volt, solid.amplitude_per_volt)
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
        modes = _screened(plate, _ELSEWHERE)
        instead = f"{suggested(modes).text} " if modes else ""
        yield f"{undriven} {instead}squeezefilm modes lists what is driven."
    if mode.resonance_frequency < HEARING:
        yield (
            f"{mode.label} is audible: {shown(mode.resonance_frequency, HZ)} lies below "
            f"{shown(HEARING, HZ)}, where people hear the plate whenever it is driven. Take a "
            "thicker or smaller plate, or a mode with more nodal lines."
        )
    if isinstance(plate, RectangularPlate) and undriven is None:
        yield from _company(plate, mode)


def _company(plate: RectangularPlate, mode: WorkingMode) -> Iterator[str]:
    """Neighbours and modes of the same name."""
    near, solid = mode.resonance_frequency, mode.solid
    band = (1 - _NEAR) * near, (1 + _NEAR) * near
    modes = (
        _screened(plate, band)
        if solid is None
        else listed_modes(solid.response.settled_modes(band))
    )
    has = None if solid is None else solid.modes.labels[solid.index]
    if solid is not None and has != plate.working_label:
        lines = "moves in its plane" if has is None else f"has nodal lines ({has[0]},{has[1]})"
        yield (
            f"The mode taken, nearest to the working_frequency, {lines} and not {mode.label}: "
            "nodal lines and half wavelength below are those of its dominant part."
        )
    if (company := mode.company) is not None:
        yield company
    own = chosen(modes, mode.label, near)
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
            f"{shown(mode.frequency, HZ, 3)} ({shown(mode.alone_per_volt, PER_VOLT, 3)})"
            for mode in sorted([own, *same], key=lambda mode: mode.frequency)
        )
        yield (
            f"{len(same) + 1} modes near have the label {mode.label}, at {listed}"
            f"{' by screening' if solid is None else ''}: the most strongly driven was taken, at "
            f"{shown(near, HZ)}. To choose, write working_frequency beside "
            "nodal_lines."
        )


def _screened(plate: RectangularPlate, band: tuple[si.Hertz, si.Hertz]) -> tuple[ListedMode, ...]:
    """The driven modes of a band as they are listed; none where the plate cannot be screened."""
    try:
        modes = screened_modes(plate, band)
    except SqueezefilmError:
        return ()
    return listed_modes(modes)
