"""Where a friction is meant, and its range over the active area, as rows of a table."""

from __future__ import annotations

from squeezefilm.analysis.area_odds import JudgedArea
from squeezefilm.chain.active_area import CRITERIA, percent
from squeezefilm.chain.pad_place import place_words
from squeezefilm.chain.prediction import Prediction


def place_rows(p: Prediction, judged: JudgedArea | None) -> list[tuple[str, str, str]]:
    """Where the friction is meant, and what it is over the active area: quantity, value, remark."""
    where = place_words(p.place)
    said = p.place_said.replace(f"{where}, ", "").replace(f", {where}", "")
    rows = [("Place of the finger", where, said)]
    area = None if judged is None else judged.area
    if area is None or area.best_place is None or area.worst_place is None:
        return [
            *rows,
            ("µ′/µ over the active area", "not known", "" if area is None else area.why_not),
        ]
    places = f"at {place_words(area.best_place)} and {place_words(area.worst_place)}"
    shares = ", ".join(f"{percent(area.share_below(one))} below {one:.2f}" for one in CRITERIA)
    return [
        *rows,
        (
            "µ′/µ over the active area",
            f"{area.best:.3f} to {area.worst:.3f}",
            f"{places}; median {area.median:.3f}; {shares}",
        ),
    ]
