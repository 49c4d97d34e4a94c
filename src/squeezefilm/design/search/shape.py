"""What all shapes of a search have in common: the room that they fill and the stock that they are
built from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.design.search.space import Choice, Setting, Variable, step
from squeezefilm.design.search.stock import CeramicStock, Sheet, require_known
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate

Body = RectangularPlate | DiscPlate

CUT: si.Metre = 1e-4
"""Ceramics are cut to whole multiples of this."""


@dataclass(frozen=True)
class Room:
    """What a plate must give and may take, along its length and across (m)."""

    least: tuple[si.Metre, si.Metre]
    most: tuple[si.Metre, si.Metre]


@dataclass(frozen=True)
class Shape:
    """What all shapes have: sheets and ceramics to build from.

    Raises `InputError` for stock that is not there, named twice, or not in the library.
    """

    sheets: tuple[Sheet, ...]
    ceramics: tuple[CeramicStock, ...]

    def __post_init__(self) -> None:
        for name, stock in (("sheets", self.sheets), ("ceramics", self.ceramics)):
            if not stock:
                raise InputError(f"{name} is empty; give at least one to build from", quantity=name)
            names = [one.material for one in stock]
            if len(set(names)) < len(names):
                raise InputError(
                    f"{name} names a material twice ({', '.join(names)}); give all its "
                    "thicknesses in one table",
                    quantity=name,
                )
        for sheet in self.sheets:
            require_known(sheet.material, "substrate")
        for ceramic in self.ceramics:
            require_known(ceramic.material, "ceramic")

    def stock(self) -> tuple[Variable, ...]:
        """Material and thickness of the sheet and of the ceramic."""
        sheets = {one.material: one.thicknesses for one in self.sheets}
        ceramics = {one.material: one.thicknesses for one in self.ceramics}
        return (
            Choice("substrate", tuple(sheets)),
            step("thickness", sheets, "m", "substrate"),
            Choice("ceramic", tuple(ceramics)),
            step("ceramic_thickness", ceramics, "m", "ceramic"),
        )

    @property
    def catalogue(self) -> Mapping[str, tuple[si.Metre, ...]] | None:
        """The lengths that ceramics are sold in; None where pieces are cut to size.

        Raises `InputError` where some have lengths and others have none.
        """
        lengths = {one.material: one.lengths for one in self.ceramics}
        if not any(lengths.values()):
            return None
        if not all(lengths.values()):
            raise InputError(
                "some ceramics have lengths and others have none; give lengths for all of a shape, "
                "or for none to cut them to size",
                quantity="lengths",
            )
        return lengths

    def cost_class(self, values: Mapping[str, Setting]) -> int:
        """The highest class of cost of what a design is built from."""
        sheet = next(one for one in self.sheets if one.material == values["substrate"])
        ceramic = next(one for one in self.ceramics if one.material == values["ceramic"])
        return max(sheet.cost_class, ceramic.cost_class)


def counts(name: str, least: int, most: int) -> Variable:
    """A count that may be chosen. Raises `InputError` where its range ends before it begins."""
    if most < least:
        raise InputError(
            f"{name} may be from {least} to {most}, which is no range; make most at least least",
            quantity=f"most_{name}",
        )
    return step(name, {"": tuple(float(one) for one in range(least, most + 1))}, "1")
