"""What may be asked of a device, known before it is connected."""

from __future__ import annotations

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.lab.designing.form import preset_text
from squeezefilm.lab.designing.program import require_playable

PLATE = preset_text("biet2008-plate")
STROKE = "60 mm/s over 4 cm"


def test_what_can_be_played_is_read() -> None:
    assert require_playable(PLATE, "twin", "10 s", None, STROKE) == (10.0, None)
    assert require_playable(PLATE, "twin", "500 ms", "12 V", STROKE) == (0.5, 12.0)
    # A device has a finger of its own.
    assert require_playable(PLATE, "serial:X", "10 s", None, "fast") == (10.0, None)


@pytest.mark.parametrize(
    ("duration", "voltage", "stroke", "says"),
    [
        ("10", None, STROKE, "'10' has no unit"),
        ("0 s", None, STROKE, "duration = 0 s cannot be used"),
        ("25 h", None, STROKE, "at most 86.4 ks"),
        ("10 s", "-1 V", STROKE, "voltage = -1 V cannot be used"),
        ("10 s", "16 V", STROKE, "voltage = 16 V cannot be used"),
        ("10 s", None, "fast", "'fast' is no stroke"),
        ("10 s", None, "60 mm/s over 4 m", "the surface has 83 mm"),
    ],
)
def test_what_cannot_is_refused(duration: str, voltage: str | None, stroke: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        require_playable(PLATE, "twin", duration, voltage, stroke)
