"""What the Feel area answers, and which files it writes."""

from __future__ import annotations

import base64
import csv
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from pydantic import ValidationError
from tests.pictures import coloured_bytes, picture_bytes
from tests.unit.lab.areas.too_long import require_refused_if_longer

from squeezefilm.core import presets
from squeezefilm.core.errors import SqueezefilmWarning
from squeezefilm.lab.areas.feel import (
    COLUMNS,
    FeelArea,
)
from squeezefilm.lab.designing.form import preset_text
from squeezefilm.physics.texture_files.texture_file import load_texture, texture_from_text

if TYPE_CHECKING:
    from .conftest import Talk

STATOR = preset_text("biet2008-stator")
SINE = presets.resolve("sine-3mm", "texture").read_text(encoding="utf-8")
# Black but for the pixel in the middle.
PICTURE = base64.b64encode(picture_bytes(np.eye(15)[7].reshape(3, 5))).decode()


@pytest.fixture
def lab(talk: Talk) -> Talk:
    FeelArea(talk.lab)
    return talk


def test_textures_are_listed_with_their_titles_and_what_was_saved(lab: Talk) -> None:
    found = lab.say("textures")
    assert found["type"] == "textures"
    assert [one["name"] for one in found["presets"]] == list(presets.texture_names())
    assert {"name": "bump", "title": "A bump"} in found["presets"]
    assert found["saved"] == []
    for name in ("two", "one"):
        assert lab.say("save texture", name=name, text=SINE) == {
            "type": "saved", "file": f"textures/{name}.toml",
        }  # fmt: skip
    assert lab.say("textures")["saved"] == ["one", "two"]
    assert lab.say("texture text", file="two") == {"type": "texture text", "text": SINE}


def test_a_texture_is_saved_once_and_only_if_it_is_one(lab: Talk) -> None:
    assert "low" in lab.refused("save texture", name="one", text=SINE.replace("low", "lowest"))
    assert lab.say("textures")["saved"] == []
    lab.say("save texture", name="one", text=SINE)
    assert "one.toml exists" in lab.refused("save texture", name="one", text=SINE + "\n")
    assert (lab.folder / "textures" / "one.toml").read_text(encoding="utf-8") == SINE


def test_the_text_is_a_presets_or_a_saved_files(lab: Talk) -> None:
    assert lab.say("texture text", preset="sine-3mm")["text"] == SINE
    for both in ({}, {"preset": "bump", "file": "one"}):
        assert "a preset or a saved file, one of them" in lab.refused("texture text", **both)
    assert "there is no file one.toml" in lab.refused("texture text", file="one")
    # No other file of this computer is read by way of a preset's name.
    other = lab.folder / "other.toml"
    other.write_text(SINE)
    said = lab.refused("texture text", preset=str(other)[:100])
    assert said == f"'{str(other)[:100]}' is no preset texture"


@pytest.mark.parametrize("kind", ["feel", "parity"])
def test_a_texture_is_computed_where_it_holds_up_nobody(lab: Talk, kind: str) -> None:
    question = "load texture" if kind == "feel" else kind
    found = lab.say(question, display=STATOR, preset="sine-3mm")
    assert found["type"] == kind
    assert found["display"] == "biet2008-stator"
    assert lab.say(question, display=STATOR, texture=SINE, quality="screening")["type"] == kind
    solved = lab.say(question, display=STATOR, texture=SINE, quality="solved")
    assert solved["amplitude_m"] == found["amplitude_m"]
    quick, slow = ("quick", kind, kind, True), ("slow", kind, kind, True)
    assert lab.asked == [quick, quick, slow]


def test_a_saved_picture_is_found_by_the_texture_that_names_it(lab: Talk) -> None:
    found = lab.say("add picture", name="islands.png", data=PICTURE, pixel="2 mm")
    assert found["type"] == "texture text"
    file = lab.folder / "textures" / "islands.png"
    assert file.read_bytes() == base64.b64decode(PICTURE)
    read = texture_from_text(found["text"], file=file)
    assert read.title == "islands, 5 × 3 pixels of 2 mm"
    assert read.texture.quantity == "relative_friction"
    # Black is slippery, as is what lies outside.
    for x, friction in ((5e-3, 1.0), (1e-3, 0.6), (-5e-3, 0.6)):
        assert float(read.texture(x, 3e-3, 0.1, 0.0)) == pytest.approx(friction)
    assert lab.say("load texture", display=STATOR, texture=found["text"])["type"] == "feel"
    again = lab.refused("add picture", name="islands", data=PICTURE, pixel="2 mm")
    assert "islands.png exists" in again


def test_pixels_have_from_a_micrometre_to_ten_centimetres(lab: Talk) -> None:
    for number, pixel in enumerate(("1 um", "10 cm")):
        made = lab.say("add picture", name=f"p{number}", data=PICTURE, pixel=pixel)
        assert f'pixel = "{pixel}"' in made["text"]
    for pixel in ("0.99 um", "101 mm"):
        said = lab.refused("add picture", name="p", data=PICTURE, pixel=pixel)
        assert said == f"a pixel of {pixel}: it may have 1 µm to 10 cm"
    assert "p.png" not in {one.name for one in (lab.folder / "textures").iterdir()}


def test_what_is_no_picture_leaves_no_file(lab: Talk) -> None:
    bad = {"name": "p", "pixel": "1 mm"}
    assert "no base64; drop it again" in lab.refused("add picture", data="R0lG!", **bad)
    word = base64.b64encode(b"GIF89a").decode()
    assert "p is no PNG" in lab.refused("add picture", data=word, **bad)
    assert "no quantity" in lab.refused("add picture", name="p", data=PICTURE, pixel="wide")
    assert "is no name for a file" in lab.refused(
        "add picture", name="../p", data=PICTURE, pixel="1 mm"
    )
    assert list(lab.folder.iterdir()) == []


def test_what_has_the_name_already_is_replaced_where_that_was_asked_for(lab: Talk) -> None:
    lab.say("save texture", name="one", text=SINE)
    lab.say("save texture", name="one", text=SINE + "\n", replace=True)
    folder = lab.folder / "textures"
    assert (folder / "one.toml").read_text(encoding="utf-8") == SINE + "\n"
    other = picture_bytes(np.zeros((2, 2)))
    given = {"name": "p", "pixel": "1 mm"}
    lab.say("add picture", data=PICTURE, **given)
    lab.say("add picture", data=base64.b64encode(other).decode(), replace=True, **given)
    assert (folder / "p.png").read_bytes() == other
    lab.say("save stroke", name="s", rows=[[0.0] * 8])
    lab.say("save stroke", name="s", rows=[], replace=True)
    assert (lab.folder / "strokes" / "s.felt.csv").read_text().split() == [",".join(COLUMNS)]


def test_a_picture_in_colour_is_taken_and_its_brightness_used(lab: Talk) -> None:
    data = coloured_bytes(np.ones((2, 3, 3)), "JPEG")
    sent = base64.b64encode(data).decode()
    # A process that computes says nothing of it a second time, when the texture is read.
    with pytest.warns(SqueezefilmWarning, match="in colour"):
        found = lab.say("add picture", name="photo", data=sent, pixel="1 mm")
    assert found["note"].startswith("photo is in colour: of each pixel the brightness is used")
    assert (lab.folder / "textures" / "photo.jpg").read_bytes() == data
    assert 'file = "photo.jpg"' in found["text"]
    assert lab.say("add picture", name="grey", data=PICTURE, pixel="1 mm")["note"] == ""


def test_what_is_wrong_with_a_texture_is_said_of_its_field_and_of_no_file(lab: Talk) -> None:
    said = lab.refused("load texture", display=STATOR, texture=SINE.replace("1.0", "1.5"))
    assert said.startswith("line ")
    assert "texture.toml" not in said


def test_a_stroke_is_its_motion_and_what_was_felt_lies_beside_it(lab: Talk) -> None:
    rows = [[k + 0.125 * column for column in range(8)] for k in range(3)]
    assert lab.say("save stroke", name="swipe", rows=rows) == {
        "type": "saved", "file": "strokes/swipe.csv",
    }  # fmt: skip
    folder = lab.folder / "strokes"
    for name, width in (("swipe.csv", 3), ("swipe.felt.csv", 8)):
        with (folder / name).open(newline="") as file:
            head, *lines = csv.reader(file)
        assert head == list(COLUMNS[:width])
        assert [[float(one) for one in line] for line in lines] == [row[:width] for row in rows]
    assert COLUMNS[:3] == ("time_s", "x_m", "y_m")
    lab.say("save stroke", name="empty", rows=[])
    assert (folder / "empty.felt.csv").read_text().split() == [",".join(COLUMNS)]
    # Neither is overwritten, also where only one of them is there.
    assert "swipe.csv exists" in lab.refused("save stroke", name="swipe", rows=[])
    (folder / "other.felt.csv").write_text("mine")
    assert "other.felt.csv exists" in lab.refused("save stroke", name="other", rows=rows)
    assert {one.name for one in folder.iterdir()} == {
        "swipe.csv", "swipe.felt.csv", "empty.csv", "empty.felt.csv", "other.felt.csv",
    }  # fmt: skip
    assert (folder / "other.felt.csv").read_text() == "mine"
    assert "rows.0" in lab.refused("save stroke", name="short", rows=[[1.0, 2.0]])


@pytest.mark.parametrize(
    ("kind", "field", "most", "others"),
    [
        ("load texture", "display", 400_000, {}),
        ("load texture", "preset", 100, {"display": ""}),
        ("load texture", "texture", 400_000, {"display": ""}),
        ("texture text", "preset", 100, {}),
        ("texture text", "file", 100, {}),
        ("add picture", "name", 64, {"data": "", "pixel": ""}),
        # Base64 of the 5 MB that a PNG may have, and less than a message may.
        ("add picture", "data", 7_000_000, {"name": "", "pixel": ""}),
        ("add picture", "pixel", 100, {"name": "", "data": ""}),
        ("save texture", "name", 64, {"text": ""}),
        ("save texture", "text", 400_000, {"name": ""}),
        ("save stroke", "name", 64, {"rows": []}),
    ],
)
def test_texts_that_are_too_long_are_refused(
    lab: Talk, kind: str, field: str, most: int, others: dict[str, Any]
) -> None:
    require_refused_if_longer(lab, kind, field, most, others)


def test_a_stroke_has_at_most_two_hundred_thousand_rows(lab: Talk) -> None:
    row, model = (0.0,) * 8, lab.model("save stroke")
    assert len(model(id=1, type="t", name="n", rows=[row] * 200_000).rows) == 200_000
    with pytest.raises(ValidationError, match="at most 200000"):
        model(id=1, type="t", name="n", rows=[row] * 200_001)


def test_every_preset_can_be_asked_for(lab: Talk) -> None:
    for name in presets.texture_names():
        text = lab.say("texture text", preset=name)["text"]
        file = presets.resolve(name, "texture")
        assert texture_from_text(text, file=file).title == load_texture(name).title
