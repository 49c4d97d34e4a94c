"""Parts of pages: the style sheet, for light, dark and print, the head, sections, tables.

No file and no font comes from elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

from squeezefilm.core.kit import read_out, style
from squeezefilm.core.kit.numbers import NUMBERS, Row, printable, unit_stays

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _variables(which: int) -> str:
    return " ".join(f"--{role}: {colors[which]};" for role, colors in style.PALETTE.items())


STYLE = f"""
:root {{ color-scheme: light dark; {_variables(0)} --page: #f3f6f8; }}
@media (prefers-color-scheme: dark) {{ :root {{ {_variables(1)} --page: #0d1319; }} }}
@media print {{ :root {{ color-scheme: light; {_variables(0)} --page: #ffffff; }} }}
* {{ box-sizing: border-box; }}
body {{ margin: 0; background: var(--page); color: var(--ink);
  font: 16px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif;
  overflow-wrap: anywhere; }}
main, header, footer {{ max-width: 70rem; margin: 0 auto; padding: 0 1.25rem; }}
h1 {{ font-size: 1.75rem; line-height: 1.25; margin: 1.5rem 0 .25rem; }}
h2 {{ font-size: 1.25rem; margin: 0 0 .6rem; }}
.name, figcaption, footer, caption {{ color: var(--muted); }}
section, details {{ background: var(--paper); border: 1px solid var(--grid); border-radius: .5rem;
  padding: 1.1rem 1.25rem; margin: 1rem 0; }}
section section, details section {{ border: 0; padding: 0; }} summary {{ cursor: pointer; }}
summary h2 {{ display: inline; }} details[open] > summary {{ margin-bottom: .8rem; }}
.part {{ margin: 2.2rem 0 0; }} .part h2 {{ font-size: 1.45rem; }} .part p {{ margin: 0; }}
a {{ color: var(--blue); }}
figure {{ margin: 0; }}
figcaption {{ font-size: .92rem; margin-top: .5rem; max-width: 52rem; }}
.scroll {{ overflow-x: auto; }}
.scroll:focus-visible, summary:focus-visible {{ outline: 3px solid var(--blue); }}
svg {{ display: block; width: 100%; height: auto; }}
svg, .scroll img {{ min-width: 36rem; }}
{read_out.STYLE}
ul.verdict {{ list-style: none; margin: 0; padding: 0; }}
ul.verdict li {{ display: flex; gap: .9rem; padding: .55rem .8rem; margin: .5rem 0;
  border-left: .4rem solid; }}
ul.verdict b {{ flex: 0 0 5.2rem; }}
ul.verdict li span {{ min-width: 0; }}
.good {{ border-color: var(--green) !important; }} .good b {{ color: var(--green); }}
.limit {{ border-left-style: dashed !important; border-color: var(--blue) !important; }}
.limit b {{ color: var(--blue); }}
.doubt {{ border-left-style: double !important; border-color: var(--orange) !important; }}
.doubt b {{ color: var(--orange); }}
table {{ border-collapse: collapse; width: 100%; font-size: .95rem; }}
.subject th {{ color: var(--muted); font-weight: 400; padding-top: .9rem; }}
caption {{ text-align: left; padding-bottom: .4rem; }}
.heard {{ position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }}
th, td {{ text-align: left; vertical-align: top; padding: .32rem .8rem .32rem 0;
  border-bottom: 1px solid var(--grid); overflow-wrap: break-word; }}
th {{ font-weight: 600; }}
.assumed > * {{ background: var(--band); }}
.mark {{ font-weight: 700; }}
code {{ font-family: ui-monospace, "DejaVu Sans Mono", monospace; font-size: .9em; }}
footer {{ font-size: .9rem; padding-bottom: 2rem; }}
@media (max-width: 48rem) {{
  ul.verdict li, ul.verdict b {{ display: block; }}
  main {{ padding: 0 .5rem; }} section, details {{ padding: .9rem; }}
  table {{ font-size: .88rem; }} th, td {{ padding-right: .5rem; }}
}}
@media print {{
  body {{ font-size: 10.5pt; }}
  details::details-content {{ content-visibility: visible; display: block; height: auto; }}
  section, details {{ border: 0; padding: 0; margin: 0 0 1.2rem; }}
  section.figure, ul.verdict li, tr {{ break-inside: avoid; }}
  .part:not(:first-child) {{ break-before: page; }}
  svg, .scroll img {{ min-width: 0; }}
}}
"""


def page(
    window: str, title: str, name: str, body: str, foot: str, images: str = "'self' file:"
) -> str:
    """A whole page, of HTML already: the title of its window, its own, a line below that, its
    sections, its last lines.

    `images` says where pictures may be from: beside the page, "data:", or "" for nowhere. Scripts
    and anything from elsewhere are refused by its policy.
    """
    policy = "default-src 'none'; style-src 'unsafe-inline'"
    policy += f"; img-src {images}" if images else ""
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{window}</title>
<style>{STYLE}
figure img {{ display: block; width: 100%; height: auto; background: #fff; }}</style>
</head>
<body>
<header><h1>{title}</h1>
<p class="name">{name}</p></header>
<main>
{body}</main>
<footer><p>{foot}</p></footer>
</body>
</html>
"""


def stamped(stamp: Mapping[str, Any], digest: str, made: str = "made") -> str:
    """The version that made a page's numbers, when, and the digest of what, `digest` in words."""
    version, when, code = (
        escape(str(stamp.get(key, "")))
        for key in ("squeezefilm_version", "created_utc", "config_sha256")
    )
    return f"squeezefilm {version} ·\n{made} {when} (UTC) ·\n{digest} <code>{code}</code>"


def bullets(texts: Iterable[str], none: str = "None.") -> str:
    """A list of plain texts; `none` where there is none."""
    items = "".join(f"<li>{as_html(text)}</li>" for text in texts)
    return f"<ul>{items or f'<li>{none}</li>'}</ul>"


def links(names: Iterable[str]) -> str:
    """The files of these names beside the page."""
    return ", ".join(f'<a href="{escape(name)}">{escape(name)}</a>' for name in names)


def part(key: str, heading: str, text: str) -> str:
    """The beginning of a part of a page, under which its sections follow; HTML already."""
    said = f"\n<p>{text}</p>" if text else ""
    return f'<div class="part" id="part-{key}">\n<h2>{heading}</h2>{said}\n</div>\n'


def section(heading: str, body: str, kind: str = "") -> str:
    """A section of a class; heading and body are HTML already."""
    attribute = f' class="{kind}"' if kind else ""
    return f"<section{attribute}>\n<h2>{heading}</h2>\n{body}\n</section>\n"


def folded(heading: str, body: str) -> str:
    """A section that opens where its heading is asked for; printed it is open. HTML already."""
    return f"<details>\n<summary><h2>{heading}</h2></summary>\n{body}\n</details>\n"


_KINDS = {"good": "✓ Good", "limit": "△ Limit", "doubt": "? Doubt"}


@dataclass(frozen=True)
class FigureOf:
    """A figure of one type of result: its key, its heading on a page, what draws it.

    Attributes:
        reading: how it is read.
        file: its name beside a page, where that is not its key.
        has: true of a result that has it; of every one, unless said.
    """

    key: str
    heading: str
    draw: Callable[[Any], Figure]
    reading: str = ""
    file: str = ""
    has: Callable[[Any], object] = bool


Pictures = dict[str, tuple[str, "Figure"]]
"""Figures by the name of their file beside a page: heading and drawing."""


def drawn_figures(figures: Iterable[FigureOf], result: Any, prefix: str = "") -> Pictures:
    """The figures that a result has."""
    return {
        prefix + (figure.file or figure.key): (figure.heading, figure.draw(result))
        for figure in figures
        if figure.has(result)
    }


def verdict_list(findings: Iterable[tuple[str, str]]) -> str:
    """Sentences, each behind what it is: "good", "limit" or "doubt"; plain texts."""
    items = "\n".join(
        f'<li class="{kind}"><b>{_KINDS[kind]}</b><span>{as_html(text)}</span></li>'
        for kind, text in findings
    )
    return f'<ul class="verdict">\n{items}\n</ul>'


def figure_section(item: FigureOf, svg: str) -> str:
    """A figure, drawn as an SVG element, in its section with how it is read."""
    body = (
        f'<figure id="figure-{item.key}">\n<div class="scroll" tabindex="0" role="region" '
        f'aria-label="{escape(item.heading)}">{svg}</div>\n'
        f"<figcaption>{escape(item.reading)}</figcaption>\n</figure>"
    )
    return section(escape(item.heading), body, "figure")


def picture_files(figures: Pictures) -> dict[str, str | bytes]:
    """The pictures NAME.png that `picture_sections` shows."""
    return {f"{name}.png": style.png(figure) for name, (_, figure) in figures.items()}


def picture_sections(figures: Pictures) -> str:
    """A section for each picture NAME.png beside the page: its heading; its message is read out."""
    return "".join(
        section(
            escape(heading),
            f'<figure class="scroll" tabindex="0"><img src="{name}.png" '
            f'alt="{escape(" ".join(figure.get_suptitle().split()))}"></figure>',
        )
        for name, (heading, figure) in figures.items()
    )


def html_table(
    caption: str,
    head: Iterable[str],
    rows: Iterable[Sequence[str]],
    *,
    kinds: Iterable[str] = (),
    heard: bool = False,
) -> str:
    """A table of cells that are HTML already; the first cell of a row heads it.

    `kinds` are the rows' classes; a caption that repeats the heading above is only `heard`, by
    those who use a screen reader.
    """
    columns = "".join(f'<th scope="col">{cell}</th>' for cell in head)
    lines = "\n".join(
        f'<tr{f" class={kind!r}" if kind else ""}><th scope="row">{cells[0]}</th>'
        + "".join(f"<td>{cell}</td>" for cell in cells[1:])
        + "</tr>"
        for cells, kind in zip_longest(rows, kinds, fillvalue="")
    )
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{caption}"><table>'
        f"<caption{heard * ' class=heard'}>{caption}</caption><thead><tr>{columns}</tr></thead>\n"
        f"<tbody>\n{lines}\n</tbody></table></div>"
    )


def text_table(caption: str, head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table of plain texts; the first cell of a row heads it."""
    return html_table(as_html(caption), map(as_html, head), [[*map(as_html, row)] for row in rows])


def rows_section(heading: str, caption: str, rows: Iterable[Row]) -> str:
    """A section with quantities, values and remarks; plain texts but for the heading."""
    return section(heading, text_table(caption, NUMBERS, rows))


def as_html(text: str) -> str:
    """A plain text as HTML, in which a number keeps its unit beside it."""
    return escape(unit_stays(printable(text)))
