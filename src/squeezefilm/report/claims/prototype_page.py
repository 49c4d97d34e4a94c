"""The prototype's sections of the reproduction page."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import TYPE_CHECKING

from squeezefilm.report.claims.prototype import (
    Table,
    comparison,
    explanation_table,
    identifiability,
    sensitivity_table,
    sentences,
    separation_table,
)
from squeezefilm.report.kit import style
from squeezefilm.report.plate.sensitivity_figures import tornado

if TYPE_CHECKING:
    from squeezefilm.analysis.claims.prototype import PrototypeStudy


def prototype_sections(study: PrototypeStudy) -> list[str]:
    """HTML sections: the comparison, the sensitivities, what would identify the cause."""
    words = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences(study))
    parts = (
        ("The plate: the paper, the solved plate, the prototype", _table(comparison(study))),
        (
            "What could shift the frequency",
            _drawing(style.svg(tornado(study.sensitivities), "tornado", "Sensitivities"))
            + _table(sensitivity_table(study)),
        ),
        (
            "What one frequency cannot tell",
            f"<ul>{words}</ul>"
            + _drawing(style.svg(identifiability(study), "identifiability", "Identifiability"))
            + _table(explanation_table(study))
            + "<p>Distance of each pair, in units of what could be measured:</p>"
            + _table(separation_table(study)),
        ),
    )
    return [f"<section><h2>{escape(title)}</h2>{body}</section>" for title, body in parts]


def _drawing(drawing: str) -> str:
    return f'<figure><div class="scroll" tabindex="0">{drawing}</div></figure>'


def html_row(cells: Iterable[str]) -> str:
    """A row of a table of plain texts."""
    return "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>"


def _table(table: Table) -> str:
    head, rows = table
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join(map(html_row, rows))
    return (
        f'<div class="scroll" tabindex="0"><table><thead><tr>{top}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )
