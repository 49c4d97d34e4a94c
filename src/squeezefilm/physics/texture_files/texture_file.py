"""Textures in files: TOML with units to a texture value and back, without loss.

A file names one texture::

    title = "Fine grating with a bump"

    [texture]
    type = "relative_friction"
    low = 0.5
    high = 0.9
    pattern = { type = "square_wave", spatial_period = "2 mm" }

Every class of the texture algebra is a table with its `type`: the class's name in small letters
with underscores (`SquareWave` is "square_wave"; the coordinates are "x", "y", "direction",
"radius"), and its fields as keys. A quantity without a unit, an image without a scale (`pixel`),
a misspelt key or type is refused with file, line and key. A picture in a file of its own is an
"image_file" (`physics.texture_files.image_file`), read when the texture is.
"""

from __future__ import annotations

import typing
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import ReadBy

# Read for their classes: what a file may name is what is below Composable, Pattern, Coordinate.
from squeezefilm.core.config.load import load, load_text
from squeezefilm.core.config.schema import text_of
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.results import write_new
from squeezefilm.physics.render.texture import image, levels, shapes
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.texture_files import image_file

MODULES = (image_file, levels, shapes, image)
"""The modules whose classes a file may name, beside those these import."""


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class TextureFile:
    """A texture and what it is called. Raises `InputError` for what is no texture."""

    texture: Composable
    title: str = ""

    @classmethod
    def of(cls, texture: TextureFile | Composable) -> TextureFile:
        """The texture with what it is called, which is nothing yet for a bare one."""
        return texture if isinstance(texture, cls) else cls(typing.cast(Composable, texture))


def load_texture(name_or_path: str | Path) -> TextureFile:
    """The texture of a preset's name or of a TOML file, its pictures read.

    Raises `ConfigError` with file, line and key if it can't be.
    """
    from squeezefilm.core import presets

    path = presets.resolve(name_or_path, "texture")
    return _with_images(load(TextureFile, path), path)


NamedTexture = Annotated[TextureFile | Composable, ReadBy(load_texture)]
"""A texture, or in its place the name of a preset or the path of a file (see `reads_text`)."""


def _with_images(given: TextureFile, path: Path | None, folder: Path | None = None) -> TextureFile:
    try:
        whole = image_file.with_images(given, folder if path is None else path.parent)
    except InputError as error:
        raise ConfigError(str(error), file=path, key=error.quantity or "file") from error
    assert isinstance(whole, TextureFile)
    return whole


def texture_from_text(
    text: str, *, file: str | Path | None = None, folder: Path | None = None
) -> TextureFile:
    """The texture in TOML text; `file` is what messages name and beside which pictures lie.

    For a text that is in no file, pictures lie in `folder`.
    Raises `ConfigError`, also for a picture where there is neither.
    """
    path = None if file is None else Path(file)
    return _with_images(load_text(TextureFile, text, file=file), path, folder)


def texture_text(texture: TextureFile | Composable) -> str:
    """TOML text that `texture_from_text` reads back as an equal value.

    Raises `InputError` for a texture whose text is longer than a file may be.
    """
    return text_of(TextureFile.of(texture))


def save_texture(texture: TextureFile | Composable, path: str | Path) -> None:
    """Write a texture to a TOML file.

    Raises:
        InputError: a file that exists already or cannot be written, or a text that is too long.
    """
    write_new(Path(path), texture_text(texture))
