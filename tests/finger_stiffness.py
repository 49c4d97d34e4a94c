"""A finger's stiffness: the interface as compiled, and the skin in series with it."""

from __future__ import annotations

from squeezefilm.core.materials import Gas
from squeezefilm.physics.contact.finger.fingertip import Skin
from squeezefilm.physics.contact.finger.load import between, compiled_finger
from squeezefilm.physics.contact.rough_contact import ContactLaw


def interface_stiffness(
    gap: float, swing: float, width: float, frequency: float, gas: Gas, asperities: ContactLaw
) -> complex:
    """Film and asperities between plate and plateau, per area (Pa/m)."""
    finger = compiled_finger(width, frequency, gas, Skin(), 1.0)
    return complex(between(gap, swing, finger, asperities.compiled()))


def finger_stiffness(interface: complex, skin: Skin, frequency: float, share: float) -> complex:
    """Interface and skin in series on the plateaus' share of the contact, per area (Pa/m)."""
    behind = skin.dynamic_stiffness(frequency)
    return share * interface * behind / (interface + behind)
