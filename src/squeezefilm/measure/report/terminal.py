"""What `measure check` and `measure fit` print."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import printable, shown
from squeezefilm.core.kit.terminal import bullets, heading, plain_console, table
from squeezefilm.measure.fits.by_kind import Fit
from squeezefilm.measure.fits.estimate import LEVEL, Adequacy, Estimate
from squeezefilm.measure.fits.friction.friction_curve import CurveComparison
from squeezefilm.measure.recordings.read import FolderCheck, RecordingCheck
from squeezefilm.measure.report.beside import MODELS_HEAD, inside_words, model_rows

_KNOWN = ("m", "Hz", "s", "N", "Pa", "V", "A", "W", "J", "F", "C", "S", "H", "m/V", "m/s", "N/m")


def show_check(check: RecordingCheck) -> None:
    """Print how a recording was read, and what is doubtful of it."""
    console = plain_console()
    heading(console, f"{check.recording.told.name} ({check.file.name})")
    table(console, ("", ""), check.facts, fixed=(0,))
    doubts = [("doubtful", text, "yellow") for text in check.doubts]
    bullets(console, doubts or [("", "Nothing doubtful was found.", "")])


def show_folder(found: FolderCheck) -> None:
    """Print the recordings of a folder, and what could not be read."""
    for check in found.checks:
        show_check(check)
    console = plain_console()
    if found.refused:
        heading(console, f"{len(found.refused)} could not be read")
        bullets(console, [("refused", one.why, "bold red") for one in found.refused])


def show_fit(check: RecordingCheck, fit: Fit, response: Fit | None = None) -> None:
    """Print the numbers of a fit with their intervals, and whether its model is adequate; of raw
    signals also those of the `response` that they give."""
    title = f"{check.recording.told.name} ({check.file.name}): {check.kind}"
    _show_one(title, fit)
    if response is not None:
        _show_one("The frequency response that these signals give", response)
    bullets(plain_console(), [("doubtful", text, "yellow") for text in check.doubts])


def _show_one(title: str, fit: Fit) -> None:
    console = plain_console()
    heading(console, title)
    if isinstance(fit, CurveComparison):
        table(console, MODELS_HEAD, model_rows(fit), fixed=(0,))
        bullets(console, [("", inside_words(fit), "")])
    elif rows := estimate_rows(fit):
        table(console, HEAD, rows, fixed=(0, 1))
    word, look = ("adequate", "green") if fit.adequacy.adequate else ("INADEQUATE", "bold red")
    bullets(console, [(word, fit.adequacy.sentence, look)])


HEAD = ("quantity", "value", si.percent(LEVEL) + " interval", "standard error")
_LEAST_DIGITS, _MOST_DIGITS = 3, 9


def estimate_rows(fit: Fit) -> list[tuple[str, ...]]:
    """The estimates of a fit: name, value, interval (with its level where that is no usual one),
    standard error; with so many digits that two of the standard error are seen."""
    rows: list[tuple[str, ...]] = []
    for name, one in estimates(fit):
        digits = _digits(one.value, one.standard_error)
        low, high = (valued(value, one.unit, digits) for value in one.interval)
        level = "" if one.level == LEVEL else f" ({si.percent(one.level)})"
        error = valued(one.standard_error, one.unit, 2)
        value = valued(one.value, one.unit, digits)
        rows.append((name, value, f"{low} to {high}{level}", error))
    return rows


def _digits(value: float, error: float) -> int:
    """How many significant digits of a value show two of its standard error."""
    if not (math.isfinite(value) and math.isfinite(error)) or value == 0 or error <= 0:
        return _LEAST_DIGITS
    wanted = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 2
    return min(max(wanted, _LEAST_DIGITS), _MOST_DIGITS)


def estimates(node: Any, path: str = "") -> Iterator[tuple[str, Estimate]]:
    """Every estimate below a dataclass by its name in words; members of lists are counted from
    1."""
    if isinstance(node, Estimate):
        yield path, node
    elif isinstance(node, Adequacy):
        return
    elif dataclasses.is_dataclass(node):
        for field in dataclasses.fields(node):
            if not field.name.startswith("_"):
                below = f"{path} {field.name}".strip().replace("_", " ")
                yield from estimates(getattr(node, field.name), below)
    elif isinstance(node, Mapping):
        for key, one in node.items():
            yield from estimates(one, f"{path} {key}")
    elif isinstance(node, tuple):
        for number, one in enumerate(node, 1):
            yield from estimates(one, f"{path} {number}" if len(node) > 1 else path)


def valued(value: float, unit: str, digits: int = 4) -> str:
    """A value of an estimate in its own unit, prefixed where that is read more easily."""
    if unit in ("", "1"):
        return f"{value:.{digits}g}"
    if unit in _KNOWN:
        return printable(shown(value, si.Unit(unit), digits))
    return f"{value:.{digits}g} {unit}"
