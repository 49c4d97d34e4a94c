"""Where ceramics end on a plate that was made longer or wider."""

from __future__ import annotations

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.lab.designing.form import covered, display_of, edited, preset_text, stretched
from squeezefilm.physics.plate.layout import RectangularPlate

PLATE = preset_text("biet2008-plate")


def plate_of(text: str) -> RectangularPlate:
    actuator = display_of(text).actuator
    assert isinstance(actuator, RectangularPlate)
    return actuator


def test_a_plate_that_was_made_longer_says_where_its_ceramics_end() -> None:
    assert covered(plate_of(PLATE)) == {}
    longer = edited(PLATE, "actuator.length", "100 mm")
    assert covered(plate_of(longer)) == {
        "actuator.length": "the ceramics cover x = 0 m to 83 mm of 100 mm"
    }
    assert list(covered(plate_of(edited(longer, "actuator.width", "60 mm")))) == [
        "actuator.length", "actuator.width",
    ]  # fmt: skip
    assert covered(display_of(preset_text("winfield2007-tpad")).actuator) == {}


@pytest.mark.parametrize(("side", "value"), [("length", "100 mm"), ("width", "0.0537 m")])
def test_stretched_ceramics_cover_the_plate_with_their_gaps_in_proportion(
    side: str, value: str
) -> None:
    before = plate_of(PLATE)
    text = edited(PLATE, f"actuator.{side}", value)
    after = plate_of(stretched(text, f"actuator.{side}"))
    assert covered(after) == {}
    scale = getattr(after, side) / getattr(before, side)
    axis = "x" if side == "length" else "y"
    for old, new in zip(before.patches, after.patches, strict=True):
        for name in (axis, side):
            assert getattr(new, name) == pytest.approx(scale * getattr(old, name), rel=1e-7)
        assert new.polarity == old.polarity


def test_only_ceramics_along_a_side_can_be_stretched() -> None:
    for text, path in (
        (PLATE, "actuator.thickness"),
        (preset_text("winfield2007-tpad"), "actuator.length"),
    ):
        with pytest.raises(InputError, match="no ceramics to stretch"):
            stretched(text, path)
