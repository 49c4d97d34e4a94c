"""Named fingers, each value with where it is from. Most of it is assumed: see `evidence`.

`evidence` maps a field of `Finger` to "kind: source", kind being published, derived or assumed, as
in the presets of displays. Fields not named there have the defaults of `Finger`, all assumed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from squeezefilm.contact.finger.fingertip import Finger

_PAPER = "published: Biet, Giraud and Lemaire-Semail, Table 1"


@dataclass(frozen=True)
class FingerPreset:
    """A finger, what it stands for, and the evidence for each of its values."""

    name: str
    title: str
    finger: Finger
    evidence: Mapping[str, str]


def _preset(name: str, title: str, finger: Finger, **evidence: str) -> FingerPreset:
    return FingerPreset(name, title, finger, MappingProxyType(evidence))


_ALL = (
    _preset(
        "biet2008",
        "the finger of the paper, resting with a fixed area",
        Finger(10e-3, 50e-6, 350e-6, 0.5),
        contact_length=_PAPER,
        ridge_amplitude=_PAPER + " (half of 100 µm)",
        ridge_period=_PAPER,
        normal_force="published: the paper, section 2.3.1, mean of 0.3 to 0.7 N",
        plateau_width="assumed: 150 to 350 µm are reported, illustrative",
        asperities="assumed: 5 kPa at 2 µm, falling by e in 0.6 µm, illustrative",
    ),
    _preset(
        "exploring",
        "a finger exploring a surface, its area growing with the load",
        Finger(
            10e-3, 50e-6, 450e-6, 0.49, plateau_width=270e-6,
            contact_area_exponent=0.4, contact_area_force=0.5,
        ),
        contact_length="assumed: 1 cm² at 0.5 N",
        ridge_amplitude="assumed: as the paper's",
        ridge_period="assumed: 0.4 to 0.5 mm in adults, from memory",
        plateau_width="assumed: 0.6 of the period",
        normal_force="published: Smith, Gosselin and Houde 2002, s00221-002-1240-4",
        contact_area_exponent="assumed: between a Hertz sphere (2/3) and a saturated pad (0)",
    ),
    _preset(
        "small",
        "a small finger: a child's or a light touch with the tip",
        Finger(
            6e-3, 40e-6, 350e-6, 0.2, plateau_width=200e-6,
            contact_area_exponent=0.4, contact_area_force=0.2,
        ),
        contact_length="assumed",
        ridge_amplitude="assumed",
        ridge_period="assumed",
        plateau_width="assumed",
        normal_force="assumed",
        contact_area_exponent="assumed",
    ),
    _preset(
        "dry",
        "the paper's finger with dry skin",
        Finger(10e-3, 50e-6, 350e-6, 0.5, moisture="dry"),
        moisture="assumed: twice as stiff, 0.6 of the friction",
    ),
    _preset(
        "moist",
        "the paper's finger with moist skin",
        Finger(10e-3, 50e-6, 350e-6, 0.5, moisture="moist"),
        moisture="assumed: 0.4 of the stiffness, 1.8 times the friction",
    ),
    _preset(
        "lengthwise",
        "the paper's finger with its ridges along the wave",
        Finger(10e-3, 50e-6, 350e-6, 0.5, ridge_angle=math.pi / 2),
        ridge_angle="assumed: near the tip ridges arch, so that all angles occur in one pad",
    ),
)  # fmt: skip

FINGERS: Mapping[str, FingerPreset] = MappingProxyType({item.name: item for item in _ALL})
