"""Pictures as maps, and pictures beside a texture's file."""

import io
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from tests.pictures import coloured_bytes, picture_bytes

from squeezefilm.core.errors import ConfigError, InputError, SqueezefilmWarning
from squeezefilm.physics.render.texture.image import MOST_PIXELS
from squeezefilm.physics.texture_files import image_file
from squeezefilm.physics.texture_files.image_file import ImageFile, picture_from, read_picture
from squeezefilm.physics.texture_files.texture_file import load_texture, texture_from_text

GRID = np.random.default_rng(5).random((7, 11))
TOML = """
[texture]
type = "relative_friction"
low = 0.5
high = 0.9
pattern = { type = "image_file", file = "%s"%s }
"""
SCALE = ', pixel = "0.5 mm"'


@pytest.mark.parametrize("bits", [8, 16])
def test_what_is_written_is_read_within_half_a_step(bits: int) -> None:
    read = picture_from(picture_bytes(GRID, bits))
    assert np.max(np.abs(read - GRID)) <= 0.5 / (2**bits - 1) * 1.0001
    ends = np.array([[0.0, 1.0]])
    assert np.array_equal(picture_from(picture_bytes(ends, bits)), ends)


def header(columns: int, rows: int, bits: int = 8, kind: int = 0) -> bytes:
    body = struct.pack(">IIBBBBB", columns, rows, bits, kind, 0, 0, 0)
    crc = struct.pack(">I", zlib.crc32(b"IHDR" + body))
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + b"IHDR" + body + crc


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"GIF89a", "is no PNG"),
        (header(1 << 20, 1 << 20), "1048576 × 1048576 pixels"),
        (header(0, 5), "0 × 5"),
        (header(4, 4), "damaged"),
        (picture_bytes(GRID)[:-30], "damaged"),
    ],
)
def test_what_is_no_map_is_refused_before_it_is_decoded(data: bytes, says: str) -> None:
    with pytest.raises(InputError, match=says):
        picture_from(data)


def test_of_colours_the_brightness_is_used_and_that_is_said() -> None:
    colours = np.random.default_rng(6).integers(0, 256, (7, 11, 3)) / 255
    brightness = colours @ [0.299, 0.587, 0.114]
    with pytest.warns(SqueezefilmWarning, match="a map is in colour: of each pixel the brightness"):
        assert picture_from(coloured_bytes(colours), "a map") == pytest.approx(brightness)
    white = np.ones((1, 1, 3))
    with pytest.warns(SqueezefilmWarning, match="in colour"):
        assert picture_from(coloured_bytes(white)) == 1.0
    # A JPEG keeps colours coarsely, and brightness within some of its 255 steps.
    grey = np.repeat(GRID[:, :, np.newaxis], 3, axis=2)
    with pytest.warns(SqueezefilmWarning, match="in colour"):
        assert picture_from(coloured_bytes(grey, "JPEG")) == pytest.approx(GRID, abs=4 / 255)
    with pytest.warns(SqueezefilmWarning, match="in colour"):
        turned = picture_from(coloured_bytes(grey, "JPEG", exif=6))
    assert turned == pytest.approx(np.rot90(GRID, -1), abs=4 / 255)


def test_pixels_that_are_seen_through_have_no_brightness() -> None:
    def with_alpha(alpha: int) -> bytes:
        stream = io.BytesIO()
        picture = Image.fromarray(np.zeros((2, 3), dtype=np.uint8)).convert("LA")
        picture.putpixel((1, 1), (0, alpha))
        picture.save(stream, format="PNG")
        return stream.getvalue()

    assert picture_from(with_alpha(255)).shape == (2, 3)
    with pytest.raises(InputError, match="transparent pixels"):
        picture_from(with_alpha(254))


def test_as_many_pixels_as_an_image_may_have() -> None:
    side = int(MOST_PIXELS**0.5)
    assert picture_from(picture_bytes(np.zeros((side, side)))).shape == (side, side)
    with pytest.raises(InputError, match="together"):
        picture_from(picture_bytes(np.zeros((side + 1, side))))


def test_a_texture_reads_the_picture_beside_it(tmp_path: Path) -> None:
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "a.png").write_bytes(picture_bytes(GRID, 16))
    (tmp_path / "t.toml").write_text(TOML % ("maps/a.png", SCALE))
    texture = load_texture(tmp_path / "t.toml").texture
    # The centre of the top left pixel: half a pixel in from x = 0, half a pixel down from the top.
    value = float(texture(0.25e-3, 7 * 0.5e-3 - 0.25e-3, 0.1, 0.0))
    assert value == pytest.approx(0.5 + 0.4 * GRID[0, 0], abs=1e-5)


@pytest.mark.parametrize(
    ("file", "scale", "says"),
    [
        ("a.png", "", "'pixel' is missing"),
        ("a.png", ", pixel = 0.5", "has no unit"),
        ("../a.png", SCALE, "without '..'"),
        ("/etc/passwd", SCALE, "relative path"),
        ("C:/a.png", SCALE, "relative path"),
        ("..\\\\\\\\a.png", SCALE, "without '..'"),
        ("none.png", SCALE, "cannot be read"),
        ("link.png", SCALE, "leads out of"),
        ("t.toml", SCALE, "is no PNG"),
    ],
)
def test_pictures_that_cannot_be_used(file: str, scale: str, says: str, tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "a.png").write_bytes(picture_bytes(GRID))
    (tmp_path / "out.png").write_bytes(picture_bytes(GRID))
    (folder / "link.png").symlink_to(tmp_path / "out.png")
    (folder / "t.toml").write_text(TOML % (file, scale))
    with pytest.raises(ConfigError, match=says) as caught:
        load_texture(folder / "t.toml")
    assert "t.toml" in str(caught.value)


def test_a_picture_needs_a_file_beside_it_and_reading() -> None:
    with pytest.raises(ConfigError, match="has no folder"):
        texture_from_text(TOML % ("a.png", SCALE))
    with pytest.raises(InputError, match="has not been read"):
        ImageFile("a.png", 1e-3)(0.0, 0.0, 0.1, 0.0)


def test_a_file_too_large_is_not_read(tmp_path: Path) -> None:
    with (tmp_path / "a.png").open("wb") as file:
        file.truncate(17_000_000)
    with pytest.raises(InputError, match="larger than 16 000 000 bytes"):
        read_picture(tmp_path / "a.png")


def saved(picture: Image.Image, kind: str = "PNG", **how: Any) -> bytes:
    out = io.BytesIO()
    picture.save(out, kind, **how)
    return out.getvalue()


def test_brightness_is_of_grey_as_it_is_and_of_colours_as_an_eye_weighs_them() -> None:
    """Read here, not in a process of its own."""
    grey = np.array([[0, 51], [102, 255]], dtype=np.uint8)
    _, (found,) = image_file._brightness(saved(Image.fromarray(grey)))
    assert found == pytest.approx(grey / 255, abs=1e-12)
    fine = np.array([[0, 13107], [26214, 65535]], dtype=np.uint16)
    _, (found,) = image_file._brightness(saved(Image.fromarray(fine)))
    assert found == pytest.approx(fine / 65535, abs=1e-12)
    colours = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], dtype=np.uint8)
    _, (found,) = image_file._brightness(saved(Image.fromarray(colours)))
    # Red, green and blue make white; green is the brightest, blue the darkest.
    red, green, blue, white = found.ravel().tolist()
    assert white == pytest.approx(1.0)
    assert red + green + blue == pytest.approx(1.0)
    assert green > red > blue > 0.0


def test_a_picture_that_says_that_it_lies_on_its_side_is_turned() -> None:
    exif = Image.Exif()
    exif[0x0112] = 6  # turned a quarter to the right, to be upright
    grey = Image.fromarray(np.array([[0, 51, 102]], dtype=np.uint8))
    _, (found,) = image_file._brightness(saved(grey, exif=exif))
    assert found == pytest.approx(np.array([[0.0], [0.2], [0.4]]), abs=1e-12)


def test_a_picture_with_transparent_pixels_or_cut_short_is_refused() -> None:
    clear = Image.new("RGBA", (3, 3), (9, 9, 9, 255))
    image_file._brightness(saved(clear))
    clear.putpixel((1, 1), (9, 9, 9, 254))
    with pytest.raises(ConfigError, match="has transparent pixels"):
        image_file._brightness(saved(clear))
    noise = np.random.default_rng(1).integers(0, 255, (64, 64), dtype=np.uint8)
    for data in (saved(Image.fromarray(noise))[:900], b"\xff\xd8\xff\xe0 is no picture"):
        with pytest.raises(ConfigError, match="is damaged and cannot be read"):
            image_file._brightness(data)


def test_a_picture_that_was_not_read_cannot_be_felt() -> None:
    picture = image_file.ImageFile("wood.png", 1e-3)
    with pytest.raises(InputError, match=r"picture 'wood\.png' has not been read; load the"):
        picture(0.0, 0.0, 0.1, 0.0)
