"""The stock that a search may build from, and what all shapes built of it have in common."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

from squeezefilm.core import config, presets
from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance, References
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.core.presets.materials import Kind
from squeezefilm.design.search.space import Choice, Setting, Variable, step
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate

OWN = "as described"
"""Word in place of a material's name: that of the display which the search starts from."""


@si.checked_numbers
@dataclass(frozen=True)
class StockSheet:
    """A substrate in the thicknesses (m) in which it is sold, with a class of cost (1 is cheap;
    the file's own judgement)."""

    material: str
    thicknesses: tuple[Annotated[si.Metre, hard.LAYER], ...]
    cost_class: Annotated[int, si.AtLeast(1), si.AtMost(9)] = 1


@si.checked_numbers
@dataclass(frozen=True)
class CeramicStock:
    """A ceramic in the thicknesses (m) in which it is sold.

    `lengths` (m) are those of a catalogue along the wave, or the diameters of discs; without any,
    pieces are cut to size.
    """

    material: str
    thicknesses: tuple[Annotated[si.Metre, hard.LAYER], ...]
    lengths: tuple[Annotated[si.Metre, hard.SIDE], ...] = ()
    cost_class: Annotated[int, si.AtLeast(1), si.AtMost(9)] = 1


@dataclass(frozen=True)
class _Library:
    """A material by its kind, as a file that names it has it, and where its values are from."""

    substrate: ElasticMaterial | None = None
    ceramic: Piezoceramic | None = None
    provenance: Mapping[str, Provenance] = field(default_factory=dict, metadata={"loader": True})
    references: ClassVar[References] = References(
        original=lambda name: None,
        parts={
            kind: functools.partial(presets.materials.table, kind=kind)
            for kind in ("substrate", "ceramic")
        },
    )


@functools.cache
def of_library(name: str, kind: Kind) -> _Library:
    """The library's material of a name and kind, with its sources. Raises as `material_named`."""
    named = presets.materials.named(name, kind).name
    return config.load_text(_Library, f'[{kind}]\nmaterial = "{named}"\n')


def material_named(name: str, kind: Kind, own: RectangularPlate | DiscPlate) -> Any:
    """The material of a name and kind in the library, or that of `own` for "as described".

    Raises `InputError` for a name that is not known.
    """
    return getattr(own if name == OWN else of_library(name, kind), kind)


def require_known(name: str, kind: Kind) -> None:
    """Refuse a material that is not in the library, before anything is computed. Raises
    `InputError` as `core.presets.materials.named` does."""
    if name != OWN:
        try:
            presets.materials.named(name, kind)
        except InputError as error:
            raise InputError(f'{error}; or write "{OWN}"', quantity="material") from error


Body = RectangularPlate | DiscPlate

CUT: si.Metre = 5e-5
"""Ceramics are cut and placed to whole multiples of this."""
_CUTS_PER_METRE = 20_000


def cut_to_step(length: si.Metre) -> si.Metre:
    """The whole multiple of `CUT` that is nearest to a length (m)."""
    return round(length * _CUTS_PER_METRE) / _CUTS_PER_METRE


def as_drawn(length: si.Metre) -> si.Metre:
    """A length (m) that follows from others, without the last digits of their difference."""
    return round(length, 9)


@dataclass(frozen=True)
class PlateRoom:
    """Room that a plate must give and may take, along its length and across (m)."""

    least: tuple[si.Metre, si.Metre]
    most: tuple[si.Metre, si.Metre]


@dataclass(frozen=True)
class Shape:
    """Base of all shapes: sheets and ceramics to build from.

    Raises `InputError` for stock that is not there, named twice, or not in the library.
    """

    sheets: tuple[StockSheet, ...]
    ceramics: tuple[CeramicStock, ...]

    def __post_init__(self) -> None:
        for name, stock in (("sheets", self.sheets), ("ceramics", self.ceramics)):
            if not stock:
                raise InputError(f"{name} is empty; give at least one to build from", quantity=name)
            names = [piece.material for piece in stock]
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
        sheets = {sheet.material: sheet.thicknesses for sheet in self.sheets}
        ceramics = {ceramic.material: ceramic.thicknesses for ceramic in self.ceramics}
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
        lengths = {ceramic.material: ceramic.lengths for ceramic in self.ceramics}
        if not any(lengths.values()):
            return None
        if not all(lengths.values()):
            raise InputError(
                "some ceramics have lengths and others have none; give lengths for all of a shape, "
                "or for none to cut them to size",
                quantity="lengths",
            )
        return lengths

    def common(
        self, values: Mapping[str, Setting], own: Body, quality: si.Dimensionless
    ) -> dict[str, Any]:
        """Values that the bodies of all shapes have: thickness, quality factor and materials."""
        return {
            "thickness": float(values["thickness"]),
            "quality_factor": quality,
            "substrate": material_named(str(values["substrate"]), "substrate", own),
            "ceramic": material_named(str(values["ceramic"]), "ceramic", own),
        }

    def cost_class(self, values: Mapping[str, Setting]) -> int:
        """The highest class of cost of what a design is built from."""
        sheet = next(piece for piece in self.sheets if piece.material == values["substrate"])
        ceramic = next(piece for piece in self.ceramics if piece.material == values["ceramic"])
        return max(sheet.cost_class, ceramic.cost_class)


def counts(name: str, least: int, most: int) -> Variable:
    """A count that may be chosen, from the least to the most."""
    return step(name, {"": tuple(float(count) for count in range(least, most + 1))}, "1")
