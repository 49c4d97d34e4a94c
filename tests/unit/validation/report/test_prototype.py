"""The prototype's study in tables, sentences, a figure and a page, from numbers made up here."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex

from squeezefilm.core.kit import style
from squeezefilm.core.kit.style import BLUE, ORANGE
from squeezefilm.design.plate.solved import PlatePoint
from squeezefilm.validation.explanations import (
    MEASUREMENTS,
    Explanation,
    PrototypeStudy,
    Separation,
)
from squeezefilm.validation.report import page
from squeezefilm.validation.report.prototype import (
    comparison,
    explanation_table,
    identifiability,
    prototype_parts,
    sentences,
    separation_table,
)

pytestmark = pytest.mark.usefixtures("figures_as_described")

D31 = PlatePoint((8, 0), 33.55e3, 10.0, 160e-9, 60.0, 34.8920e3)
E31 = PlatePoint((8, 0), 35.6e3, 10.0, 80e-9, 60.0, 37.38e3)


def explained(name: str, **changes: Any) -> Explanation:
    values: dict[str, Any] = {
        "free": "its <mass>", "value": "1.5 GPa", "frequency": 30.503e3,
        "neighbour_ratios": (0.6, 0.8, 1.25), "open_shift": 0.0412, "amplitude": 1.5e-6,
        "quality_factor": 50.0, "quality_factor_for_measured": 46.4,
    }  # fmt: skip
    return Explanation(name, **{**values, **changes})


def apart(first: str, second: str, *values: float) -> Separation:
    return Separation(first, second, MEASUREMENTS, values)


# 30.5 of 33.55 kHz: a tenth less, 9.09 %.
STUDY = PrototypeStudy(
    D31, E31,
    (
        explained("first"), explained("second, printed e31", amplitude=1e-6, frequency=30.4939e3),
        explained("third", amplitude=2.5e-6, quality_factor=100.0),
    ),
    (
        apart("first", "second", 0.1, 2.1, 0.2, 9.0, 9.0),
        apart("first", "third", 0.5, 2.0, 1.0, 2.04, 0.0),
        apart("second", "third", 1.0, 1.0, 1.0, 2.0, 1.96),
    ),
)  # fmt: skip


def test_the_paper_stands_beside_both_data_sets() -> None:
    head, rows = comparison(STUDY)
    assert head == (
        "at 15 V, Q 60", "paper", "solved with d31", "solved with the printed e31",
    )  # fmt: skip
    table = {first: rest for first, *rest in rows}
    assert table == {
        "modal analysis, section 3.1.3": ["35.6 kHz", "33.55 kHz (−5.8 %)", "35.60 kHz (+0.0 %)"],
        "harmonic analysis, section 3.1.3": [
            "34.77 kHz", "33.55 kHz (−3.5 %)", "35.60 kHz (+2.4 %)",
        ],
        "measured, section 3.2.1": ["30.5 kHz", "33.55 kHz (+10.0 %)", "35.60 kHz (+16.7 %)"],
        # 15 V times 160 and 80 nm/V.
        "amplitude of the harmonic analysis": ["3.2 µm", "2.40 µm (−25 %)", "1.20 µm (−62 %)"],
        "amplitude measured (half of p-p)": ["1.15 µm", "2.40 µm (+109 %)", "1.20 µm (+4 %)"],
        "frequency with open terminals": ["–", "34.89 kHz (+4.0 %)", "37.38 kHz (+5.0 %)"],
    }  # fmt: skip


def test_an_explanation_says_what_else_it_predicts() -> None:
    head, rows = explanation_table(STUDY)
    assert head == (
        "explanation", "solved for", "(8,0)", "f(6,0) / f(8,0)", "f(7,0) / f(8,0)",
        "f(9,0) / f(8,0)", "open shift", "amplitude at 15 V", "Q for 1.15 µm",
    )  # fmt: skip
    assert rows[0] == (
        "first", "its <mass>: 1.5 GPa", "30.50 kHz", "0.6000", "0.8000", "1.2500", "+4.1 %",
        "1.50 µm (Q 50)", "46",
    )  # fmt: skip
    assert [one[0] for one in rows] == [one.name for one in STUDY.explanations]


def test_a_pair_is_told_apart_by_more_than_twice_what_can_be_measured() -> None:
    head, rows = separation_table(STUDY)
    assert head == ("pair", *MEASUREMENTS, "told apart by")
    assert rows == [
        ("first / second", "0.1", "2.1", "0.2", "9.0", "9.0",
         "f(7,0) / f(8,0), open-circuit shift, amplitude at known Q"),
        ("first / third", "0.5", "2.0", "1.0", "2.0", "0.0", "open-circuit shift"),
        ("second / third", "1.0", "1.0", "1.0", "2.0", "2.0", "none of these"),
    ]  # fmt: skip


def test_what_follows_is_counted() -> None:
    said = sentences(STUDY)
    assert said[0] == ("The prototype lies −9.1 % from the perfectly bonded plate with d31.")
    # 30.503 and 30.4939 kHz: 0.01 and 0.02 % from 30.5 kHz.
    assert said[1].startswith("3 different sets of parameters give 30.5 kHz within 0.02 %: one")
    assert said[2] == (
        "Assumed to be measurable: ratios of frequencies to 0.2 %, the open-circuit shift to 0.2 "
        "percentage points, an amplitude at known Q to 10 %; 2 times as much tells two "
        "explanations apart."
    )
    assert said[3] == (
        "Of 3 pairs 1 are told apart by the frequencies of neighbouring modes (f(6,0) / f(8,0), "
        "f(7,0) / f(8,0), f(9,0) / f(8,0)), 1 more by the open-circuit shift, 1 by none of these: "
        "second / third."
    )
    # At a Q of 60: 1.5 × 60/50 = 1.8, 1.0 × 60/50 = 1.2 and 2.5 × 60/100 = 1.5 µm.
    assert said[4].startswith("For a Q of 60 the explanations predict 1.20 to 1.80 µm at 15 V; ")
    assert len(said) == 7


def test_no_pair_alike_is_said() -> None:
    study = dataclasses.replace(STUDY, separations=STUDY.separations[:2])
    assert sentences(study)[3].endswith("1 more by the open-circuit shift, 0 by none of these.")


def test_the_document_has_each_table_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page, "_parts", lambda study: prototype_parts(study))
    lines = page.validation_markdown(STUDY).splitlines()  # type: ignore[arg-type]
    assert [line for line in lines if line.startswith("#")] == [
        "# Validation",
        "## The plate: the paper, the solved plate, the prototype",
        "### What one frequency cannot tell",
    ]  # fmt: skip
    for head, rows in (
        comparison(STUDY), explanation_table(STUDY), separation_table(STUDY),
    ):  # fmt: skip
        start = lines.index("| " + " | ".join(head) + " |")
        assert lines[start - 1] == ""
        assert lines[start + 1] == "|" + "---|" * len(head)
        for number, one in enumerate(rows):
            assert lines[start + 2 + number] == "| " + " | ".join(one) + " |"
    assert [line[2:] for line in lines if line.startswith("* ")] == sentences(STUDY)


def test_each_panel_shows_every_explanation_with_what_could_be_resolved() -> None:
    figure = identifiability(STUDY)
    assert figure.get_suptitle().startswith("3 explanations of 30.5")
    panels = figure.axes
    assert len(panels) == 5
    assert [axes.get_xlabel() for axes in panels] == [
        *MEASUREMENTS[:3], "open shift (%)", "15 V, Q 60 (µm)",
    ]  # fmt: skip
    expected = [
        ([0.6] * 3, [0.0012] * 3), ([0.8] * 3, [0.0016] * 3), ([1.25] * 3, [0.0025] * 3),
        ([4.12] * 3, [0.2] * 3), ([1.8, 1.2, 1.5], [0.18, 0.12, 0.15]),
    ]  # fmt: skip
    for axes, (values, errors) in zip(panels, expected, strict=True):
        bars = axes.containers
        assert len(bars) == 3
        for number, bar in enumerate(bars):
            point, _, (span,) = bar
            # The first explanation on top.
            assert float(point.get_xdata()[0]) == pytest.approx(values[number])
            assert float(point.get_ydata()[0]) == 2 - number
            ends = np.asarray(span.get_segments()[0])[:, 0]
            assert ends == pytest.approx(
                [values[number] - errors[number], values[number] + errors[number]]
            )
            assert to_hex(point.get_color()) == (ORANGE if number == 1 else BLUE)
        low, high = axes.get_ylim()
        assert low < 0 < 2 < high
    labels = [one.get_text() for one in panels[0].get_yticklabels()]
    assert labels == [f"{one.name}\n{one.free}: {one.value}" for one in STUDY.explanations]
    assert list(panels[0].get_yticks()) == [2, 1, 0]
    # What was measured stands beside the amplitudes.
    (measured,) = [line for line in panels[-1].get_lines() if line.get_linestyle() == "--"]
    assert np.asarray(measured.get_xdata()) == pytest.approx([1.15, 1.15])
    assert [text.get_text() for text in panels[-1].texts] == ["measured,\nQ unknown"]


def test_the_page_has_the_figure_and_all_tables(monkeypatch: pytest.MonkeyPatch) -> None:

    drawn: list[tuple[Any, ...]] = []

    def drawing(figure: Any, prefix: str, label: str) -> str:
        drawn.append((figure.get_suptitle(), prefix, label))
        return f"<svg>{prefix}</svg>"

    # What a drawing looks like as SVG is the style's own business, and takes its time.
    monkeypatch.setattr(style, "svg", drawing)
    first, third = (page._html(part) for part in prototype_parts(STUDY))
    assert [one[1:] for one in drawn] == [("drawn", "What one frequency cannot tell")]
    assert "<h2>The plate: the paper, the solved plate, the prototype</h2>" in first
    assert '<figure><div class="scroll" tabindex="0"><svg>drawn</svg></div></figure>' in third
    assert [one.count("<table>") for one in (first, third)] == [1, 2]
    third = third.replace("\u00a0", " ").replace(' scope="col"', "").replace(' scope="row"', "")
    assert "<thead><tr><th>explanation</th><th>solved for</th><th>(8,0)</th>" in third
    assert "<tr><th>first</th><td>its &lt;mass&gt;: 1.5 GPa</td><td>30.50 kHz</td>" in third
    assert third.index("<svg>") < third.index("<th>explanation") < third.index("Distance of each")
    assert third.index("Distance of each") < third.index("<th>pair</th>")
    assert third.count("<li>") == len(sentences(STUDY))
    for section in (first, third):
        assert section.startswith("<section>\n<h2>")
        assert section.endswith("</section>\n")
