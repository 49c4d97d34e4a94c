"""A skin-stretch array as a file describes it: a name, its table and where each value is from."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from squeezefilm.actuators.skin_stretch.array import SkinStretchArray
from squeezefilm.core import presets
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.config.references import References
from squeezefilm.core.results import Result


@dataclass(frozen=True, repr=False)
class SkinStretchDescription(Result):
    """What a file with the table ``[skin_stretch]`` says; read one with `described.load_actuator`.

    Ceramic, shim and electrode may be named as materials of the library.
    """

    references: ClassVar[References] = References(
        original=lambda name: _preset(name),
        parts={
            "skin_stretch.actuator.ceramic": functools.partial(
                presets.materials.table, kind="ceramic"
            ),
            "skin_stretch.actuator.shim": functools.partial(
                presets.materials.table, kind="substrate"
            ),
            "skin_stretch.actuator.electrode": functools.partial(
                presets.materials.table, kind="substrate"
            ),
        },
    )

    name: str
    title: str
    skin_stretch: SkinStretchArray
    provenance: Mapping[str, Provenance] = field(
        default_factory=dict, metadata={"loader": True}, compare=False, repr=False
    )
    _shown: ClassVar[str] = "name title skin_stretch.cradle.count skin_stretch.normal_force"


def _preset(name: str) -> SkinStretchDescription:
    from squeezefilm.core import config

    return config.load(SkinStretchDescription, presets.resolve_actuator(name))
