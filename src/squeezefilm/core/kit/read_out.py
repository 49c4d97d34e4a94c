"""Read-out under the cursor: the values along a figure's lines, without a script."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST, _RADIUS = 80, 5.0  # spots on a line, and their size (pt)
STYLE = """.read circle { fill: transparent; } .read text { display: none; font-size: 9px;
  fill: var(--ink); paint-order: stroke; stroke: var(--paper); stroke-width: 3px; }
.read:hover circle { fill: var(--orange); } .read:hover text { display: block; }"""


def read_outs(figure: Figure) -> str:
    """SVG of spots along the lines of a figure that was drawn at 72 dots per inch, and at the
    points of those without a line; the values at a spot show while the cursor is on it."""
    return "".join(_of_axes(axes, figure.bbox.height) for axes in figure.axes if axes.axison)


def _of_axes(axes: Axes, height: float) -> str:
    box, data = axes.get_window_extent(), axes.transData
    # Axes drawn over others have the scale along x in common, and its name stands once.
    alike = axes.get_shared_x_axes().get_siblings(axes)
    along_x = next((each.get_xlabel() for each in alike if each.get_xlabel()), "")
    spots = []
    for line in axes.get_lines():
        points = np.asarray(line.get_xydata(), dtype=float)
        # A mark that spans the axes has no values.
        if not all(line.get_transform().contains_branch_seperately(data)) or not len(points):
            continue
        path = data.transform(points)
        if line.get_linestyle() != "None" and np.isfinite(path).all():
            along = np.append(0.0, np.cumsum(np.hypot(*np.diff(path, axis=0).T)))
            at = np.linspace(0.0, along[-1], min(_MOST, 2 + int(along[-1] / (2 * _RADIUS))))
            path = np.column_stack([np.interp(at, along, path[:, k]) for k in (0, 1)])
        path = path[[box.contains(*place) for place in path]][:: 1 + len(path) // (2 * _MOST)]
        for (across, up), (x, y) in zip(path, data.inverted().transform(path), strict=True):
            said = f"{along_x}: {x:.4g}, {axes.get_ylabel()}: {y:.4g}"
            spots.append(
                f'<g class="read"><circle cx="{across:.1f}" cy="{height - up:.1f}" r="{_RADIUS}"/>'
                f'<text x="{box.x0 + 4:.0f}" y="{height - box.y1 + 11:.0f}">{escape(said)}</text>'
                "</g>"
            )
    return "".join(spots)
