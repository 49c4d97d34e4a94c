"""The slips of a first hour: each is refused with its place, and with what to write instead."""

from __future__ import annotations

from pathlib import Path

import pytest

from squeezefilm.core import presets
from squeezefilm.core.config import load, load_text
from squeezefilm.core.errors import ConfigError
from squeezefilm.physics.display import Display

TEXT = presets.path("biet2008-plate").read_text(encoding="utf-8")
LENGTH = 'length = { value = "83 mm", source = "paper, section 3.1.2" }'
VOLTAGE = 'voltage = { value = "15 V", source = "paper, section 3.1" }'
LINES = "nodal_lines = { value = 8,"


def line_of(text: str, part: str) -> int:
    """The first line of a text in which a part stands, from 1."""
    return text[: text.index(part)].count("\n") + 1


# What stood there, what is written in its place, and what of it the message gives back.
WRITTEN = [
    # No quotation marks, or other ones.
    (LENGTH, "length = 60 mm", 'write length = "60 mm"'),
    (LENGTH, "length = 60 mm # of the plate", 'write length = "60 mm"'),
    (LENGTH, "length = “60 mm”", 'write straight ones: length = "60 mm"'),
    (LENGTH, "length = „60 mm“", 'write straight ones: length = "60 mm"'),
    (LENGTH, "length = ‘60 mm’", 'write straight ones: length = "60 mm"'),
    (LENGTH, 'length = "60 mm', 'write length = "60 mm"'),
    (LENGTH, 'length = "60" mm', 'write length = "60 mm"'),
    ('type = "rectangular_plate"', "type = rectangular_plate", 'type = "rectangular_plate"'),
    # No value, or one of another notation.
    (LENGTH, "length =", 'write length = "…"'),
    (LENGTH, "length", 'write length = "…"'),
    (LENGTH, 'length: "60 mm"', 'write length = "60 mm"'),
    (LENGTH, "length: 60 mm", 'write length = "60 mm"'),
    (LENGTH, 'length == "60 mm"', 'write length = "60 mm"'),
    (LENGTH, 'length = "60 mm";', 'write length = "60 mm"'),
    (LENGTH, "length = 82,5", 'length = "82.5 mm" for a quantity'),
    (LINES, "nodal_lines = { value = 08,", "write value = 8"),
    ("value = 0.30,", "value = .30,", "write value = 0.3"),
    (LENGTH, 'length = { value = "83 mm" source = "x" }', "a comma is missing"),
    (LENGTH, 'length = { value = "83 mm", source = "x"', "ends with }"),
    ('data_set = "from_d31"', "data_set = True", "write data_set = true"),
    ('title = "Copper', 'title = "C:\\Users\\Copper', "write / in its place"),
    # Tables and keys.
    ("[drive]", "[drive", "write [drive]"),
    ("[gas]\n", "[drive]\nduty = 1\n[gas]\n", "the table [drive] stands twice, first in line"),
    (VOLTAGE, f'{VOLTAGE}\nvoltage = "3 V"', "the key 'voltage' stands twice in its table"),
    ("[[actuator.patches]]", "[actuator.patches]", "write [[actuator.patches]] each time"),
    ("# The voltage", "// The voltage", "a comment begins with #"),
    (LENGTH, 'length\u00a0= "60 mm"', "a non-breaking blank stands in column 7"),
    # Quantities.
    (LENGTH, "length = 60", 'like "60 mm"'),
    (LENGTH, 'length = "1,5 mm"', 'decimals stand after a point; write "1.5 mm"'),
    (LENGTH, 'length = "40 kHz"', "it is a frequency, and a length is wanted"),
    (LENGTH, 'length = "83 %"', "and a length is wanted, in one of m, mm, µm, nm"),
    (LENGTH, 'length = "-83 mm"', "it must be at least 1 µm"),
    (LENGTH, 'length = "83 mm ± 0.1 mm"', "stands beside it, as its uncertainty"),
    (LENGTH, 'length = "eighty mm"', 'write a number and a unit, like "2 mm"'),
    (VOLTAGE, 'voltage = "20"', 'like "20 V"'),
    (VOLTAGE, "voltage = 20", 'like "20 V"'),
    (VOLTAGE, f'{VOLTAGE}\nlowest_frequency = "30 KHZ"', 'write "30 kHz"'),
    (LINES, 'nodal_lines = { value = "8",', "'8' is no whole number"),
    (LINES, "nodal_lines = { value = 8.0,", "8.0 is no whole number"),
    ('name = "bare"', "name = 3", "3 is no text; write it between quotation marks"),
]


@pytest.mark.parametrize(("stood", "written", "says"), WRITTEN)
def test_a_slip_is_answered_with_its_line_and_what_to_write(
    stood: str, written: str, says: str
) -> None:
    assert stood in TEXT
    text = TEXT.replace(stood, written, 1)
    with pytest.raises(ConfigError) as caught:
        load_text(Display, text, file="mine.toml")
    assert says in str(caught.value)
    assert caught.value.line is not None
    # Near where it was written: a table or key that stands twice is told at its second place.
    first = line_of(text, written)
    assert first <= caught.value.line <= first + 12
    assert str(caught.value).startswith(f"mine.toml, line {caught.value.line}")
    assert "\n" not in str(caught.value)


def test_the_line_and_column_of_what_is_no_toml_are_told_with_what_was_written() -> None:
    text = TEXT.replace(LENGTH, "length = 60 mm")
    with pytest.raises(ConfigError) as caught:
        load_text(Display, text, file="mine.toml")
    line = line_of(text, "length = 60 mm")
    assert str(caught.value) == (
        f"mine.toml, line {line}, column 13: length = 60 mm: a quantity or a word stands between "
        'quotation marks; write length = "60 mm"'
    )


def test_a_missing_key_is_told_apart_from_the_optional_ones() -> None:
    with pytest.raises(ConfigError) as caught:
        load_text(Display, TEXT.replace(VOLTAGE, ""))
    message = str(caught.value)
    assert "the key 'voltage' is missing; a Drive needs voltage; it may also have " in message
    assert message.index("may also have") < message.index("insulation")
    with pytest.raises(ConfigError, match=r"'gas' is missing.* needs .*gas; it may also have"):
        load_text(Display, TEXT[: TEXT.index("[gas]")])
    with pytest.raises(ConfigError, match=r"unknown key 'driver'\. Did you mean 'drive'"):
        load_text(Display, TEXT.replace("[drive]", "[driver]"))


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + TEXT,
        TEXT.replace("\n", "\r\n"),
        TEXT.replace("\n", "\r"),
        TEXT.replace('"83 mm"', '"83   mm"'),
        TEXT.replace('"83 mm"', '"83mm"'),
        TEXT.replace('"83 mm"', '"83\u202fmm"'),
        TEXT.replace('"0.6 um"', '"0.6 \u00b5m"'),
        TEXT.replace('"0.6 um"', '"0.6 \u03bcm"'),
        TEXT.replace("kg/m3", "kg/m³"),
        TEXT.replace('"83 mm"', '"83.0e-3 m"'),
        TEXT.replace('"83 mm"', "'83 mm'"),
    ],
)
def test_what_means_the_same_is_read(tmp_path: Path, text: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(text.encode("utf-8"))
    assert load(Display, file) == load_text(Display, TEXT)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (TEXT.encode("utf-16"), "it is UTF-16"),
        (TEXT.replace("0.6 um", "0.6 µm").encode("latin-1"), "the byte 0xb5 is of another"),
        (b"\x89PNG\r\n\x1a\n\0\0", "bytes that no text has"),
        (b'{"name": "mine"}', "is it JSON"),
        (b"name: mine\nlength: 60 mm\n", 'write name = "mine"'),
        (TEXT.encode() + b"\0", "control character"),
        (b"", "is empty; a Display needs name"),
    ],
)
def test_a_file_of_another_kind_is_named_as_what_it_is(
    tmp_path: Path, content: bytes, says: str
) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(content)
    with pytest.raises(ConfigError, match=says) as caught:
        load(Display, file)
    assert "mine.toml" in str(caught.value)


def test_a_vibration_beyond_every_display_is_refused_as_it_was_asked() -> None:
    import squeezefilm as sf

    with pytest.raises(sf.SqueezefilmError, match=r"^vibration_amplitude = 2 m cannot be used"):
        sf.predict("biet2008-stator", vibration_amplitude=2)
