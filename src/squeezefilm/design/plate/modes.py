"""List of the modes of a band that the drive can move (`squeezefilm modes`), to choose one by.

A rectangular plate is screened (see `screened_modes`), a disc or a stator solved.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any, ClassVar

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import Result, stamp, to_json, values_of
from squeezefilm.design.plate.listed_modes import (
    DRIVEN_SHARE,
    HEARING,
    ListedMode,
    Suggestion,
    chosen,
    driven_modes,
    listed_modes,
    suggested,
    wanted_frequency,
    with_neighbours,
    with_working_mode,
)
from squeezefilm.design.plate.ring import largest_error, mode_row, modes_in_band
from squeezefilm.design.plate.ring_pair import RingPair, ring_pair
from squeezefilm.physics.display import Display, NamedDisplay
from squeezefilm.physics.plate.layout import AnnularStator, RectangularPlate
from squeezefilm.physics.plate.ring.body import ring_body
from squeezefilm.physics.plate.ring.modes import DEFAULT_DEGREE, clamped_capacitance
from squeezefilm.physics.plate.solid.resonances import (
    SCREENING_ERROR,
    DrivenMode,
    label_name,
    screened_modes,
)
from squeezefilm.physics.plate.solid.symmetry import drive_classes, forbidden_by, only_stretches
from squeezefilm.physics.plate.working_mode import WorkingMode, working_mode

DEFAULT_BAND: tuple[si.Hertz, si.Hertz] = (15e3, 60e3)


@dataclass(frozen=True, eq=False, repr=False)
class ModeList(Result):
    """The driven modes of a display in a band, ascending, and what follows for the choice of one.

    `working` is the label of the mode that the display asks for, `solved` that mode as every other
    verb has it, where it is driven and in the band; `forbidden` says which symmetry
    keeps its drive from it, `rules` which modes it keeps it from altogether; `frequency_error` is
    the bound on how far a frequency lies off. `pair` is what a ring's one channel makes of the two
    orientations of the working mode. `screened` are a plate's modes with their shapes.
    """

    display: Display
    band: tuple[si.Hertz, si.Hertz]
    modes: tuple[ListedMode, ...]
    working: str
    forbidden: str | None
    rules: tuple[str, ...]
    suggestion: Suggestion
    model: str
    frequency_error: si.Dimensionless
    pair: RingPair | None = None
    screened: tuple[DrivenMode, ...] = ()
    solved: WorkingMode | None = None
    _shown: ClassVar[str] = "display.name band working suggestion.text model"

    @property
    def working_mode(self) -> ListedMode | None:
        """The listed mode that the display asks for, the strongest of several; None without."""
        solved = self.solved
        near = wanted_frequency(self.display.actuator)
        if solved is not None:
            near = solved.resonance_frequency
        return chosen(self.modes, self.working, near)

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values; keys carry units."""
        return {
            "display": self.display.name,
            **values_of(
                self,
                "band working working_mode forbidden rules suggestion pair model frequency_error",
            ),
            "modes": [
                to_json(mode) | values_of(mode, "crowded hidden half_bandwidth")
                for mode in self.modes
            ],
            "working_mode_per_volt": self._solved_summary(),
            "provenance": stamp(self.display),
        }

    def _solved_summary(self) -> dict[str, Any] | None:
        """The display's own mode with all others in, as `predict` and `plate` have it."""
        solved = self.solved
        if solved is None:
            return None
        largest = None if solved.solid is None else solved.solid.largest_per_volt
        return {
            **values_of(solved, "resonance_frequency amplitude_per_volt neighbour model"),
            "largest_per_volt_m_per_V": largest,
            "antinode_m": list(solved.lobe),
        }

    def _table(self) -> Any:
        return to_json(self.modes)


@reads_text
def list_modes(
    display: NamedDisplay,
    band: tuple[si.Hertz, si.Hertz] = DEFAULT_BAND,
    *,
    progress: SayProgress | None = None,
) -> ModeList:
    """The modes of a display's plate, disc or stator in a band (Hz) that its drive can move.

    A plate's modes are screened (see `screened_modes` for range and error), but for the one that
    the display works in, which is solved as every other verb has it. Raises `InputError` for a band
    that is none or has no driven mode, and what the solvers raise.
    """
    tell = progress or (lambda _: None)
    if isinstance(display.actuator, RectangularPlate):
        tell("driven modes on a light mesh")
        return _of_plate(display, display.actuator, band, tell)
    return _of_ring(display, band, tell)


def _of_plate(
    display: Display,
    plate: RectangularPlate,
    band: tuple[si.Hertz, si.Hertz],
    tell: SayProgress,
) -> ModeList:
    driven = driven_modes(screened_modes(plate, band))
    listed = listed_modes(driven)
    label = plate.working_label
    working, forbidden = label_name(label), forbidden_by(plate, label)
    own = chosen(listed, working, wanted_frequency(plate))
    solved = None
    if forbidden is None:
        tell("the display's own mode")
        # It may have no solution in three dimensions, or lie outside of the band.
        with contextlib.suppress(SqueezefilmError):
            mode = working_mode(plate)
            solved = mode if band[0] <= mode.resonance_frequency <= band[1] else None
    if solved is not None:
        listed, own = with_working_mode(listed, solved, plate)
    return ModeList(
        display=display,
        band=band,
        modes=listed,
        working=working,
        forbidden=forbidden,
        rules=_rules(plate),
        suggestion=suggested(listed, own),
        model="piezoelectric_solid_3d, light mesh",
        frequency_error=SCREENING_ERROR,
        screened=tuple(driven),
        solved=solved,
    )


def _rules(plate: RectangularPlate) -> tuple[str, ...]:
    """Rules by which symmetry keeps the drive from modes, along each side where it does."""
    if only_stretches(plate):
        return (
            "No mode of bending is driven: every ceramic has its mirror image on the other face, "
            "with the same sign, which only stretches the plate.",
        )
    said = []
    for axis, side in enumerate(("length", "width")):
        driven = {parity[axis] for parity in drive_classes(plate)}
        if len(driven) == 1 and None not in driven:
            odd, even = ("odd", "even") if driven == {"S"} else ("even", "odd")
            alike = "alike" if driven == {"S"} else "opposite"
            said.append(
                f"No mode with an {odd} number of nodal lines across the {side} is driven: the "
                f"ceramics' signs are {alike} on its two halves, which drives {even} numbers."
            )
    return tuple(said)


def _of_ring(
    display: Display,
    band: tuple[si.Hertz, si.Hertz],
    tell: SayProgress,
) -> ModeList:
    tell("section")
    body = ring_body(display.actuator)
    working = body.mode()
    # To choose a mode by, elements of one degree less will do.
    modes = modes_in_band(body, band, tell, degree=DEFAULT_DEGREE - 1)
    capacitance = clamped_capacitance(body.section, body.drive)
    rows = [mode_row(body, mode, capacitance) for mode in modes]
    strongest = max(row.alone_per_volt for row in rows)
    listed = with_neighbours(
        [
            ListedMode(
                label=row.label,
                frequency=row.frequency,
                quality_factor=row.quality_factor,
                alone_per_volt=row.alone_per_volt,
                symmetry="alike all round" if mode.harmonic == 0 else "one of a pair",
                audible=row.frequency < HEARING,
                choice=None
                if isinstance(display.actuator, AnnularStator) or row.label[0] != "B"
                else f"nodal_circles = {row.label[2:].split(',')[0]}, nodal_diameters = "
                f"{mode.harmonic}",
            )
            for mode, row in zip(modes, rows, strict=True)
            if row.alone_per_volt >= DRIVEN_SHARE * strongest
        ]
    )
    tell("the working mode's pair")
    return ModeList(
        display=display,
        band=band,
        modes=listed,
        working=working.label,
        forbidden=None
        if body.drives(working)
        else f"the channel's sectors do not drive {working.label}: over them its waves cancel",
        rules=(),
        suggestion=suggested(listed, chosen(listed, working.label))
        if not isinstance(display.actuator, AnnularStator)
        else Suggestion(None, "A stator works in the mode that was measured of it."),
        model=working.model + (", fitted stator" if body.fit is not None else ""),
        frequency_error=largest_error(rows),
        pair=ring_pair(display, body, working) if working.harmonic else None,
    )
