"""The drawing of any display: which sheet it gets, and the notes that all sheets have."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from squeezefilm.core.formats.drawing import Drawing
from squeezefilm.core.kit.numbers import HZ, shown
from squeezefilm.design.fabrication.report.rectangular_sheet import rectangular_sheet
from squeezefilm.design.fabrication.report.round_sheet import round_sheet
from squeezefilm.design.fabrication.wiring import ANTIPHASE
from squeezefilm.physics.plate.layout import RectangularPlate

if TYPE_CHECKING:
    from squeezefilm.design.fabrication.fabricate import Fabrication


def drawing_sheet(made: Fabrication) -> Drawing:
    """The dimensioned drawing of a display, an A3 sheet."""
    common = tuple(_common(made))
    if isinstance(made.display.actuator, RectangularPlate):
        return rectangular_sheet(made, common)
    return round_sheet(made, common)


def _common(made: Fabrication) -> Iterable[str]:
    """What a workshop must know of every display."""
    groups = {electrode.connection for electrode in made.electrodes}
    if ANTIPHASE in groups:
        yield "A is driven with +V, B with −V. The bonded side of every ceramic is ground."
    else:
        yield "A is driven with +V. The bonded side of every ceramic is ground."
    yield (
        "Poling: a circle with a dot points away from the plate, one with a cross towards it. "
        "Electrodes cover both faces of a ceramic."
    )
    nodal, mode = made.nodal, made.prediction.mode
    if nodal.positions or nodal.radii or nodal.angles:
        said = (
            f"Dash-dotted: nodal lines of {mode.label} at {shown(mode.resonance_frequency, HZ)}, "
            "as computed: where it may be held."
        )
        if nodal.positions:
            said += " They are drawn straight, from where they cross the middle."
        yield said
    yield _tolerances(made)
    evidence = [one.evidence for one in made.display.provenance.values()]
    if assumed := sum(one == "assumed" for one in evidence):
        yield (
            f"{assumed} of {len(evidence)} values of the description are assumed: index.html "
            "lists them. Check them before anything is cut."
        )


def _tolerances(made: Fabrication) -> str:
    given = [
        path
        for path, one in made.display.provenance.items()
        if one.distribution is not None and path.startswith("actuator.")
    ]
    if not given:
        return (
            "The description states no tolerance. Agree on tolerances with the workshop: "
            "index.html has what each value is taken to be off by in the expected numbers."
        )
    return (
        "Tolerances stand behind a number where the description states them (± is two standard "
        "deviations); none is stated for the others."
    )
