"""The pictures of a study's pages, drawn by this process and by a second one where there is one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from squeezefilm.core.kit import style
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.core.second_process import later, values

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Drawing = Callable[[Any, str], "Figure"]
"""Draws a result's figure of a key; a function of a module, so that it can be sent."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure as PNG, and the message it has at its top."""

    png: bytes
    message: str

    def get_suptitle(self) -> str:
        """The figure's title, by the name of matplotlib's method."""
        return self.message


def pictures(
    drawing: Drawing, figures: Iterable[FigureOf], result: Any, prefix: str = ""
) -> dict[str, tuple[str, Picture]]:
    """The pictures that a result has, by the name of their file: heading and picture."""
    wanted = [figure for figure in figures if figure.has(result)]
    keys = [figure.key for figure in wanted]
    # Two pieces: to send a result takes longer than to draw it once.
    share = later(_drawn, drawing, result, keys[1::2]), later(_drawn, drawing, result, keys[::2])
    drawn = {key: picture for part in values(*share) for key, picture in part.items()}
    return {
        prefix + (figure.file or figure.key): (figure.heading, drawn[figure.key])
        for figure in wanted
    }


def png_files(drawn: Mapping[str, tuple[str, Picture]]) -> dict[str, str | bytes]:
    """The files NAME.png that pages show."""
    return {f"{name}.png": picture.png for name, (_, picture) in drawn.items()}


def _drawn(drawing: Drawing, result: Any, keys: Sequence[str]) -> dict[str, Picture]:
    return {key: _picture(drawing(result, key)) for key in keys}


def _picture(figure: Figure) -> Picture:
    return Picture(style.png(figure), figure.get_suptitle())
