"""Look of figures: one palette with a light and a dark value, one size, no global state.

A figure is drawn in the light colours. Each colour is a role with its own hex value, so that the
page can put a CSS variable in its place and the same SVG follows a dark screen.
"""

from __future__ import annotations

import contextlib
import functools
import io
import re
import textwrap
import unicodedata
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from html import escape
from typing import TYPE_CHECKING, Any, ParamSpec

import numpy as np

from squeezefilm.core.kit.numbers import unit_stays
from squeezefilm.core.kit.read_out import read_outs

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

    from squeezefilm.core.quantities import FloatArray

_P = ParamSpec("_P")

WIDTH = 9.6
"""Width of every figure in inches; on a page 1040 px wide, 10.5 pt then show as 15 px."""

# role: (light, dark). Hues after Okabe and Ito, darkened or lightened until a line has 3:1 and a
# text 4.5:1 on its background. No two light values may be equal: the page tells roles by them.
PALETTE: dict[str, tuple[str, str]] = {
    "ink": ("#1b2733", "#e8eef4"),
    "muted": ("#526170", "#a9b7c4"),
    "grid": ("#dbe1e7", "#313d49"),
    "paper": ("#fffffe", "#151c23"),
    "blue": ("#00639b", "#5cb8ec"),
    "orange": ("#b84700", "#ff9450"),
    "green": ("#007558", "#3ccf9f"),
    "purple": ("#96397a", "#e8a0cf"),
    "metal": ("#e2c9a6", "#7a6141"),
    "plus": ("#bfdcee", "#1d4c6c"),
    "minus": ("#f7cfb8", "#6b3a1e"),
    "skin": ("#f3dcd2", "#4d3a33"),
    "band": ("#e6eef4", "#22303c"),
}
INK, MUTED, GRID, PAPER = (PALETTE[name][0] for name in ("ink", "muted", "grid", "paper"))
BLUE, ORANGE, GREEN, PURPLE = (PALETTE[name][0] for name in ("blue", "orange", "green", "purple"))
METAL, PLUS, MINUS, SKIN, BAND = (
    PALETTE[name][0] for name in ("metal", "plus", "minus", "skin", "band")
)
# Curves differ in colour and in dashes, so that a grey print or a colour-blind eye tells them.
LINES: tuple[tuple[str, str | tuple[int, tuple[float, ...]]], ...] = (
    (BLUE, "-"),
    (ORANGE, (0, (6, 1.6))),
    (GREEN, (0, (5, 1.5, 1, 1.5))),
    (PURPLE, (0, (1.4, 1.2))),
)
# Looks of lines and points that figures share: `axes.plot(x, y, **style.WANTED)`.
WANTED: dict[str, Any] = {"color": ORANGE, "lw": 1.5, "ls": LINES[1][1]}
RENDERED: dict[str, Any] = {"color": BLUE, "lw": 1.7}
REFERENCE: dict[str, Any] = {"color": MUTED, "lw": 1.2, "ls": (0, (2, 2))}
GUIDE: dict[str, Any] = {"color": MUTED, "lw": 0.8, "ls": (0, (1.4, 1.2))}
ZERO: dict[str, Any] = {"color": MUTED, "lw": 0.8}
LANDMARK: dict[str, Any] = {"color": INK, "lw": 1, "ls": (0, (4, 2))}
ESTIMATE: dict[str, Any] = {"color": BLUE, "marker": "o", "ls": "", "ms": 7, "mec": PAPER}
INTERVAL: dict[str, Any] = {"color": MUTED, "lw": 1.4}
OUTLINED: dict[str, Any] = {"edgecolor": INK, "lw": 0.8}
BARS: dict[str, Any] = {"color": BAND, "edgecolor": MUTED}

_RC: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same on every machine
    "font.size": 10.5,
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
    "axes.titlecolor": MUTED,
    "axes.labelsize": 10.5,
    "axes.labelcolor": INK,
    "axes.edgecolor": MUTED,
    "axes.facecolor": "none",
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "figure.facecolor": "none",
    "figure.titlesize": 12.5,
    "figure.titleweight": "bold",
    "savefig.facecolor": "none",
    "legend.fontsize": 9.5,
    "legend.framealpha": 1.0,
    "legend.facecolor": PAPER,
    "legend.edgecolor": GRID,
    "legend.labelcolor": INK,
    "lines.linewidth": 1.9,
    "text.color": INK,
    # Names are user's text: a dollar in them is a dollar.
    "text.parse_math": False,
    "text.usetex": False,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 9.5,
    "ytick.labelsize": 9.5,
    "axes.unicode_minus": True,
    "axes.formatter.useoffset": False,
    # Outlines instead of a font's name: no machine can set the text wider than it was measured.
    "svg.fonttype": "path",
    "svg.hashsalt": "squeezefilm",
    "path.simplify": True,
    "path.simplify_threshold": 0.05,
}


def rc() -> AbstractContextManager[None]:
    """The style as a context: it holds while a figure is drawn or saved, and is then undone."""
    import matplotlib

    if matplotlib.rcParams["svg.hashsalt"] == _RC["svg.hashsalt"]:
        return contextlib.nullcontext()  # it holds: hundreds of settings need not be made again
    parameters: Any = {**matplotlib.rcParamsDefault, **_RC}
    # Figures are drawn without a backend; to name one would load pyplot.
    del parameters["backend"]
    return matplotlib.rc_context(parameters)


def drawn(draw: Callable[_P, Figure]) -> Callable[_P, Figure]:
    """A function that draws a figure, wrapped so that it draws in this style."""

    @functools.wraps(draw)
    def styled(*subject: _P.args, **how: _P.kwargs) -> Figure:
        with rc():
            figure = draw(*subject, **how)
            for axes in figure.axes:
                _plain_log(axes.xaxis)
                _plain_log(axes.yaxis)
        return figure

    return styled


def new_figure(title: str, model: str, height: float) -> Figure:
    """An empty figure with the message as its title and the model as its small print."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    padding = ConstrainedLayoutEngine(w_pad=0.08, h_pad=0.08, wspace=0.03, hspace=0.05)
    figure = Figure(figsize=(WIDTH, height), layout=padding)
    figure.suptitle(textwrap.fill(unit_stays(title), 90), x=0.012, ha="left")
    figure.supxlabel(
        textwrap.fill(f"Model: {model}", 125),
        x=0.012,
        ha="left",
        fontsize=8.5,
        color=MUTED,
    )
    return figure


def new_axes(title: str, model: str, height: float) -> tuple[Figure, Axes]:
    """A `new_figure`, and its only axes."""
    figure = new_figure(title, model, height)
    return figure, figure.subplots()


def panels(figure: Figure, count: int, columns: int) -> list[Axes]:
    """So many axes, row by row; what is left of the last row stays empty."""
    cells = figure.subplots(-(-count // columns), columns, squeeze=False).ravel()
    for spare in cells[count:]:
        spare.set_axis_off()
    return list(cells[:count])


def message_figure(title: str, message: str) -> Figure:
    """A figure that says why there is nothing to draw."""
    figure, axes = new_axes(title, "none", 1.9)
    axes.set_axis_off()
    axes.text(0.0, 0.5, textwrap.fill(message, 100), va="center", transform=axes.transAxes)
    return figure


def _plain_log(axis: Axis) -> None:
    """Plain numbers along a logarithmic axis: the style reads no mathematics in texts."""
    from matplotlib.ticker import FuncFormatter, LogFormatter, NullFormatter

    if isinstance(axis.get_major_formatter(), LogFormatter):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def friction_axes(axes: Axes, right: float | None = None, top: float = 1.04) -> None:
    """Axes of relative friction, up to `top`, over amplitude, up to `right` (µm)."""
    axes.set(xlim=(0, right), ylim=(0, top))
    axes.set(xlabel="vibration amplitude, zero-to-peak (µm)", ylabel="relative friction µ′/µ")


def estimate(axes: Axes, x: float, value: float, low: float, high: float, **look: Any) -> None:
    """A point with its interval; one that is not known is no line."""
    axes.plot([x, x], [low, high], **INTERVAL)
    axes.plot([x], [value], **ESTIMATE | look)


def seen_from_above(
    axes: Axes, values: FloatArray, low: tuple[float, float], high: tuple[float, float]
) -> AxesImage:
    """Values over a rectangle between two corners (m), shape (y, x), as an image."""
    (left, bottom), (right, top) = low, high
    ends = (1e3 * left, 1e3 * right, 1e3 * bottom, 1e3 * top)
    axes.grid(visible=False)
    axes.set(xlabel="x (mm)", ylabel="y (mm)")
    return axes.imshow(values, extent=ends, origin="lower", cmap="cividis", interpolation="nearest")


def motion_field(axes: Axes, x: FloatArray, y: FloatArray, w: FloatArray, **bar: Any) -> None:
    """Displacement over a face in two colours, nodal lines in black; `bar` as for its colorbar."""
    from matplotlib.ticker import MaxNLocator

    reach = float(np.max(np.abs(w)))
    field = axes.contourf(x, y, w, levels=np.linspace(-reach, reach, 21), cmap="RdBu_r")
    axes.contour(x, y, w, levels=[0.0], colors=INK, linewidths=1.2)
    ticks = MaxNLocator(nbins=6, symmetric=True)
    axes.figure.colorbar(field, ax=axes, ticks=ticks, **bar)


def legend_below(
    axes: Axes, columns: int = 2, gap: float = 0.16, handles: Sequence[Artist] | None = None
) -> None:
    """A legend under the axes, where it can hide no curve; `gap` in heights of the axes. `handles`
    are what it names, where that is not all that the axes have."""
    axes.legend(
        handles=axes.get_legend_handles_labels()[0] if handles is None else handles,
        loc="upper center",
        bbox_to_anchor=(0.5, -gap),
        ncols=columns,
        frameon=False,
    )


def legend_beside(axes: Axes) -> None:
    """A legend to the right of the axes, from their top down."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def legend_in(strip: Axes, drawn_in: Axes, columns: int = 3) -> None:
    """The legend of some axes in an empty strip of the figure."""
    strip.set_axis_off()
    handles, labels = drawn_in.get_legend_handles_labels()
    strip.legend(handles, labels, loc="center", ncols=columns, frameon=False)


def mark(
    axes: Axes,
    x: float,
    y: float,
    size: float,
    label: str | None = None,
    *,
    color: str = INK,
    clip_on: bool = False,
) -> None:
    """A diamond of a size (points) with a ring around it, above all lines: a working point."""
    look: dict[str, Any] = {"color": color, "ms": size, "mec": PAPER, "mew": 0.5 + 0.1 * size}
    axes.plot([x], [y], "D", zorder=5, clip_on=clip_on, label=label, **look)


def interval(axes: Axes, x: float, low: float, high: float) -> None:
    """A bar from low to high with a stroke across each end, under a working point."""
    axes.plot([x, x], [low, high], color=INK, lw=1.6, zorder=4)
    for end in (low, high):
        axes.plot([x], [end], "_", color=INK, ms=11, mew=1.6, zorder=4)


def micrometres_beside(axes: Axes, voltage: float, label: str) -> None:
    """A second axis on the right of one in nm/V: micrometres at a voltage (V)."""
    micro = 1e-3 * voltage
    right = axes.secondary_yaxis(
        "right", functions=(lambda v: np.multiply(v, micro), lambda v: np.divide(v, micro))
    )
    right.set_ylabel(label)


@functools.cache
def _known_characters() -> frozenset[int]:
    from matplotlib.font_manager import findfont, get_font

    # Titles are bold, and the bold face has fewer glyphs.
    fonts = (findfont("DejaVu Sans"), findfont("DejaVu Sans:bold"))
    known = [frozenset(get_font(font).get_charmap()) for font in fonts]
    return known[0] & known[1]


def plain(text: str, most: int = 28) -> str:
    """A user's text as a figure can show it: one line, at most so long, no unknown glyphs."""
    one_line = " ".join(
        "".join(" " if unicodedata.category(c)[0] == "C" else c for c in text).split()
    )
    known = _known_characters()
    shown = "".join(c if ord(c) in known else "□" for c in one_line)
    return shown if len(shown) <= most else shown[: most - 1].rstrip() + "…"


def svg(figure: Figure, prefix: str, label: str) -> str:
    """A figure as an SVG element to put into a page: no prolog, no references, its own ids.

    `prefix` starts every id, so that two figures on a page cannot be mixed up; `label` is read out
    in the figure's place. Colours of the palette become CSS variables ``--ink`` and so on.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG, RendererSVG

    stream = io.StringIO()
    with rc():
        canvas: Any = FigureCanvasSVG(figure)
        # As `print_svg` does, but what measures texts for the layout draws them too, and so
        # measures each once. (`savefig` even draws all of it twice.)
        dots, figure.dpi = figure.dpi, canvas.fixed_dpi
        drawn_by: Any = RendererSVG
        renderer = drawn_by(*figure.bbox.size, stream, image_dpi=dots)
        canvas.get_renderer = lambda: renderer
        figure.draw(renderer)
        spots = read_outs(figure)
        renderer.finalize()
    text = stream.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL)
    for before, after in (
        (' id="', f' id="{prefix}-'),
        (' xlink:href="#', f' href="#{prefix}-'),
        ("url(#", f"url(#{prefix}-"),
    ):
        text = text.replace(before, after)
    for role, (light, _) in PALETTE.items():
        text = text.replace(light, f"var(--{role})")
    box = re.search(r'viewBox="([^"]*)"', text)
    assert box is not None, "matplotlib's SVG has a viewBox"
    body = text[text.index(">") + 1 :].replace("</svg>", f"{spots}</svg>")
    return f'<svg viewBox="{box[1]}" role="img" aria-label="{escape(label)}">{body}'


def png(figure: Figure, dots_per_inch: float = 130) -> bytes:
    """A figure as a PNG on white, for documents and for looking at."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    stream = io.BytesIO()
    with rc():
        canvas: Any = FigureCanvasAgg(figure)
        # As `savefig` does, which first draws all of it once for nothing but its layout.
        before = {"dpi": figure.dpi, "facecolor": figure.get_facecolor()}
        figure.set(dpi=dots_per_inch, facecolor="white")
        canvas.print_png(stream)
        figure.set(**before)
    return stream.getvalue()
