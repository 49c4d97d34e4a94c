"""Figures of how the vibrating body is built: plate, disc and ring."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import M, shown
from squeezefilm.design.plate.report.ring import FILL, draw_sector
from squeezefilm.physics.plate.laminate import section_with
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate, Face, RectangularPlate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.design.analysis.analyze import Analysis


_FACES: dict[Face, str] = {"bottom": "lower", "top": "upper"}
_SIGN = {1: "+", -1: "−"}


@style.drawn
def layout(analysis: Analysis) -> Figure:
    """The body to scale: plate with ceramics, or ring with waves."""
    actuator = analysis.display.actuator
    if isinstance(actuator, AnnularStator):
        return _ring(actuator, analysis)
    if isinstance(actuator, DiscPlate):
        return _disc(actuator, analysis)
    return _plate(actuator)


def _plate(plate: RectangularPlate) -> Figure:
    faces: list[Face] = [face for face in _FACES if plate.coverage_of(face) > 0]
    largest = max(plate.patches, key=lambda patch: patch.length * patch.width)
    above, below = plate.ceramics_at(largest.x + largest.length / 2, largest.y + largest.width / 2)
    neutral = section_with(plate, "plane_strain", above, below).neutral_axis - above
    plan_height = float(np.clip(6.9 * plate.width / plate.length, 1.0, 5.2 / len(faces)))
    figure = style.new_figure(
        f"{_covered(plate, faces)}; the plate bends about an axis {shown(neutral, M, 3)} "
        "below the touched face",
        "section and neutral axis through the largest ceramic; thicknesses and positions as "
        "described",
        len(faces) * (plan_height + 0.6) + 2.0,
    )
    heights = [plan_height] * len(faces)
    grid = figure.add_gridspec(
        len(faces) + 1, 2, width_ratios=[4.6, 1.2], height_ratios=[*heights, 0.55]
    )
    plans = [figure.add_subplot(grid[row, 0]) for row in range(len(faces))]
    for plan, face in zip(plans, faces, strict=True):
        _plan(plan, plate, face)
    side = figure.add_subplot(grid[-1, 0])
    _side(side, plate, neutral)
    _without_height(*plans, side)
    _section(figure.add_subplot(grid[:, 1]), plate, (above, below), neutral)
    return figure


def _covered(plate: RectangularPlate, faces: list[Face]) -> str:
    """How many ceramics cover how much of which face."""
    said = []
    for face in faces:
        count = sum(patch.face == face for patch in plate.patches)
        noun = "ceramic covers" if count == 1 else "ceramics cover"
        said.append(
            f"{count} {noun} {si.percent(plate.coverage_of(face))} of the {_FACES[face]} face"
        )
    return " and ".join(said)


def _plan(axes: Axes, plate: RectangularPlate, face: Face) -> None:
    """One face with its ceramics, x and y as the description has them."""
    through = ", seen through the plate" if face == "bottom" else ", which is touched"
    axes.set_title(f"{_FACES[face]} face{through}; + and − say how it follows the drive")
    length, width = 1e3 * plate.length, 1e3 * plate.width
    _box(axes, (0, 0), length, width, style.METAL)
    for patch in plate.patches:
        if patch.face != face:
            continue
        x, y, dx, dy = (1e3 * v for v in (patch.x, patch.y, patch.length, patch.width))
        _box(axes, (x, y), dx, dy, FILL[patch.polarity])
        # A sign needs some two percent of the picture to be read.
        if min(dx, dy) > 0.02 * length:
            sign = _SIGN[patch.polarity]
            axes.text(x + dx / 2, y + dy / 2, sign, ha="center", va="center", fontsize=15)
    pad = 0.015 * length
    axes.set(xlim=(-pad, length + pad), ylim=(-pad, width + pad), aspect="equal")
    axes.set(xlabel="x along the plate (mm)", ylabel="y (mm)")


def _side(axes: Axes, plate: RectangularPlate, neutral: float) -> None:
    """The plate from its long side, with the neutral axis at a depth (m) below the upper face."""
    axes.set_title("side view, to scale")
    length, thick = 1e3 * plate.length, 1e3 * plate.thickness
    _box(axes, (0, -thick), length, thick, style.METAL)
    for patch in plate.patches:
        height = 1e3 * patch.thickness
        low = 0.0 if patch.face == "top" else -thick - height
        _box(axes, (1e3 * patch.x, low), 1e3 * patch.length, height, FILL[patch.polarity])
    axes.axhline(-1e3 * neutral, color=style.ORANGE, lw=1.2, ls=(0, (5, 2)))
    above, below = (
        1e3 * max((patch.thickness for patch in plate.patches if patch.face == face), default=0.0)
        for face in ("top", "bottom")
    )
    pad, free = 0.015 * length, 0.5 * (thick + above + below)
    axes.set(xlim=(-pad, length + pad), ylim=(-thick - below - free, above + free), aspect="equal")
    axes.set(xlabel="x along the plate (mm)")


def _box(axes: Axes, corner: tuple[float, float], dx: float, dy: float, fill: str) -> None:
    """A filled rectangle with an outline."""
    from matplotlib.patches import Rectangle

    axes.add_patch(Rectangle(corner, dx, dy, facecolor=fill, **style.OUTLINED))


def _without_height(*views: Axes) -> None:
    """No grid on any view; the last, from the side, has no heights to read."""
    views[-1].set_yticks([])
    views[-1].spines["left"].set_visible(False)
    for axes in views:
        axes.grid(visible=False)


def _disc(disc: DiscPlate, analysis: Analysis) -> Figure:
    from matplotlib.patches import Circle

    radius, thick = 500 * disc.diameter, 1e3 * disc.thickness
    outer, inner = 500 * disc.ceramic_outer_diameter, 500 * disc.ceramic_inner_diameter
    ceramic, hole = 1e3 * disc.ceramic_thickness, 500 * disc.inner_diameter
    contact = 1e3 * analysis.display.finger.contact_length
    share = (outer**2 - inner**2) / (radius**2 - hole**2)
    figure = style.new_figure(
        f"A ceramic below covers {100 * share:.0f} % of the disc; a finger pad {contact:.3g} mm "
        f"wide touches {si.percent(contact / (2 * radius))} of its diameter",
        "thicknesses and diameters as described",
        5.6,
    )
    plan, side = figure.subplots(2, 1, height_ratios=[5, 1], sharex=True)
    plan.set_title("seen from above, the ceramic through the disc")
    faces = ((radius, style.METAL), (outer, style.PLUS), (inner, style.METAL), (hole, style.PAPER))
    for size, fill in faces:
        if size > 0:
            plan.add_patch(Circle((0, 0), size, facecolor=fill, **style.OUTLINED))
    _finger(plan, contact, 0.0)
    side.set_title("section, to scale")
    _box(side, (-radius, -thick), 2 * radius, thick, style.METAL)
    parts = ((-outer, -inner), (inner, outer)) if inner > 0 else ((-outer, outer),)
    for left, right in parts:
        _box(side, (left, -thick - ceramic), right - left, ceramic, style.PLUS)
    reach = 1.06 * max(radius, contact / 2)
    deep = thick + ceramic
    plan.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", ylabel="y (mm)")
    side.set(xlim=(-reach, reach), ylim=(-1.6 * deep, 0.6 * deep), aspect="equal")
    side.set(xlabel="x (mm)")
    _without_height(plan, side)
    style.legend_below(plan, gap=0.02)
    return figure


def _finger(axes: Axes, contact: float, y: float) -> None:
    """The contact's outline (mm) about x = 0, named for a legend."""
    from matplotlib.patches import Rectangle

    corner = (-contact / 2, y - contact / 2)
    name = f"finger contact, {contact:.3g} mm × {contact:.3g} mm"
    look: dict[str, Any] = {"facecolor": "none", "edgecolor": style.ORANGE, "lw": 2.2}
    axes.add_patch(Rectangle(corner, contact, contact, **look, zorder=3, label=name))


def _section(
    axes: Axes, plate: RectangularPlate, ceramics: tuple[float, float], neutral: float
) -> None:
    """The layers through the thickness, with `ceramics` (m) above and below, and the neutral axis
    at a depth (m) below the upper face."""
    thick, above, below = (1e3 * height for height in (plate.thickness, *ceramics))
    axes.set_title("section, enlarged")
    for top, height, fill, name in (
        (-above, above, style.PLUS, plate.ceramic.name),
        (0.0, thick, style.METAL, plate.substrate.name),
        (thick, below, style.PLUS, plate.ceramic.name),
    ):
        if not height:
            continue
        _box(axes, (0, top), 1, height, fill)
        # Named at the edge that the neutral axis is further from, so that it crosses no name.
        middle = top + height / 2
        place = middle - 0.22 * height if 1e3 * neutral > middle else middle + 0.22 * height
        words = f"{style.plain(name, 16)}\n{height:.3g} mm"
        axes.text(0.5, place, words, ha="center", va="center", fontsize=8.5, linespacing=1.1)
    axes.axhline(1e3 * neutral, color=style.ORANGE, lw=1.6, ls=(0, (5, 2)), label="neutral axis")
    margin = 0.04 * (above + thick + below)
    axes.set(xlim=(0, 1), ylim=(thick + below + margin, -above - margin))
    axes.set(ylabel="depth below the touched face (mm)")
    axes.set_xticks([])
    axes.grid(visible=False)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.02), frameon=False, handlelength=1.6)


def _ring(ring: AnnularStator, analysis: Analysis) -> Figure:
    from matplotlib.patches import Circle

    waves = round(ring.wavelengths_around)
    radius, width = 500 * ring.mean_diameter, 1e3 * ring.radial_width
    contact = 1e3 * analysis.display.finger.contact_length
    figure = style.new_figure(
        f"{waves} waves of {shown(ring.wavelength, M)} stand on the ring; a finger pad covers "
        f"{contact / (500 * ring.wavelength):.2g} half waves",
        f"{analysis.prediction.mode.model}, the ring taken as smooth (its teeth are left out)",
        5.6,
    )
    axes = figure.subplots()
    outer = radius + width / 2
    _half_waves(axes, 2 * waves, radius, width)
    axes.add_patch(Circle((0, 0), radius, fill=False, ls=(0, (5, 3)), ec=style.MUTED, lw=1))
    _finger(axes, contact, radius)
    axes.annotate(
        "", (-radius, 0), (radius, 0), arrowprops={"arrowstyle": "<->", "color": style.INK, "lw": 1}
    )
    said = f"mean diameter\n{2 * radius:.4g} mm"
    axes.text(0, 0.03 * outer, said, ha="center", va="bottom", fontsize=9.5)
    _explain_ring(axes)
    reach = 1.06 * max(outer, radius + contact / 2)
    axes.set(xlim=(-reach, reach), ylim=(-1.06 * outer, reach), aspect="equal")
    axes.set(xlabel="x (mm)", ylabel="y (mm)")
    axes.grid(visible=False)
    return figure


def _half_waves(axes: Axes, count: int, radius: float, width: float) -> None:
    """The half waves on a ring of a mean radius and a width (mm), with their signs."""
    half = 180 / count
    for number in range(count):
        angle = 90 - number * 2 * half
        sign = 1 if number % 2 == 0 else -1
        draw_sector(axes, radius + width / 2, width, (angle - half, angle + half), sign)
        if count <= 60 and number:
            place, turn = radius + width / 4, math.radians(angle)
            x, y = place * math.cos(turn), place * math.sin(turn)
            size = float(np.clip(220 / count, 7, 14))
            axes.text(x, y, _SIGN[sign], ha="center", va="center", fontsize=size)


def _explain_ring(axes: Axes) -> None:
    """The signs, the lines and the finger in a legend beside the ring."""
    from matplotlib.patches import Patch

    said = (
        (style.PLUS, "+  half wave going up"),
        (style.MINUS, "−  half wave going down"),
        (style.PAPER, "lines between: nodal lines"),
    )
    signs = [Patch(facecolor=fill, edgecolor=style.INK, label=name) for fill, name in said]
    handles = [*signs, *axes.get_legend_handles_labels()[0]]
    axes.legend(handles=handles, loc="center left", bbox_to_anchor=(1.04, 0.5), frameon=False)


def drive_strip(axes: Axes, plate: RectangularPlate, reach: float) -> float:
    """The ceramics under the mode that they drive, a strip for each face that carries some, the
    upper face's first; the new bottom of the axes."""
    faces: list[Face] = [face for face in ("top", "bottom") if plate.coverage_of(face) > 0]
    high = -1.28 * reach
    for face in faces:
        low = high - 0.34 * reach
        for patch in plate.patches:
            if patch.face != face:
                continue
            x, dx, middle = 1e3 * patch.x, 1e3 * patch.length, (low + high) / 2
            _box(axes, (x, low), dx, high - low, FILL[patch.polarity])
            if patch.length > 0.02 * plate.length:
                sign = _SIGN[patch.polarity]
                axes.text(x + dx / 2, middle, sign, ha="center", va="center")
        if len(faces) > 1:
            name = f"{_FACES[face]} "
            axes.text(0, (low + high) / 2, name, ha="left", va="center", fontsize=8)
        high = low - 0.08 * reach
    return high - 0.05 * reach
