"""Room for labels and legends around the axes of a figure, measured once.

Matplotlib's own layout measures each of the axes twice each time that a figure is drawn, since the
numbers along an axis, and a legend below, can change when the axes change their size. Here the
second time gives what the first one found, so that only the first costs anything. Axes begin above
the room of a legend (`figure.subplot.bottom` in the style): higher than they end, so that what was
measured is rather too much than too little.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.spines import Spine
from matplotlib.transforms import Bbox

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class MeasuredOnce(ConstrainedLayoutEngine):
    """Constrained layout that measures what is around each of the axes once a drawing."""

    def execute(self, fig: Figure) -> Any:
        """Move and resize the figure's axes so that nothing overlaps."""
        # Axes of a fixed shape leave room of which matplotlib makes use the second time.
        if any(axes.get_aspect() != "auto" for axes in fig.axes):
            return super().execute(fig)
        with _measured_once(fig):
            return super().execute(fig)


@contextmanager
def _measured_once(figure: Figure) -> Iterator[None]:
    """Within, each of the figure's axes has its own `get_tightbbox`, which remembers."""
    every: list[Any] = list(figure.axes)
    for axes in every:
        axes.get_tightbbox = _remembered(figure, axes)
    try:
        yield
    finally:
        for axes in every:
            del axes.get_tightbbox


def _remembered(figure: Figure, axes: Axes) -> Callable[..., Bbox | None]:
    """What is drawn of these axes, as a box: measured once, then moved along with the axes."""
    measure: Callable[..., Bbox | None] = axes.get_tightbbox
    found: list[tuple[float, float, float, float] | None] = []

    def box(renderer: Any = None, **options: Any) -> Bbox | None:
        here = axes.get_position(original=True).transformed(figure.transFigure)
        if not found:
            # Spines lie on the edge of the axes, which are measured anyhow.
            parts = axes.get_default_bbox_extra_artists()
            parts = [part for part in parts if not isinstance(part, Spine)]
            whole = measure(renderer, bbox_extra_artists=parts, **options)
            around = None
            if whole is not None:
                around = (
                    whole.x0 - here.x0,
                    whole.y0 - here.y0,
                    whole.x1 - here.x1,
                    whole.y1 - here.y1,
                )
            found.append(around)
        if found[0] is None:
            return None
        left, bottom, right, top = found[0]
        return Bbox.from_extents(here.x0 + left, here.y0 + bottom, here.x1 + right, here.y1 + top)

    return box
