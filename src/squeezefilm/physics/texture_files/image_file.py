"""A picture beside a texture's file as a pattern: named in TOML, read and put in its place.

In a texture's file::

    pattern = { type = "image_file", file = "map.png", pixel = "0.1 mm" }

Black is 0 and white is 1, which the level around it (`low`, `high`) makes a quantity. The file is
looked for beside the TOML file and below, nowhere else.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Annotated, Any, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.opcodes import Assembler
from squeezefilm.physics.render.texture.coordinate import Finger
from squeezefilm.physics.render.texture.image import Image
from squeezefilm.physics.render.texture.pattern import Pattern
from squeezefilm.physics.texture_files.pictures import read_picture


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class ImageFile(Pattern):
    """An image whose pixels are in a PNG file; `image` reads them. See `Image` for the rest.

    Args:
        file: its path, relative to the file that names it, with / between folders.
        pixel: side of a pixel (m): there is no image without a scale.
        left, bottom: the frame's corner (m).
        outside: "hold", "repeat" or "zero".

    Raises:
        InputError: a path that is absolute or climbs out with "..", or a value out of range.
    """

    file: str
    pixel: Annotated[si.Metre, si.AtLeast(1e-06), si.AtMost(0.1)]
    left: si.Metre = 0.0
    bottom: si.Metre = 0.0
    outside: Literal["hold", "repeat", "zero"] = "hold"
    type: Literal["image_file"] = field(default="image_file", repr=False)

    def __post_init__(self) -> None:
        path = PurePosixPath(self.file)
        windows = PureWindowsPath(self.file)
        climbs = ".." in path.parts or ".." in windows.parts
        if not self.file or "\0" in self.file or climbs or path.is_absolute() or windows.anchor:
            raise InputError(
                f"file = '{self.file}' cannot be used: it must lie beside the texture's file or in "
                "a folder below it; give a relative path without '..'",
                quantity="file",
            )

    def image(self, folder: Path) -> Image:
        """The image, read from a file under `folder`.

        Raises:
            InputError: a file that lies elsewhere (a link may lead out) or cannot be read.
        """
        inside = folder.resolve()
        try:
            path = (inside / self.file).resolve()
        except (OSError, RuntimeError) as error:
            # Before Python 3.13 a circle of links is no OSError.
            raise InputError(
                f"file = '{self.file}' cannot be followed: {error}; copy the picture there",
                quantity="file",
            ) from error
        if not path.is_relative_to(inside):
            raise InputError(
                f"file = '{self.file}' leads out of {folder}; copy the picture there",
                quantity="file",
            )
        values = read_picture(path)
        return Image.from_array(
            values, self.pixel, left=self.left, bottom=self.bottom, outside=self.outside
        )

    def _values(self, finger: Finger) -> si.FloatArray:
        raise self._unread()

    def _lower(self, assembler: Assembler) -> None:
        raise self._unread()

    def _unread(self) -> InputError:
        return InputError(
            f"the picture '{self.file}' has not been read; load the texture from its file, or call "
            "with_images(texture, folder)"
        )


def with_images(value: Any, folder: Path | None) -> Any:
    """A texture or pattern with every `ImageFile` replaced by its `Image`, from under `folder`.

    Raises:
        InputError: a picture that cannot be used, or one asked for without a folder (None).
    """
    if isinstance(value, ImageFile):
        if folder is None:
            raise InputError(
                f"the picture '{value.file}' has no folder to be in: the texture is no file",
                quantity="file",
            )
        return value.image(folder)
    if isinstance(value, tuple):
        found = tuple(with_images(one, folder) for one in value)
        return found if any(a is not b for a, b in zip(found, value, strict=True)) else value
    if not dataclasses.is_dataclass(value) or isinstance(value, type | Image):
        return value
    changed = {}
    for one in dataclasses.fields(value):
        if not one.init:
            continue
        before = getattr(value, one.name)
        after = with_images(before, folder)
        if after is not before:
            changed[one.name] = after
    return dataclasses.replace(value, **changed) if changed else value
