"""Textures in files: what is refused, and whether the message tells where and why."""

from pathlib import Path

import pytest

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.render.texture.image import Image, Noise
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.physics.render.texture.pattern import AlongDirection, Complement, Pattern, Times
from squeezefilm.physics.render.texture.shapes import Band, SquareWave
from squeezefilm.physics.texture_files.texture_file import (
    TextureFile,
    load_texture,
    save_texture,
    texture_from_text,
    texture_text,
)

TEXT = """\
title = "A grating within a band"

[texture]
type = "masked"

[texture.texture]
type = "relative_friction"
low = 0.5
high = 0.9

[texture.texture.pattern]
type = "times"

[[texture.texture.pattern.patterns]]
type = "square_wave"
spatial_period = "2 mm"
along = { type = "direction", angle = "0.5 rad" }

[[texture.texture.pattern.patterns]]
type = "image"
pixel = "0.1 mm"
values = [[0.0, 0.5], [1.0, 0.25]]

[texture.pattern]
type = "band"
start = "0 mm"
end = "30 mm"
"""

WANTED = RelativeFriction(
    Times(
        (
            SquareWave(2e-3, along=AlongDirection(0.5)),
            Image(((0.0, 0.5), (1.0, 0.25)), 1e-4),
        )
    ),
    0.5,
    0.9,
) & Band(0.0, 0.03)


def test_a_file_is_the_texture_it_says() -> None:
    found = texture_from_text(TEXT)
    assert found.texture == WANTED
    assert found.title == "A grating within a band"
    assert texture_from_text(texture_text(found)) == found


def test_files_are_written_once(tmp_path: Path) -> None:
    path = tmp_path / "texture.toml"
    save_texture(WANTED, path)
    assert load_texture(path) == TextureFile(WANTED)
    with pytest.raises(InputError, match="exists already"):
        save_texture(WANTED, path)
    with pytest.raises(InputError, match="cannot write"):
        save_texture(WANTED, path / "in-a-file.toml")


def test_quantities_are_readable_and_whole() -> None:
    text = texture_text(Amplitude(SquareWave(0.1 / 3, phase=0.1), 0.3e-6, 2e-6))
    assert 'spatial_period = "33.33333333333333 mm"' in text
    assert 'low = "300 nm"' in text
    assert 'high = "2 um"' in text
    assert 'phase = "0.1 rad"' in text
    # Defaults are left out.
    assert (
        texture_text(Amplitude(Noise(1e-3, 7), 0.0, 1e-6))
        == """\
[texture]
type = "amplitude"
low = "0 m"
high = "1 um"

[texture.pattern]
type = "noise"
finest_period = "1 mm"
seed = 7
"""
    )


@pytest.mark.parametrize(
    ("old", "new", "line", "key", "says"),
    [
        ('"2 mm"', "2", 16, "patterns.1.spatial_period", "has no unit"),
        ('"2 mm"', '"2 s"', 16, "patterns.1.spatial_period", "wrong dimension"),
        ('"2 mm"', '"0 mm"', 16, "patterns.1.spatial_period", "at least 1 nm"),
        ('pixel = "0.1 mm"\n', "", None, "patterns.2.pixel", "'pixel' is missing"),
        ("0.25]", "1.25]", 22, "patterns.2.values", "values = 1.25"),
        ("0.25]", '"1 mm"]', 22, "patterns.2.values.2.2", "wrong dimension"),
        ("0.5], [", "0.5, 1.0], [", 22, "patterns.2.values", "rows of one length"),
        ("square_wave", "square_wav", 14, "patterns.1", "Did you mean 'square_wave'"),
        ("spatial_period", "spatial_perod", None, "spatial_perod: unknown", "(line 16)"),
        ('type = "times"\n', "", 11, "texture.pattern", "'type' is missing"),
        ("high = 0.9", "high = 1.9", 9, "texture.high", "high = 1.9"),
        ("low = 0.5", "low = 0.95", 8, "texture.low", "complement the pattern"),
        ('"0.5 rad"', '"0.5 mm"', 17, "along.angle", "wrong dimension"),
        ('"band"', '"amplitude"', 24, "texture.pattern", "type = 'amplitude' is not known"),
        ('"30 mm"', '"-30 mm"', 27, "texture.pattern.end", "above 0 m"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(
    old: str, new: str, line: int | None, key: str, says: str
) -> None:
    assert old in TEXT
    with pytest.raises(ConfigError) as caught:
        texture_from_text(TEXT.replace(old, new, 1), file="grating.toml")
    message = str(caught.value)
    assert says in message
    assert key in message
    assert message.startswith("grating.toml")
    if line is not None:
        assert caught.value.line == line, message


def test_what_is_nested_without_end_is_refused() -> None:
    head = "[texture]\ntype = 'relative_friction'\nlow = 0\nhigh = 1\npattern = "
    inner = "{ type = 'constant' }"
    for depth in (30, 60, 120, 3000):
        wrapped = "{ type = 'complement', pattern = " * depth + inner + " }" * depth
        if depth <= 60:
            assert texture_from_text(head + wrapped).texture.quantity == "relative_friction"
        else:
            with pytest.raises(ConfigError, match="nested"):
                texture_from_text(head + wrapped)
    with pytest.raises(ConfigError, match="nested"):
        texture_from_text("title = " + "[" * 5000 + "]" * 5000)
    pattern: Pattern = SquareWave(1e-3)
    for _ in range(60):
        pattern = Complement(pattern)
    with pytest.raises(InputError, match="nested"):
        texture_text(RelativeFriction(pattern, 0.1, 0.2))


@pytest.mark.slow
def test_an_image_too_large_for_a_file_is_refused() -> None:
    import numpy as np

    rng = np.random.default_rng(1)
    image = Image.from_array(rng.random((512, 512)), 1e-4)
    with pytest.raises(InputError, match="fewer pixels"):
        texture_text(Amplitude(image, 0.0, 1e-6))
