"""What is written down about a session before it starts: room, skin, finger, noise, consent."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm import quantities as si
from squeezefilm.errors import InputError

_LONGEST_TEXT = 200


@si.checked_numbers
@dataclass(frozen=True)
class SessionConditions:
    """The conditions of one sitting. What was not measured stays None; nothing is guessed.

    No field asks for anything that names a person, and none must be filled with it: these texts
    are exported.

    Args:
        consent: whether the participant consented; a session does not start without.
        consent_form: which text they consented to, like "v3, 2026-10".
        room: what matters of the place, like "anechoic chamber"; not an address.
        temperature: of the room (K).
        relative_humidity: of the room (1).
        skin_moisture: as the instrument reads it, and `skin_moisture_method` which that is.
        hand, finger: that explore.
        finger_orientation: angle of the finger's axis from the stroke (rad); the source paper found
            the felt intensity to depend on it, so keep it the same.
        normal_force_asked: what participants were asked to press with (N).
        masking_noise: what they heard, like "pink noise, 65 dB(A), headphones"; empty for none.
        note: anything else, without names.

    Raises:
        InputError: a value outside its range or a text of more than 200 characters.
    """

    consent: bool
    consent_form: str = ""
    room: str = ""
    temperature: Annotated[si.Kelvin, si.AtLeast(253), si.AtMost(333)] | None = None
    relative_humidity: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(1)] | None = None
    skin_moisture: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(1e6)] | None = None
    skin_moisture_method: str = ""
    hand: Literal["", "left", "right"] = ""
    finger: Literal["", "thumb", "index", "middle", "ring", "little"] = ""
    finger_orientation: Annotated[si.Radian, si.AtLeast(-6.3), si.AtMost(6.3)] | None = None
    normal_force_asked: Annotated[si.Newton, si.AtLeast(0), si.AtMost(50)] | None = None
    masking_noise: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        for name in ("consent_form", "room", "skin_moisture_method", "masking_noise", "note"):
            if len(getattr(self, name)) > _LONGEST_TEXT:
                raise InputError(
                    f"{name} has {len(getattr(self, name))} characters; at most {_LONGEST_TEXT}",
                    quantity=name,
                )
        if self.skin_moisture is not None and not self.skin_moisture_method:
            raise InputError(
                "skin_moisture is given without skin_moisture_method; name the instrument and its "
                "unit, like 'Corneometer CM 825, arbitrary units'",
                quantity="skin_moisture_method",
            )

    def require_consent(self) -> None:
        """Refuse to go on without consent. Raises `InputError`."""
        if not self.consent:
            raise InputError(
                "consent = false: a session starts only after the participant has consented; "
                "record it with consent = true",
                quantity="consent",
            )
