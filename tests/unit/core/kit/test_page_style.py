"""The style sheet has every colour on light, dark and paper; a page's head lets nothing else in."""

from __future__ import annotations

import re

from squeezefilm.core.kit.page_style import STYLE, page
from squeezefilm.core.kit.style import PALETTE


def variables(text: str) -> dict[str, str]:
    return dict(re.findall(r"--([a-z]+): (#[0-9a-f]{6});", text))


def test_light_dark_and_print_have_every_colour_of_the_palette() -> None:
    roots = re.findall(r":root \{ [^}]*\}", STYLE)
    assert len(roots) == 3
    light, dark, paper = (variables(root) for root in roots)
    named = {role: colors[0] for role, colors in PALETTE.items()}
    assert light == {**named, "page": "#f3f6f8"}
    assert dark == {**{role: one[1] for role, one in PALETTE.items()}, "page": "#0d1319"}
    # Ink is dear, and a dark screen says nothing of the paper.
    assert paper == {**named, "page": "#ffffff"}
    assert STYLE.index(roots[1]) > STYLE.index("prefers-color-scheme: dark") > STYLE.index(roots[0])
    assert STYLE.index(roots[2]) > STYLE.index("@media print") > STYLE.index(roots[1])


def test_every_colour_used_is_defined_and_braces_close() -> None:
    used = set(re.findall(r"var\(--([a-z]+)\)", STYLE))
    assert used <= {*PALETTE, "page"}
    assert {"ink", "page", "muted", "paper", "grid", "blue", "green", "orange", "band"} <= used
    assert STYLE.count("{") == STYLE.count("}")
    assert "{{" not in STYLE
    assert not re.search(r"url\(|@import|http", STYLE)


def test_a_head_opens_a_page_that_loads_nothing_from_elsewhere() -> None:
    head = page("a &lt; b", "", "", "", "").partition("<header>")[0]
    assert head.startswith('<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n')
    assert head.endswith("</style>\n</head>\n<body>\n")
    # The title is HTML already: not escaped a second time.
    assert "<title>a &lt; b</title>" in head
    assert (
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; '
        "style-src 'unsafe-inline'; img-src 'self' file:\">" in head
    )
    assert "script" not in head
    assert f"<style>{STYLE}\nfigure img {{ display: block;" in head
