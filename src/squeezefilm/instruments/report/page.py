"""`write_play`: numbers, figures and a page of a session, beside its record."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.page_style import (
    bullets,
    drawn_figures,
    links,
    page,
    picture_files,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.instruments.report import figures as draw
from squeezefilm.instruments.report.terminal import play_rows, play_warnings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.instruments.bench.play import PlayResult


def write_play(
    result: PlayResult, folder: Path, progress: Callable[[str], None] | None = None
) -> Path:
    """Write summary.json, figures and play.html into `folder`, where the record is.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    tell = progress or (lambda _: None)
    tell("figures")
    figures = drawn_figures(draw.FIGURES, result.session, "play-")
    files = picture_files(figures)
    files["summary.json"] = json_text(result.summary())
    there = {*files, *(file.name for file in folder.glob("*"))}
    beside = sorted(name for name in there if Path(name).suffix in (".sqft", ".csv", ".json"))
    files["play.html"] = _page(result, figures, beside)
    write_folder(folder, files)
    return folder / "play.html"


def _page(result: PlayResult, figures: dict[str, tuple[str, Figure]], files: list[str]) -> str:
    session = result.session
    title = escape(printable(session.setup.name))
    stamp = session.trace.metadata
    numbers = text_table(
        "What the finger met, how late the loop was, what the link lost",
        ("Quantity", "Value", "Remark"),
        play_rows(result),
    )
    return page(
        f"{title}: a session",
        title,
        f"played on <code>{escape(printable(session.setup.display.name))}</code>,\n"
        f"drive <code>{escape(printable(str(stamp.get('drive', ''))))}</code>, by squeezefilm",
        section("Numbers", numbers)
        + picture_sections(figures)
        + section("Warnings", bullets(play_warnings(session))),
        f"{stamped(stamp, 'SHA-256 of display, texture and settings', 'begun')} ·\n"
        f"seed {escape(str(stamp.get('seed', '')))}. Beside this page: {links(files)}.",
    )
