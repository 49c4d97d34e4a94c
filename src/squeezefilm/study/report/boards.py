"""`write_boards`: what a workshop needs to make a study's real gratings."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.formats.drawing import Dimension, Drawing, Item, Layer, Text, rectangle
from squeezefilm.core.formats.dxf import dxf_text
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import M, printable, shown
from squeezefilm.core.kit.page_style import (
    bullets,
    links,
    page,
    picture_files,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.core.results import stamp, to_json
from squeezefilm.study.design.boards import Board, boards
from squeezefilm.study.design.study_design import StudyDesign

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TOLERANCE: si.Metre = 20e-6
"""Tolerance of widths, where none is asked for: what an etched board keeps; assumed."""

_GAP: si.Metre = 12e-3
_LAYERS = {"BOARD": Layer(7), "RIDGES": Layer(1)}


def write_boards(design: StudyDesign, folder: Path, tolerance: si.Metre = TOLERANCE) -> Path:
    """Write a page, a drawing, a DXF of all boards and one of each, and numbers; the page's path.

    `tolerance` is of groove and ridge widths (m). Ridges are closed outlines on the layer RIDGES,
    boards on BOARD. Raises `InputError` for a design without real gratings, a tolerance that is no
    less than half the narrowest groove or ridge, or a folder that cannot be written to.
    """
    si.require("tolerance", tolerance, si.Unit("m"), above=0.0, at_most=1e-3)
    found = boards(design)
    narrow = min(min(board.groove_width, board.ridge_width) for board in found)
    si.require("tolerance", tolerance, si.Unit("m"), below=narrow / 2)
    folder = require_folder(folder)
    figures = {"boards": ("The boards, to scale", draw_boards(found))}
    numbers = {
        "study": design.name,
        "tolerance_m": tolerance,
        "boards": [_numbers(board) for board in found],
        "provenance": stamp(design),
    }
    files: dict[str, str | bytes] = {
        **picture_files(figures),
        "boards.dxf": dxf_text(drawing_of(found)),
        **{f"board-{k + 1}.dxf": dxf_text(drawing_of((one,))) for k, one in enumerate(found)},
        "boards.json": json_text(numbers),
    }
    names = [name for name in files if not name.endswith(".png")]
    title = escape(printable(f"{design.name}: boards of real gratings"))
    files["index.html"] = page(
        title,
        title,
        "for a workshop; lengths in millimetres in the DXF",
        section("What the study calls its lengths", bullets(board.says for board in found))
        + section("The boards", _table(found, tolerance))
        + picture_sections(figures)
        + section("Files", f"<p>{links(names)}</p>"),
        stamped(numbers["provenance"], "SHA-256 of the design") + ".",  # type: ignore[arg-type] # made above
    )
    write_folder(folder, files)
    return folder / "index.html"


def _numbers(board: Board) -> dict[str, object]:
    grating = board.grating
    return {
        "name": grating.name,
        "length_means": grating.period_means,
        **to_json(
            {
                "spatial_period_m": grating.period,
                "ridge_width_m": board.ridge_width,
                "groove_width_m": board.groove_width,
                "ridge_height_m": grating.ridge_height,
                "length_m": grating.length,
                "width_m": grating.width,
                "ridges": board.ridges,
                "last_ridge_width_m": float(board.end[-1] - board.begin[-1]),
            }
        ),
        "material": grating.material,
    }


HEAD = ("Board", "Period", "Ridge", "Groove", "Ridges", "Ridge height", "Board size", "Material")
"""Head of `board_rows`."""


def board_rows(all_boards: tuple[Board, ...], tolerance: si.Metre) -> list[tuple[str, ...]]:
    """Rows of what is to be made, as texts."""
    within = f"± {shown(tolerance, M, 2)}"
    return [
        (
            board.grating.name,
            shown(board.grating.period, M, 4),
            f"{shown(board.ridge_width, M, 4)} {within}",
            f"{shown(board.groove_width, M, 4)} {within}",
            f"{board.ridges}",
            shown(board.grating.ridge_height, M, 3),
            f"{shown(board.grating.length, M, 4)} × {shown(board.grating.width, M, 4)}",
            board.grating.material,
        )
        for board in all_boards
    ]


def _table(every: tuple[Board, ...], tolerance: si.Metre) -> str:
    caption = (
        "Widths along the stroke. Errors of single ridges must not add up: the place of each is "
        "from the board's end, within the same tolerance. The tolerance is assumed unless asked "
        "for."
    )
    return text_table(caption, HEAD, board_rows(every, tolerance))


def drawing_of(found: tuple[Board, ...]) -> Drawing:
    """The boards one above the other, with a ridge's and a period's dimension on each."""
    items: list[Item] = []
    y = 0.0
    for board in found:
        grating = board.grating
        items.append(rectangle("BOARD", 0.0, y, grating.length, grating.width))
        items += [
            rectangle("RIDGES", float(begin), y, float(end - begin), grating.width)
            for begin, end in zip(board.begin, board.end, strict=True)
        ]
        top = y + grating.width
        items += [
            _along(0.0, board.ridge_width, top),
            _along(board.ridge_width, grating.period, top + 3e-3),
            _along(0.0, grating.length, top + 6e-3),
            Text(f"{grating.name}: ridges {1e6 * grating.ridge_height:g} um high", 0.0, y - 4e-3),
        ]
        y += grating.width + 1.5 * _GAP + 6e-3
    return Drawing(_LAYERS, items)


def _along(start: si.Metre, end: si.Metre, y: si.Metre) -> Dimension:
    """A dimension along the stroke, its line 4 mm above a height (m)."""
    at = y + 4e-3
    return Dimension(start, y, end, y, at, (start + end) / 2, at + 1.5e-3)


@style.drawn
def draw_boards(found: tuple[Board, ...]) -> Figure:
    """Every board from above, to scale."""
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Rectangle

    narrow = min(found, key=lambda one: one.groove_width)
    height = 1.2 + 0.62 * len(found)
    figure = style.new_figure(
        f"{len(found)} boards; the narrowest groove is {shown(narrow.groove_width, M, 3)}, of "
        f"{style.plain(narrow.grating.name, 16)}",
        "from above, to scale along the stroke; ridges dark, grooves light",
        height,
    )
    axes = figure.subplots()
    for row, board in enumerate(found):
        grating = board.grating
        ridges = [
            Rectangle((1e3 * b, row - 0.3), 1e3 * (e - b), 0.6)
            for b, e in zip(board.begin, board.end, strict=True)
        ]
        axes.add_collection(PatchCollection(ridges, color=style.METAL, lw=0))
        outline = Rectangle((0, row - 0.3), 1e3 * grating.length, 0.6, fill=False, **style.OUTLINED)
        axes.add_patch(outline)
    longest = max(one.grating.length for one in found)
    axes.set(xlim=(-1, 1e3 * longest + 1), ylim=(len(found) - 0.4, -0.6), xlabel="stroke (mm)")
    axes.set_yticks(range(len(found)), [style.plain(one.grating.name, 16) for one in found])
    axes.grid(False)
    return figure
