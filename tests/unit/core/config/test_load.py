"""Configuration files: what is refused, and whether the message tells where and why."""

from pathlib import Path

import pytest

from squeezefilm.core import presets
from squeezefilm.core.config import load, load_text
from squeezefilm.core.config.syntax import locate
from squeezefilm.core.distributions import Normal, Uniform
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.results import config_hash
from squeezefilm.physics.display import Display, load_display

TEXT = presets.path("biet2008-plate").read_text(encoding="utf-8")


def test_presets_load_with_the_paper_s_values_and_sources() -> None:
    plate = load_display("biet2008-plate")
    assert plate.actuator.length == 0.083
    assert plate.gas.viscosity == 1.85e-05
    assert plate.provenance["actuator.length"].evidence == "published"
    assert plate.provenance["actuator.substrate.density"].evidence == "assumed"
    stator = load_display("biet2008-stator")
    assert [surface.roughness for surface in stator.surfaces] == [0.6e-6, 0.2e-6]
    assert stator.actuator.wavelengths_around == pytest.approx(9, abs=0.001)


@pytest.mark.parametrize("name", presets.display_names())
def test_every_number_of_a_preset_has_a_source(name: str) -> None:
    display = load_display(name)
    assert all(item.source for item in display.provenance.values())


@pytest.mark.parametrize(
    ("old", "new", "key", "says"),
    [
        ('"83 mm"', "83", "actuator.length", 'like "83 mm"'),
        ('"83 mm"', '"83 kg"', "actuator.length", "wrong dimension"),
        ('"83 mm"', "true", "actuator.length", "no quantity"),
        ('"83 mm"', '["83 mm"]', "actuator.length", "no quantity"),
        ('"2 mm"', '"-2 mm"', "actuator.thickness", "at least 10 nm"),
        ('"2 mm"', '"0 mm"', "actuator.thickness", "at least 10 nm"),
        ('"15 V"', '"nan V"', "drive.voltage", "finite"),
        ('"15 V"', '"3 kV"', "drive.voltage", "at most 2 kV"),
        ('x = "12 mm"', 'x = "5 mm"', "actuator", "ceramics 1 and 2 overlap by 6 mm"),
        ('x = "72 mm"', 'x = "73 mm"', "actuator", "ceramic 7 overhangs the plate"),
        ("rectangular_plate", "rectangle_plate", "actuator", "Did you mean 'rectangular_plate'"),
        ("polarity = -1", "polarity = 0", "actuator.patches.2.polarity", "1 or -1"),
        ("value = 8,", "value = 8.5,", "actuator.nodal_lines", "no whole number"),
        ('"from_d31"\n', '"from_d33"\n', "actuator.ceramic.data_set", "printed_e31"),
        ('evidence = "assumed"', 'evidence = "guess"', "actuator.quality_factor", "measured"),
        ("value = 0.9", "value = 0", "surfaces.1.friction_coefficient", "above 0"),
    ],
)
def test_bad_values_name_file_line_key_and_what_is_allowed(
    old: str, new: str, key: str, says: str
) -> None:
    assert old in TEXT
    with pytest.raises(ConfigError) as caught:
        load_text(Display, TEXT.replace(old, new, 1), file="mine.toml")
    assert caught.value.key == key
    assert caught.value.line is not None
    assert str(caught.value).startswith(f"mine.toml, line {caught.value.line}: {key}: ")
    assert says in str(caught.value)


def test_the_line_is_the_one_the_value_stands_on() -> None:
    bad = TEXT.replace('"2 mm"', '"-2 mm"', 1)
    with pytest.raises(ConfigError) as caught:
        load_text(Display, bad, file="mine.toml")
    assert caught.value.line is not None
    assert '"-2 mm"' in bad.splitlines()[caught.value.line - 1]


def test_several_errors_are_reported_at_once() -> None:
    bad = TEXT.replace("roughness =", "roughnes =", 1).replace('"15 V"', "15", 1)
    with pytest.raises(ConfigError) as caught:
        load_text(Display, bad, file="mine.toml")
    message = str(caught.value)
    assert "3 things" in message
    assert "Did you mean 'roughness'" in message
    assert 'like "15 mV"' in message or "drive.voltage" in message


def test_missing_table_and_typo() -> None:
    with pytest.raises(ConfigError, match="Did you mean 'gas'"):
        load_text(Display, TEXT.replace("[gas]", "[gass]"))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (b"# nothing\n", "is empty"),
        (b"[gas", r"not closed; write \[gas\]"),
        (b"\xff\xfe\x00", "not UTF-8"),
        (b"actuator = 3\n", "actuator"),
    ],
)
def test_files_that_are_no_configuration(tmp_path: Path, content: bytes, says: str) -> None:
    file = tmp_path / "x.toml"
    file.write_bytes(content)
    with pytest.raises(ConfigError, match=says) as caught:
        load(Display, file)
    assert "x.toml" in str(caught.value)


def test_paths_that_are_no_files(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="is a directory"):
        load(Display, tmp_path)
    with pytest.raises(ConfigError, match="does not exist"):
        load(Display, tmp_path / "none.toml")
    with pytest.raises(ConfigError, match="Did you mean 'biet2008-plate'"):
        load_display("biet2008-plat")


def test_lines_are_located_below_arrays_of_tables() -> None:
    text = '[a]\nx = 1\n[[a.list]]\ny = 2\n[[a.list]]\ny = 3\n[a.list.sub]\nz = 4\n"q r" = 1\n'
    assert locate(text, ("a", "x")) == 2
    assert locate(text, ("a", "list", 1, "y")) == 6
    assert locate(text, ("a", "list", 1, "sub", "z")) == 8
    assert locate(text, ("a", "list", 1, "none")) == 5
    assert locate(text, ("nowhere",)) is None


def test_hash_depends_on_values_and_not_on_their_writing() -> None:
    same = load_text(Display, TEXT.replace('"83 mm"', '"8.3 cm"'))
    other = load_text(Display, TEXT.replace('"2 mm"', '"2.1 mm"'))
    plate = load_display("biet2008-plate")
    assert config_hash(same) == config_hash(plate)
    assert config_hash(other) != config_hash(plate)


def test_an_uncertainty_beside_a_value_becomes_a_distribution() -> None:
    thickness = 'thickness = { value = "2 mm"'
    assert TEXT.count(thickness) == 1
    for written, expected in (
        ('uncertainty = "0.05 mm"', Normal(2e-3, 0.05e-3)),
        ('uncertainty = "5 %"', Normal(2e-3, 0.1e-3)),
        ('range = ["1.9 mm", "2.2 mm"]', Uniform(1.9e-3, 2.2e-3)),
    ):
        text = TEXT.replace(thickness, f"{thickness}, {written}")
        display = load_text(Display, text)
        found = display.provenance["actuator.thickness"].distribution
        assert type(found) is type(expected)
        assert found is not None
        assert found.support == pytest.approx(expected.support)
        assert display.provenance["actuator.length"].distribution is None
        assert display.actuator.thickness == 2e-3


@pytest.mark.parametrize(
    ("written", "says"),
    [
        ("uncertainty = 5", "no text"),
        ('uncertainty = "5 kg"', "wrong dimension"),
        ('uncertainty = "50 %"', "give a range"),
        ('uncertainty = "0 mm"', "above 0"),
        ('range = ["1 mm"]', "write two texts"),
        ('range = ["2.1 mm", "2.3 mm"]', "leaves out the value 2 mm"),
        ('range = ["2.1 mm", "1.9 mm"]', "lower value first"),
        ('range = ["1 mm", "3 mm"], uncertainty = "1 %"', "give one of them"),
    ],
)
def test_a_bad_uncertainty_is_refused_with_line_and_key(written: str, says: str) -> None:
    thickness = 'thickness = { value = "2 mm"'
    with pytest.raises(ConfigError, match=says) as caught:
        load_text(Display, TEXT.replace(thickness, f"{thickness}, {written}"))
    assert caught.value.key == "actuator.thickness"
    line = next(n for n, text in enumerate(TEXT.splitlines(), 1) if text.startswith(thickness))
    assert caught.value.line == line
