"""What a figure shows, in words and numbers that a person can read and a test can compare.

Looks are left out: widths, sizes, transparency. A colour is named by its role in the palette.
"""

from __future__ import annotations

import contextlib
import inspect
import math
import re
from collections.abc import Iterator
from itertools import zip_longest
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.quiver import Quiver
from matplotlib.text import Annotation, Text
from matplotlib.ticker import FixedLocator, ScalarFormatter

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style

_ROLES = {light: role for role, (light, _) in style.PALETTE.items()}
_NUMBER = re.compile(r"(?<![#\w.])[-−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")
_TOLERANCE = 2e-3  # a number is written with four digits
_FEW = 12  # values that are written one by one


class Descriptions:
    """A file of descriptions of figures, in the order in which tests draw them, each once."""

    def __init__(self, file: Path) -> None:
        self._file = file
        text = file.read_text(encoding="utf-8") if file.exists() else ""
        self._known = [f"{part}\n" for part in text.rstrip("\n").split("\n\n") if part]

    def difference(self, now: str) -> str:
        """How a description differs from the most similar one that is known, if from all."""
        said = [difference(before, now) for before in self._known]
        if not said:
            return f"{self._file.name} describes no figure"
        return "" if "" in said else max(said, key=lambda text: int(text.split(":")[0][5:]))

    def add(self, now: str) -> None:
        """Write a description that is not known yet into the file."""
        if not self._known or self.difference(now):
            self._known.append(now)
            self._file.write_text("\n".join(self._known), encoding="utf-8")


@contextlib.contextmanager
def drawn_figures() -> Iterator[list[tuple[str, Figure]]]:
    """A list that gets every figure that is made meanwhile, and the function that draws it."""
    figures: list[tuple[str, Figure]] = []
    made = Figure.__init__

    def remembered(figure: Figure, *arguments: Any, **options: Any) -> None:
        figures.append((_function(), figure))
        made(figure, *arguments, **options)

    with mock.patch.object(Figure, "__init__", remembered):
        yield figures


def _function() -> str:
    """The function of the package that is asked for a figure, the kit's passed over."""
    frame = inspect.currentframe()
    while frame is not None:
        module = frame.f_globals["__name__"]
        if module.startswith("squeezefilm.") and module != style.__name__:
            return f"{module.removeprefix('squeezefilm.')}.{frame.f_code.co_name}"
        frame = frame.f_back
    return "a test"


def described(function: str, figure: Figure) -> str:
    """The description of a figure that a function drew, an artist a line."""
    width, height = figure.get_size_inches()
    lines = [f"{function}: {_text(figure.get_suptitle())}"]
    lines += [f"{_number(width)} × {_number(height)} inches"]
    lines += [f"small print: {_text(figure.get_supxlabel())}"]
    for axes in figure.axes:
        lines += _axes(axes)
    return "".join(f"{line.rstrip()}\n" for line in lines)


def difference(before: str, now: str) -> str:
    """The first lines of two descriptions that say another thing, or nothing; numbers may differ by
    0.2 %."""
    pairs = zip_longest(before.splitlines(), now.splitlines(), fillvalue="")
    for number, (old, new) in enumerate(pairs, 1):
        numbers = zip(_NUMBER.findall(old), _NUMBER.findall(new), strict=False)
        same = _NUMBER.sub("", old) == _NUMBER.sub("", new)
        if not same or not all(_alike(one, other) for one, other in numbers):
            return f"line {number}: described was\n  {old}\nand drawn is\n  {new}"
    return ""


def _alike(one: str, other: str) -> bool:
    a, b = (float(text.replace("−", "-")) for text in (one, other))
    return math.isclose(a, b, rel_tol=_TOLERANCE, abs_tol=_TOLERANCE if "." in one + other else 0)


def _number(value: float) -> str:
    return f"{value:.4g}"


def _text(text: str) -> str:
    return " ".join(text.split())


def _values(values: Any) -> str:
    """Few values, or how many there are, where they begin and end, their range, and what shares of
    it their mean and the mean of those that come late are."""
    array = np.ma.filled(np.ma.asarray(values, float), np.nan).ravel()
    known = array[np.isfinite(array)]
    scale = float(np.max(np.abs(known), initial=0.0))
    plain = np.where(np.abs(array) < 1e-9 * scale, 0.0, array)
    if array.size <= _FEW:
        return ", ".join(map(_number, plain))
    if not known.size:
        return f"#{array.size} without a value"
    low, high = float(known.min()), float(known.max())
    span = high - low
    if span <= 1e-9 * scale:
        return f"#{array.size} of {_number(high)}"
    shares = (known - low) / span
    late = float(np.linspace(0, 2, known.size) @ shares) / known.size
    missing = f", #{array.size - known.size} missing" if known.size < array.size else ""
    said = f"#{array.size} from {_number(low)} to {_number(high)} over {_number(span)}"
    first, last = shares[0], shares[-1]
    return f"{said}{missing}, {first:.3f} … {last:.3f}, mean {shares.mean():.3f}, {late:.3f}"


def _colour(colour: Any) -> str:
    if isinstance(colour, np.ndarray) and colour.ndim == 2:
        return " ".join(dict.fromkeys(_colour(row) for row in colour))
    name = to_hex(colour)
    return "none" if isinstance(colour, str) and colour == "none" else _ROLES.get(name, name)


def _axes(axes: Axes) -> Iterator[str]:
    if axes.get_label() == "<colorbar>":
        yield f"colours {_axis(axes._colorbar.long_axis)}"
        return
    spec = axes.get_subplotspec()
    place = ""
    if spec is not None:
        rows, columns, first, last = spec.get_geometry()
        place = f" #{first}{f' to #{last}' if last > first else ''} of #{rows} × #{columns}"
    titles = " ".join(filter(None, (_text(axes.get_title(loc)) for loc in ("left", "center"))))
    yield f"axes{place}: {titles}{'' if axes.axison else ' (off)'}"
    if axes.axison:
        for name, axis in axes._axis_map.items():
            yield f"  {name} {_axis(axis)}"
        if axes.get_aspect() != "auto":
            yield f"  aspect {axes.get_aspect()}"
    groups: dict[str, dict[str, list[Any]]] = {}
    for artist in axes.get_children():
        if artist.get_visible() and artist not in (axes.patch, *axes.spines.values()):
            said, numbers = _artist(axes, artist)
            group = groups.setdefault(said, {name: [] for name in numbers})
            for name, values in numbers.items():
                group[name].append(np.ma.filled(np.ma.asarray(values, float), np.nan).ravel())
    for said, gathered in groups.items():
        count = max((len(parts) for parts in gathered.values()), default=1)
        told = "; ".join(f"{name} {_values(np.concatenate(v))}" for name, v in gathered.items())
        if said:
            yield f"  {f'#{count} × ' if count > 1 else ''}{said}{': ' if told else ''}{told}"


def _axis(axis: Any) -> str:
    low, high = axis.get_view_interval()
    said = f'"{_text(axis.get_label_text())}" {_number(low)} … {_number(high)} {axis.get_scale()}'
    if axis.get_inverted():
        said += " inverted"
    shown = axis.get_tick_params()
    if not any(shown.get(f"label{side}") for side in ("left", "right", "bottom", "top")):
        said += " without labels"
    named = not isinstance(axis.get_major_formatter(), ScalarFormatter)
    if named or isinstance(axis.get_major_locator(), FixedLocator):
        places, labels = axis.get_ticklocs(), axis.get_ticklabels()
        ticks = zip(places, labels, strict=False)
        said += ": " + ", ".join(f"{_number(x)} {_text(label.get_text())}" for x, label in ticks)
    return said


def _artist(axes: Any, artist: Any) -> tuple[str, dict[str, Any]]:
    """What an artist is, and its numbers by name; those that are the same are told together."""
    label = str(artist.get_label() or "")
    name = f' "{_text(label)}"' if label and not label.startswith("_") else ""
    kind = type(artist).__name__
    where = "" if artist.get_transform() == axes.transData else " beside the axes' units"
    known: object = artist
    match known:
        case Line2D():
            marker = "" if artist.get_marker() == "None" else f" {artist.get_marker()}"
            line = "" if artist.get_linestyle() == "None" else f" {artist.get_linestyle()}"
            x, y = artist.get_data(orig=False)
            return f"line{name}, {_colour(artist.get_color())}{line}{marker}{where}", {
                "x": x, "y": y,
            }  # fmt: skip
        case Annotation():
            x, y = zip(artist.xy, artist.get_position(), strict=True)
            return f'note "{_text(artist.get_text())}"', {"x": x, "y": y}
        case Text():
            bold = ", bold" if artist.get_weight() == "bold" else ""
            if not artist.get_text() or artist in (axes.title, axes._left_title, axes._right_title):
                return "", {}
            return f'text "{_text(artist.get_text())}"{bold}{where}', {"at": artist.get_position()}
        case Legend():
            texts = ", ".join(_text(one.get_text()) for one in artist.get_texts())
            return f"legend in #{artist._ncols}, {texts}", {}
        case Patch():
            corners = artist.get_patch_transform().transform_path(artist.get_path()).vertices
            colour = _colour(artist.get_facecolor()) if artist.get_fill() else "hollow"
            return f"{kind}{name}, {colour}", {"x": corners[:, 0], "y": corners[:, 1]}
        case AxesImage():
            ends = {"within": artist.get_extent()}
            return f"{kind} from its {artist.origin} end, {_map(artist)}", _mapped(artist) | ends
        case QuadMesh():
            edges = artist.get_coordinates()
            ends = {"x": edges[..., 0], "y": edges[..., 1]}
            return f"{kind}, {_map(artist)}", _mapped(artist) | ends
        case ContourSet():
            return f"contours, {_map(artist)}", {"levels": artist.levels}
        case Quiver():
            return "arrows", {"x": artist.X, "y": artist.Y, "u": artist.U, "v": artist.V}
        case Collection():
            return f"{kind}{name}, {_map(artist)}", _mapped(artist) | _places(artist)
        case Axes():
            return " / ".join(_axes(artist)), {}
        case _:
            return "", {}


def _map(artist: Any) -> str:
    if artist.get_array() is not None:
        return str(artist.get_cmap().name)
    faces = artist.get_facecolor()
    return _colour(faces if len(faces) else artist.get_edgecolor())


def _mapped(artist: Any) -> dict[str, Any]:
    plain = artist.get_array() is None
    return {} if plain else {"colours": artist.get_clim(), "of": artist.get_array()}


def _places(artist: Any) -> dict[str, Any]:
    """Where the members of a collection are, or its corners."""
    offsets: si.Array = np.ma.filled(np.ma.asarray(artist.get_offsets(), float), np.nan)
    if np.any(offsets):
        return {"x": offsets[:, 0], "y": offsets[:, 1], "sizes": artist.get_sizes()}
    if hasattr(artist, "_vec"):
        return {"corners": artist._vec[:3]}
    points = np.concatenate([path.vertices for path in artist.get_paths()] or [np.zeros((0, 2))])
    return {"x": points[:, 0], "y": points[:, 1]}
