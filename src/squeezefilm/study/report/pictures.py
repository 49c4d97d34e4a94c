"""The pictures of a study's pages, drawn by this process and by a second one where there is one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

from squeezefilm.core.kit import style
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.core.loading import loading
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
        """As matplotlib's figures say it."""
        return self.message


def pictures(
    drawing: Drawing, figures: Iterable[FigureOf], result: Any, prefix: str = ""
) -> dict[str, tuple[str, Picture]]:
    """The pictures that a result has, by the name of their file: heading and picture."""
    wanted = [one for one in figures if one.has(result)]
    pieces = [later(_picture, drawing, result, one.key) for one in wanted]
    return {
        prefix + (one.file or one.key): (one.heading, found)
        for one, found in zip(wanted, values(*pieces), strict=True)
    }


def png_files(found: Mapping[str, tuple[str, Picture]]) -> dict[str, str | bytes]:
    """The files NAME.png that pages show."""
    return {f"{name}.png": picture.png for name, (_, picture) in found.items()}


def load_drawing() -> None:
    """Load what drawing takes, in a program, before there is anything to draw."""
    with loading():
        for name in ("page", "simulated_page"):
            import_module(f"squeezefilm.study.report.{name}")
        import_module("matplotlib.figure")
        import_module("matplotlib.backends.backend_agg")


def _picture(drawing: Drawing, result: Any, key: str) -> Picture:
    figure = drawing(result, key)
    return Picture(style.png(figure), figure.get_suptitle())
