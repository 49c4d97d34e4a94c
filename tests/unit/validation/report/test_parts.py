"""The same parts as Markdown, on a page and at a terminal."""

from __future__ import annotations

from tests.unit.printed import printed

from squeezefilm.validation.report.parts import Part, markdown_lines, page_section, show_parts

PART = Part("A < b", ["One.", "Two."], [(("x", "y"), [("1|2", "3")])])


def test_a_part_is_told_alike_everywhere() -> None:
    assert markdown_lines([PART, Part("None")]) == [
        "## A < b", "", "* One.", "* Two.", "", "| x | y |", "|---|---|", "| 1\\|2 | 3 |", "",
        "## None", "",
    ]  # fmt: skip
    html = page_section(PART)
    assert html.startswith("<section>\n<h2>A &lt; b</h2>\n<ul><li>One.</li><li>Two.</li></ul>")
    assert '<th scope="row">1|2</th><td>3</td>' in html
    lines = printed(lambda: show_parts([PART]))
    assert [line for line in lines if line] == ["A < b", "One.", "Two.", "x y", *lines[-1:]]
