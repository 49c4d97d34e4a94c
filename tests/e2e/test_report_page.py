"""The report in a real browser: quiet, whole and readable, light and dark, wide and narrow."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# One worker: the page is made once.
pytestmark = [pytest.mark.slow, pytest.mark.chromium]

FIGURES = ("friction", "response")
OPEN = "document.querySelectorAll('details').forEach(fold => fold.open = true)"


@pytest.fixture(
    scope="module",
    params=["biet2008-plate", pytest.param("biet2008-stator", marks=pytest.mark.nightly)],
)
def report(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    from squeezefilm.design.analysis.analyze import analyze
    from squeezefilm.design.analysis.report.page import write_analysis
    from squeezefilm.physics.display import load_display

    folder = tmp_path_factory.mktemp(str(request.param))
    return write_analysis(analyze(load_display(request.param), samples=8), folder)


@pytest.mark.parametrize("width", [1280, 1920])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_is_quiet_whole_and_fits(
    browser: Browser, report: Path, width: int, scheme: Any
) -> None:
    page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
    requests: list[str] = []
    complaints: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(report.as_uri())
    assert requests == [report.as_uri()]
    assert complaints == []
    page.evaluate(OPEN)
    for key in FIGURES:
        drawing = page.locator(f"#figure-{key} svg")
        assert drawing.is_visible(), key
        box = drawing.bounding_box()
        assert box is not None
        assert box["width"] > 600, key
        assert box["height"] > 100, key
        assert box["x"] >= 0, key
        assert box["x"] + box["width"] <= width, key
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate("document.title").endswith("squeezefilm report")
    page.close()


def test_the_cursor_reads_the_values_of_a_line(browser: Browser, report: Path) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.goto(report.as_uri())
    page.evaluate(OPEN)
    # The uppermost: measured points lie on the line's.
    spot = page.locator("#figure-friction g.read", has_text="vibration amplitude").last
    text = spot.locator("text")
    assert not text.is_visible()
    spot.locator("circle").hover(force=True)
    assert text.is_visible()
    assert re.fullmatch(
        r"vibration amplitude.*: [\d.]+, relative friction.*: [\d.]+", text.inner_html()
    )
    # Curves on one scale along x say its name, also those drawn over others.
    said = page.locator("#figure-friction g.read text").all_text_contents()
    assert not [words for words in said if words.startswith(":")]
    page.close()


def test_a_narrow_window_scrolls_figures_and_not_the_page(browser: Browser, report: Path) -> None:
    page = browser.new_page(viewport={"width": 400, "height": 800})
    page.goto(report.as_uri())
    page.evaluate(OPEN)
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
    page.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_contrast(browser: Browser, report: Path, scheme: Any) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme=scheme)
    page.goto(report.as_uri())
    page.evaluate(OPEN)
    # Of every element with text of its own: its colour and the first background behind it.
    pairs = page.evaluate(
        """() => [...document.querySelectorAll('body *')]
          .filter(e => !e.closest('svg') && e.checkVisibility() &&
            [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim()))
          .map(e => { let b = e, c;
            do { c = getComputedStyle(b).backgroundColor; b = b.parentElement; }
            while (b && c === 'rgba(0, 0, 0, 0)');
            return [getComputedStyle(e).color, c, e.textContent.trim().slice(0, 40)]; })"""
    )
    assert len(pairs) > 100
    for color, background, text in pairs:
        assert contrast(color, background) >= 4.5, f"{text!r}: {color} on {background}"
    dark = luminance(page.evaluate("getComputedStyle(document.body).backgroundColor")) < 0.1
    assert dark == (scheme == "dark")
    # Inside a figure the title follows the scheme as well.
    ink = page.evaluate(
        "getComputedStyle(document.documentElement).getPropertyValue('--ink').trim()"
    )
    used = page.evaluate(
        """() => [...document.querySelectorAll('#figure-friction svg [style*="--ink"]')]
          .map(e => getComputedStyle(e).fill)"""
    )
    assert used
    rgb = tuple(int(ink[i : i + 2], 16) for i in (1, 3, 5))
    assert f"rgb{rgb}" in used
    page.close()


def test_the_page_prints_on_white(browser: Browser, report: Path) -> None:
    page = browser.new_page(color_scheme="dark")
    page.emulate_media(media="print", color_scheme="dark")
    page.goto(report.as_uri())
    assert luminance(page.evaluate("getComputedStyle(document.body).backgroundColor")) > 0.99
    page.close()


def luminance(color: str) -> float:
    parts = [float(part) / 255 for part in re.findall(r"[\d.]+", color)[:3]]
    r, g, b = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def contrast(one: str, other: str) -> float:
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)
