"""How sure an actuator's answers are, on the terminal and on its page."""

from __future__ import annotations

from squeezefilm.actuators.analysis.drawn import DrawnAnswers
from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import shown
from squeezefilm.core.kit.page_style import as_html, section, text_table


def with_interval(found: DrawnAnswers, value: float, name: str, unit: si.Unit) -> str:
    """A value (in its unit) and what lies between 5 and 95 % of the draws of the answer `name`."""
    interval = found.intervals.get(name)
    said = shown(value, unit, 3)
    if interval is None:
        return said
    return f"{said} ({shown(interval[0], unit, 2)} to {shown(interval[2], unit, 2)})"


def drawn_words(found: DrawnAnswers) -> str:
    """What the intervals are, in sentences."""
    given = sum(one.origin == "given" for one in found.drawn)
    guessed = len(found.drawn) - given
    many = "all" if guessed == len(found.drawn) else f"{guessed} of them"
    ranges = "from ranges of the file"
    if guessed:
        ranges = f"{many} from ranges that are themselves assumed"
    said = (
        f"In brackets, 5 to 95 % of {found.count} draws (seed {found.seed}) of {len(found.drawn)} "
        f"uncertain values together, {ranges}."
    )
    if found.refused:
        said += (
            f" In {found.refused} of the draws the actuator does not work (most often: "
            f"{found.reason}); they are left out."
        )
    if not found.intervals:
        said += " Fewer than half work, and no interval is given."
    return said


def how_sure(found: DrawnAnswers) -> str:
    """The section of a page: what was drawn, from where, and why."""
    rows = [
        (
            one.path.split(".", 1)[-1].replace("_", " "),
            " to ".join(one.spread),
            one.source if one.origin == "given" else f"assumed: {one.source}",
        )
        for one in found.drawn
    ]
    table = text_table("What was drawn, evenly within these", ("value", "range", "why"), rows)
    return section("How sure that is", f"<p>{as_html(drawn_words(found))}</p>{table}")
