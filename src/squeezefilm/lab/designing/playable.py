"""Whether a device may be asked to play: checked before anything is connected or started."""

from __future__ import annotations

from squeezefilm.core import quantities as si
from squeezefilm.lab.designing.form import display_of
from squeezefilm.lab.designing.numbers import WorkingPoint, predicted
from squeezefilm.physics.chain.played_texture import FingerMotion, require_on_display
from squeezefilm.physics.texture_files.trajectories import motion_from

LONGEST: si.Second = 86_400.0
"""For one session."""


def require_playable(
    text: str, drive: str, duration: str, voltage: str | None, stroke: str
) -> tuple[si.Second, si.Volt | None]:
    """The duration (s) and the most voltage (V; None: the display's own) that were typed.

    `text` is a display's, `drive` "twin" or a port, `stroke` what a twin's finger does, in words.
    Raises `InputError` for what is no such quantity, a voltage above the display's limits, or a
    finger that leaves the display; `ConfigError` for a text that is no display.
    """
    lasts = si.parse_quantity(duration, si.Unit("s"))
    most = None if voltage is None else si.parse_quantity(voltage, si.Unit("V"))
    si.require("duration", lasts, si.Unit("s"), above=0.0, at_most=LONGEST)
    if most is not None:
        si.require("voltage", most, si.Unit("V"), above=0.0)
    display = display_of(text)
    p = predicted(display, "screening", WorkingPoint(text, voltage=voltage))
    if p.voltage is not None:
        display.limits(p.frequency, p.voltage, twin=drive == "twin")
    if drive == "twin":
        require_on_display(display.actuator, FingerMotion.of(motion_from(stroke), 1e3))
    return lasts, most
