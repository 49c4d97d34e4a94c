"""`write_play`: numbers, figures and a page of a session, beside its record."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from squeezefilm.report.kit import style
from squeezefilm.report.kit.folder import json_text, write_folder
from squeezefilm.report.kit.numbers import printable
from squeezefilm.report.kit.page_style import page_head, picture_sections, section
from squeezefilm.report.played import figures as draw
from squeezefilm.report.played.terminal import play_rows, play_warnings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.bench.play import PlayResult


def write_play(
    result: PlayResult, folder: Path, progress: Callable[[str], None] | None = None
) -> Path:
    """Write summary.json, figures and play.html into `folder`, where the record is.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    tell = progress or (lambda _: None)
    tell("figures")
    session = result.session
    figures = {
        "play-friction": ("Friction along the finger's way", draw.friction(session)),
        "play-amplitude": ("Amplitude", draw.amplitude(session)),
        "play-lateness": ("Lateness and lag", draw.lateness(session)),
    }
    files: dict[str, str | bytes] = {
        f"{name}.png": style.png(figure) for name, (_, figure) in figures.items()
    }
    files["summary.json"] = json_text(result.summary())
    there = {*files, *(one.name for one in folder.glob("*"))}
    beside = sorted(one for one in there if Path(one).suffix in (".sqft", ".csv", ".json"))
    files["play.html"] = _page(result, figures, beside)
    write_folder(folder, files)
    return folder / "play.html"


def _page(result: PlayResult, figures: dict[str, tuple[str, Figure]], files: list[str]) -> str:
    session = result.session
    title = escape(printable(session.setup.name))
    stamp = session.trace.metadata
    rows = "\n".join(
        f'<tr><th scope="row">{escape(a)}</th><td>{escape(b)}</td><td>{escape(printable(c))}</td>'
        "</tr>"
        for a, b, c in play_rows(result)
    )
    warned = "".join(f"<li>{escape(text)}</li>" for text in play_warnings(session))
    warnings = f"<ul>{warned or '<li>None.</li>'}</ul>"
    links = ", ".join(f'<a href="{escape(name)}">{escape(name)}</a>' for name in files)
    return f"""{page_head(f"{title}: a session")}
<header><h1>{title}</h1>
<p class="name">played on <code>{escape(printable(session.setup.display.name))}</code>,
drive <code>{escape(printable(str(stamp.get("drive", ""))))}</code>, by squeezefilm</p></header>
<main>
<section>
<h2>Numbers</h2>
<div class="scroll" tabindex="0" role="region" aria-label="Numbers"><table>
<caption>What the finger met, how late the loop was, what the link lost</caption><thead><tr>
<th scope="col">Quantity</th><th scope="col">Value</th><th scope="col">Remark</th></tr></thead>
<tbody>
{rows}
</tbody></table></div>
</section>
{picture_sections(figures)}{section("Warnings", warnings)}</main>
<footer><p>squeezefilm {escape(str(stamp.get("squeezefilm_version", "")))} ·
begun {escape(str(stamp.get("created_utc", "")))} (UTC) ·
SHA-256 of display, texture and settings <code>{escape(str(stamp.get("config_sha256", "")))}</code> ·
seed {escape(str(stamp.get("seed", "")))}. Beside this page: {links}.</p></footer>
</body>
</html>
"""  # noqa: E501
