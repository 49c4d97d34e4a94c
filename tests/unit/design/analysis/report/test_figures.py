"""Every figure of every display: labelled, with units, nothing cut off, no text on another."""

from __future__ import annotations

import itertools
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.kit import style
from squeezefilm.design.analysis.analysis import Analysis
from squeezefilm.design.analysis.report.figures import FIGURES, half_power

pytestmark = pytest.mark.usefixtures("figures_as_described")

PRESETS = ("biet2008-plate", "biet2008-stator", "winfield2007-tpad")
KEYS = ("friction", "response")
# The odd displays, each with the figures that its oddness can spoil.
ODD = {
    "one-ceramic": ("response",),
    "hostile-names": ("friction",),
    "no-voltage": ("response", "friction"),
    "floating": ("friction",),
    "off-resonance": ("response",),
    "not-driven": ("response",),
    "amplitude-given": ("response",),
    "many-nodes": ("friction",),
    "square": ("friction",),
    "five-surfaces": ("friction",),
    "small-ring": ("friction",),
    "printed-model": ("friction",),
}
OFTEN = {*PRESETS, "hostile-names", "no-voltage", "one-ceramic"}
"""Drawn at every run; the other odd ones at night."""


def _marks(name: str) -> list[pytest.MarkDecorator]:
    return [] if name in OFTEN else [pytest.mark.nightly]


CASES = [
    pytest.param(name, key, marks=_marks(name))
    for name, keys in [*((name, KEYS) for name in PRESETS), *ODD.items()]
    for key in keys
]


def test_the_report_has_its_figures_in_order() -> None:
    assert tuple(item.key for item in FIGURES) == KEYS


def drawn_texts(figure: Any) -> list[tuple[str, Any]]:
    """The texts that drawing a figure really puts down, with their boxes in pixels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Text

    FigureCanvasAgg(figure)
    drawn: dict[int, Any] = {}
    draw = Text.draw

    def recorded(text: Any, renderer: Any, *args: Any, **kwargs: Any) -> None:
        if text.get_visible() and text.get_text().strip():
            drawn[id(text)] = text
        draw(text, renderer, *args, **kwargs)

    with style.rc(), pytest.MonkeyPatch.context() as patch:
        # An axis makes labels for ticks beyond its ends too; only some get drawn.
        patch.setattr(Text, "draw", recorded)
        figure.canvas.draw()
        renderer = figure.canvas.get_renderer()
        return [
            (text.get_text(), Text.get_window_extent(text, renderer)) for text in drawn.values()
        ]


def figure_of(key: str) -> Any:
    """One of the report's figures."""
    return next(one for one in FIGURES if one.key == key)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "key"), CASES)
def test_texts_are_inside_the_figure_and_apart_and_axes_labelled(
    name: str, key: str, analysis_of: Callable[[str], Analysis]
) -> None:
    figure = next(one for one in FIGURES if one.key == key).draw(analysis_of(name))
    texts = drawn_texts(figure)
    width, height = figure.canvas.get_width_height()
    for text, box in texts:
        assert -1 <= box.x0 < box.x1 <= width + 1, f"{text!r} is cut off at a side"
        assert -1 <= box.y0 < box.y1 <= height + 1, f"{text!r} is cut off above or below"
    for (one, a), (other, b) in itertools.combinations(texts, 2):
        across = min(a.x1, b.x1) - max(a.x0, b.x0)
        down = min(a.y1, b.y1) - max(a.y0, b.y0)
        # A box is as tall as the tallest letter: a pixel or two of it is air.
        assert across < 2 or down < 2, f"{one!r} lies on {other!r} by {across:.0f} × {down:.0f}"
    for axes in figure.axes:
        if axes.axison:
            axis_is_labelled(axes.get_xlabel(), axes.xaxis)
            axis_is_labelled(axes.get_ylabel(), axes.yaxis)


def axis_is_labelled(label: str, axis: Any) -> None:
    if not any(tick.get_visible() and tick.get_text() for tick in axis.get_ticklabels()):
        return
    assert label, "an axis with numbers has no label"
    dimensionless = ("relative", "over ambient", "over the finger's")
    units = ("mm", "µm", "kHz", "nm/V", "mm/s")
    assert any(f"({unit})" in label for unit in units) or any(
        word in label for word in dimensionless
    ), label


@pytest.mark.parametrize("key", KEYS)
def test_every_figure_has_a_message_and_names_its_model(key: str, plate_analysis: Analysis) -> None:
    figure = next(one for one in FIGURES if one.key == key).draw(plate_analysis)
    assert len(figure.get_suptitle()) > 30
    assert "Model: " in figure.get_supxlabel()


def test_messages_tell_the_numbers_of_the_analysis(plate_analysis: Analysis) -> None:
    titles = {
        item.key: item.draw(plate_analysis).get_suptitle().replace("\u00a0", " ").replace("\n", " ")
        for item in FIGURES
    }
    assert "33.57 kHz is 556 Hz wide" in titles["response"]


@pytest.mark.slow
def test_the_response_says_when_the_drive_is_beside_it_or_in_vain(
    analysis_of: Callable[[str], Analysis],
) -> None:
    draw = figure_of("response").draw
    off = analysis_of("off-resonance").prediction
    share = off.touch.free_amplitude / (15 * off.mode.amplitude_per_volt)
    assert 0.4 < share < 0.7
    said = f"{100 * share:.0f}\u00a0% of the motion"
    assert said in draw(analysis_of("off-resonance")).get_suptitle()
    assert "do not drive the mode" in draw(analysis_of("not-driven")).get_suptitle()


@pytest.mark.slow
def test_svg_is_the_same_every_time(plate_analysis: Analysis) -> None:
    first, second = (
        style.svg(figure_of("response").draw(plate_analysis), "response", "label") for _ in range(2)
    )
    assert first == second


def test_svg_follows_the_palette_and_stands_alone(plate_analysis: Analysis) -> None:
    text = style.svg(figure_of("response").draw(plate_analysis), "response", 'a "label" <b>')
    assert "http" not in text
    assert "<metadata" not in text
    assert "var(--blue)" in text
    assert 'aria-label="a &quot;label&quot; &lt;b&gt;"' in text
    assert not any(light in text for light, _ in style.PALETTE.values())


def test_palette_has_contrast_on_light_and_dark() -> None:
    for which in (0, 1):
        paper = style.PALETTE["paper"][which]
        for role in ("ink", "muted", "blue", "orange", "green", "purple"):
            assert contrast(style.PALETTE[role][which], paper) >= 4.5, (role, which)
        for role in ("metal", "plus", "minus", "skin", "band"):
            assert contrast(style.PALETTE["ink"][which], style.PALETTE[role][which]) >= 4.5, role
    lights = [light for light, _ in style.PALETTE.values()]
    assert len(set(lights)) == len(lights)


def contrast(one: str, other: str) -> float:
    """The contrast ratio of two colours by WCAG."""

    def luminance(color: str) -> float:
        parts = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        r, g, b = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
        return 0.2126 * r + 0.7152 * g + 0.0722 * b

    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_half_power_band_of_a_resonance() -> None:
    frequency = np.linspace(90, 110, 4001)
    amplitude = 1 / np.abs(1 - (frequency / 100) ** 2 + 1j / 50)
    low, high = half_power(frequency, amplitude) or (0, 0)
    assert low == pytest.approx(100 * np.sqrt(1 - 1 / 50), rel=1e-5)
    assert high == pytest.approx(100 * np.sqrt(1 + 1 / 50), rel=1e-5)
    assert half_power(frequency, np.linspace(1, 2, 4001)) is None


def test_drawing_leaves_the_users_matplotlib_alone(plate_analysis: Analysis) -> None:
    import matplotlib

    before = dict(matplotlib.rcParams)
    style.svg(figure_of("response").draw(plate_analysis), "response", "label")
    assert dict(matplotlib.rcParams) == before


@pytest.mark.slow
def test_importing_the_report_room_loads_no_matplotlib() -> None:
    code = (
        "import sys, squeezefilm.cli, squeezefilm.design.analysis.report.page; "
        "import squeezefilm.core.kit.terminal, squeezefilm.design.analysis.report.figures; "
        "sys.exit(any(name in sys.modules for name in ('matplotlib', 'rich.table')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_users_text_is_made_fit_for_a_figure() -> None:
    assert style.plain("a\x1b[31m\nb 漢") == "a [31m b □"
    assert style.plain("long " * 20, 12) == "long long l…"
