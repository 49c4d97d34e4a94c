"""The materials and sheets that a search may build from, by name and by thickness."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Annotated, ClassVar

from squeezefilm.core import config, presets
from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.config.references import References
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.core.presets.materials import Kind
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate

OWN = "as described"
"""In place of a material's name: that of the display which the search starts from."""


@si.checked_numbers
@dataclass(frozen=True)
class Sheet:
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
class _Substrate:
    part: ElasticMaterial
    references: ClassVar[References] = References(
        original=lambda name: None,
        parts={"part": functools.partial(presets.materials.table, kind="substrate")},
    )


@dataclass(frozen=True)
class _Ceramic:
    part: Piezoceramic
    references: ClassVar[References] = References(
        original=lambda name: None,
        parts={"part": functools.partial(presets.materials.table, kind="ceramic")},
    )


def substrate_named(name: str, own: RectangularPlate | DiscPlate) -> ElasticMaterial:
    """The substrate of a name in the library, or that of `own` for "as described".

    Raises `InputError` for a name that is not known.
    """
    return own.substrate if name == OWN else _substrate(name)


def ceramic_named(name: str, own: RectangularPlate | DiscPlate) -> Piezoceramic:
    """The ceramic of a name in the library, or that of `own` for "as described".

    Raises `InputError` for a name that is not known.
    """
    return own.ceramic if name == OWN else _ceramic(name)


@functools.cache
def _substrate(name: str) -> ElasticMaterial:
    return config.load_text(_Substrate, _named(name, "substrate")).part


@functools.cache
def _ceramic(name: str) -> Piezoceramic:
    return config.load_text(_Ceramic, _named(name, "ceramic")).part


def _named(name: str, kind: Kind) -> str:
    return f'[part]\nmaterial = "{presets.materials.named(name, kind).name}"\n'


def require_known(name: str, kind: Kind) -> None:
    """Refuse a material that is not in the library, before anything is computed. Raises
    `InputError` as `core.presets.materials.named` does."""
    if name != OWN:
        try:
            presets.materials.named(name, kind)
        except InputError as error:
            raise InputError(f'{error}; or write "{OWN}"', quantity="material") from error
