"""The laws of slip at the walls, by name and by the numbers that compiled code knows them by.

`closed.flow_factor` is what they compute, `slip_kernel` the same for compiled code.
"""

from __future__ import annotations

from squeezefilm import quantities as si
from squeezefilm.errors import InputError

NO_SLIP, FIRST, SECOND, FUKUI_KANEKO, VEIJOLA = range(5)

SLIP_LAWS = {
    "first": FIRST,
    "second": SECOND,
    "fukui-kaneko": FUKUI_KANEKO,
    "veijola": VEIJOLA,
}
"""The names users write, and the numbers the compiled code knows them by."""


def slip_law(slip: str, knudsen_number: float) -> int:
    """The number of a slip law; `NO_SLIP` where the Knudsen number is zero.

    Raises `InputError` for an unknown name or a Knudsen number that is negative or not finite.
    """
    si.require("knudsen_number", knudsen_number, at_least=0.0)
    if slip not in SLIP_LAWS:
        raise InputError(
            f"slip = '{slip}' is no slip law.{si.did_you_mean(slip, SLIP_LAWS)} "
            f"Use one of {', '.join(SLIP_LAWS)}"
        )
    return SLIP_LAWS[slip] if knudsen_number > 0.0 else NO_SLIP
