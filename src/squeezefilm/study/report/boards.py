"""Boards of a study's real gratings: where each ridge lies, and what a workshop needs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.drawing import Drawing, Layer, dxf_text
from squeezefilm.core.hard_limits import HardLimit, require_within
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import M, printable, shown
from squeezefilm.core.kit.page_style import bullets, links, page, section, stamped, text_table
from squeezefilm.core.kit.sheet import sheet_figure
from squeezefilm.core.results import stamp, values_of
from squeezefilm.physics.perception.stimuli import Grating
from squeezefilm.study.design.study_design import StudyDesign

TOLERANCE: si.Metre = 20e-6
"""Tolerance of widths, where none is asked for: what an etched board keeps; assumed."""

_GAP: si.Metre = 12e-3
_MARGIN: si.Metre = 10e-3
_LAYERS = {"BOARD": Layer(7), "RIDGES": Layer(1, fill="own")}
_RIDGES = HardLimit("ridges of a board", 1, 20_000, "a drawing of so many opens nowhere")


@dataclass(frozen=True, slots=True, eq=False)
class Board:
    """A grating as it is made: a plate with ridges across the stroke.

    Attributes:
        grating: what it is.
        ridge_width, groove_width: along the stroke (m).
        begin: where each ridge begins, from the board's left end (m), shape (ridges,).
        end: where it ends (m), likewise; the last may be cut by the board's end.
    """

    grating: Grating
    ridge_width: si.Metre
    groove_width: si.Metre
    begin: si.MetreArray
    end: si.MetreArray

    @property
    def ridges(self) -> int:
        """Number of ridges, a cut one too."""
        return int(self.begin.size)

    @property
    def says(self) -> str:
        """Words for the length that the study calls period."""
        grating = self.grating
        asked, period = (
            si.format_quantity(x, si.Unit("m"), 4) for x in (grating.spatial_period, grating.period)
        )
        if grating.period_means == "period":
            return f"'{grating.name}': the study's {asked} is the whole period, groove plus ridge"
        return f"'{grating.name}': the study's {asked} is the groove width; the period is {period}"


def board_of(grating: Grating) -> Board:
    """The board of a real grating: it begins with a ridge, and each period has its groove after it.

    Raises `InputError` for a board shorter than a period, or with too many ridges to draw.
    """
    count = math.ceil(grating.length / grating.period * (1 - 1e-12))
    require_within(_RIDGES, float(count), enough="make the board shorter or the period longer")
    if grating.length < grating.period:
        period, length = (
            si.format_quantity(one, si.Unit("m"), 4) for one in (grating.period, grating.length)
        )
        raise InputError(
            f"board '{grating.name}' of {length} holds no whole period of {period}; make it longer",
            quantity="length",
        )
    begin: si.MetreArray = grating.period * np.arange(count, dtype=float)
    ridge = grating.period * grating.ridge_share
    end: si.MetreArray = np.minimum(begin + ridge, grating.length)
    return Board(grating, ridge, grating.groove_width, begin, end)


def boards(design: StudyDesign) -> tuple[Board, ...]:
    """The boards of a design's real gratings. Raises `InputError` for a design without any."""
    if not design.alternatives:
        raise InputError(
            f"'{design.name}' is a study of {design.task} and compares with no real gratings, so "
            "that there are no boards to make; take a match-to-sample design"
        )
    return tuple(board_of(alternative) for alternative in design.alternatives)


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
    drawing = drawing_of(found)
    numbers = {
        "study": design.name,
        "tolerance_m": tolerance,
        "boards": [_numbers(board) for board in found],
        "provenance": stamp(design),
    }
    files: dict[str, str | bytes] = {
        "boards.png": style.png(sheet_figure(drawing)),
        "boards.dxf": dxf_text(drawing),
        **{f"board-{k + 1}.dxf": dxf_text(drawing_of((one,))) for k, one in enumerate(found)},
        "boards.json": json_text(numbers),
    }
    picture = '<img src="boards.png" alt="The boards from above, to scale">'
    title = escape(printable(f"{design.name}: boards of real gratings"))
    files["index.html"] = page(
        title,
        title,
        "for a workshop; lengths in millimetres in the DXF",
        section("What the study calls its lengths", bullets(board.says for board in found))
        + section("The boards", text_table(_CAPTION, *board_rows(found, tolerance)))
        + section("The boards, to scale", f'<figure class="scroll" tabindex="0">{picture}</figure>')
        + section("Files", f"<p>{links(name for name in files if name != 'boards.png')}</p>"),
        stamped(numbers["provenance"], "SHA-256 of the design") + ".",  # type: ignore[arg-type] # made above
    )
    return write_folder(folder, files)


def _numbers(board: Board) -> dict[str, object]:
    grating = board.grating
    return {
        "length_means": grating.period_means,
        "spatial_period_m": grating.period,
        **values_of(board, "ridge_width groove_width ridges"),
        **values_of(grating, "name ridge_height length width material"),
        "last_ridge_width_m": float(board.end[-1] - board.begin[-1]),
    }


_HEAD = ("Board", "Period", "Ridge", "Groove", "Ridges", "Ridge height", "Board size", "Material")
_CAPTION = (
    "Widths along the stroke. Errors of single ridges must not add up: the place of each is from "
    "the board's end, within the same tolerance. The tolerance is assumed unless asked for."
)


def board_rows(
    all_boards: tuple[Board, ...], tolerance: si.Metre
) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Head and rows of what is to be made, as texts."""
    within = f"± {shown(tolerance, M, 2)}"
    return _HEAD, [
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


def drawing_of(found: tuple[Board, ...]) -> Drawing:
    """The boards one above the other, with a ridge's and a period's dimension on each."""
    drawing, y = Drawing(_LAYERS, corner=(-_MARGIN, -_MARGIN)), 0.0
    for board in found:
        grating = board.grating
        drawing.rectangle("BOARD", 0.0, y, grating.length, grating.width)
        for begin, end in zip(board.begin.tolist(), board.end.tolist(), strict=True):
            drawing.rectangle("RIDGES", begin, y, end - begin, grating.width)
        top = y + grating.width
        for start, end, side in (
            (0.0, board.ridge_width, top),
            (board.ridge_width, grating.period, top + 3e-3),
            (0.0, grating.length, top + 6e-3),
        ):
            at = side + 4e-3
            drawing.dimension((start, side), (end, side), at, ((start + end) / 2, at + 1.5e-3))
        said = f"{grating.name}: ridges {1e6 * grating.ridge_height:g} um high"
        drawing.text(said, 0.0, y - 4e-3)
        y += grating.width + 1.5 * _GAP + 6e-3
    drawing.paper = max(board.grating.length for board in found) + 2 * _MARGIN, y + _MARGIN
    return drawing
