"""The claims as a document and as a page: each with what was printed, what was found, and why."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.folder import checkout
from squeezefilm.core.kit.page_style import as_html
from squeezefilm.design.analysis.paper_procedure import PaperDesign
from squeezefilm.design.analysis.published_claims import Claim, Erratum
from squeezefilm.validation.command import ClaimResult, Reproduction
from squeezefilm.validation.report import figures, page
from squeezefilm.validation.report.page import (
    design_sentences,
    validation_markdown,
    write_reproduction,
    write_validation_docs,
)
from squeezefilm.validation.report.prototype import Part
from squeezefilm.validation.values import ClaimValue

DESIGN = PaperDesign(
    lowest_frequency=20.56e3, longest_half_wavelength_euler=16e-3,
    longest_half_wavelength_timoshenko=15e-3, half_wavelengths=np.array([7.5e-3]),
    amplitudes=np.array([2e-6]), ceramics=5, length=59e-3, width=49e-3, area=28.91e-4,
    nodal_lines=6, half_wavelength=10.25e-3, resonance_frequency=36.78e3,
    required_amplitude=1.957e-6, contradictions=("one is not two", "a < b"),
)  # fmt: skip


def result(number: int, *values: float, relation: Any = "equals", **changes: Any) -> ClaimResult:
    claim = Claim(
        id=changes.pop("id", f"claim-{number}"), where=f"section {number}",
        statement=f"statement {number} <b>", printed=(2e-6,) * len(values),
        unit=changes.pop("unit", "m"), verdict="reproduces", why=f"why {number}",
        relation=relation, model=changes.pop("model", ""),
    )  # fmt: skip
    return ClaimResult(claim, ClaimValue(values, **changes), "misprint")


FOUND = Reproduction(
    results=(
        result(1, 2.5e-6, printed_formula_value=(2.5e-6,)),
        result(2, 2.5e-6, relation="above", printed_formula_value=(3e-6,), alternative=(4e-6,)),
        result(3, 2.5e-6, relation="at_least", note="as read", alternative=(4e-6,)),
        result(4, 2.5e-6, relation="at_most", note="as read"),
        result(5, 12.0, 13.0, id="squeeze-number-1", unit="1", printed_formula_value=(7.0, 8.125)),
    ),
    errata=(Erratum("eq 7", "a|b", "a&b|c", "because <i>"),),
    design=DESIGN,
)  # fmt: skip


def rows_of(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.startswith("| ")]


def test_the_document_has_a_row_for_each_claim() -> None:
    text = validation_markdown(FOUND)
    meanings, misprint, head, *claims, errata_head, erratum = rows_of(text)
    assert meanings == "| verdict | claims | what it says |"
    assert misprint.startswith("| misprint | 5 | the printed number comes out with")
    assert head == "| where | claim | printed | printed formula | recomputed | verdict |"
    assert claims == [
        "| section 1 | statement 1 <b> | 2 µm | – | 2.5 µm | **misprint** |",
        "| section 2 | statement 2 <b> | > 2 µm | 3 µm | 2.5 µm | **misprint** |",
        "| section 3 | statement 3 <b> | ≥ 2 µm | – | 2.5 µm | **misprint** |",
        "| section 4 | statement 4 <b> | ≤ 2 µm | – | 2.5 µm | **misprint** |",
        "| section 5 | statement 5 <b> | 2e-06 / 2e-06 | 7 1/m / 8.125 1/m | 12 / 13 | "
        "**misprint** |",
    ]
    assert errata_head == "| equation | printed | corrected | why |"
    # A bar would end the cell.
    assert erratum == "| eq 7 | a\\|b | a&b\\|c | because <i> |"
    assert text.count("\n|---|---|---|---|\n") == 1
    assert text.count("\n|---|---|---|\n") == 1
    assert text.count("\n|---|---|---|---|---|---|\n") == 1


def test_the_document_says_why_and_in_which_order() -> None:
    text = validation_markdown(FOUND)
    assert text.startswith("# Validation\n\nWritten by `squeezefilm reproduce --write-docs`")
    assert "which refutes all\nothers here" in text
    said = [line for line in text.splitlines() if line.startswith("* **")]
    assert said == [
        "* **statement 1 <b>** (misprint): why 1.",
        "* **statement 2 <b>** (misprint): why 2. *(another reading gives 4 µm)*",
        "* **statement 3 <b>** (misprint): why 3. *(another reading gives 4 µm; as read)*",
        "* **statement 4 <b>** (misprint): why 4. *(as read)*",
        "* **statement 5 <b>** (misprint): why 5.",
    ]
    headings = [line for line in text.splitlines() if line.startswith("## ")]
    assert headings == [
        "## What the verdicts say", "## Claims", "## The paper's design procedure",
        "## Errata of the paper",
    ]  # fmt: skip
    for sentence in design_sentences(DESIGN):
        assert f"\n* {sentence}\n" in text
    assert text.endswith("because <i> |\n")
    assert "\n\n\n" not in text


ASKED = Reproduction(
    results=(
        *FOUND.results,
        result(6, 3e-6, id="speed", model="partial-levitation", relation="at_most", note="slow"),
        result(7, 1e-6, id="speed", model="intermittent-contact", relation="at_most"),
    ),
    errata=FOUND.errata,
    design=DESIGN,
)


def test_directions_stand_model_by_model_with_what_each_misses() -> None:
    text = validation_markdown(ASKED)
    assert (
        "| Biet et al., section 6 | statement 6 <b> | partial-levitation | ≤ 2 µm | 3 µm | "
        "**misprint** |\n"
        "|  |  | intermittent-contact | ≤ 2 µm | 1 µm | "
        "**misprint** |\n" in text
    )
    assert "| section 6 |" not in text
    assert (
        "* **statement 6 <b>**\n"
        "    * partial-levitation (misprint): why 6. *(slow)*\n"
        "    * intermittent-contact (misprint): why 7.\n" in text
    )
    headings = [line for line in text.splitlines() if line.startswith("#")]
    assert headings[3:] == [
        "### Why", "## Directions of friction that others observed, model by model",
        "### Why, model by model", "## What measurements say and the models do not",
        "## The paper's design procedure", "## Errata of the paper",
    ]  # fmt: skip
    missed = text[text.index("## What measurements say") : text.index("## The paper's design")]
    assert "\n`partial-levitation`:\n\n* " in missed
    assert "the faster the finger slides (Vezzoli et al. 2017, part 1, abstract). In the" in missed


def test_the_procedure_is_told_step_by_step() -> None:
    assert design_sentences(DESIGN) == [
        "The frequency criterion σ ≥ 10 asks for at least 20.6 kHz.",
        "The mean explored area of 28.18 cm² takes 5 ceramics of 11 mm on a plate of 59 × 49 mm "
        "(28.9 cm²); the paper takes seven, 83 × 49 mm, without saying why.",
        "Such a plate works with 6 nodal lines at 36.8 kHz (Timoshenko beam), λ/2 = 10.2 mm, and "
        "needs 1.96 µm for a relative friction of 0.7 by the paper's model.",
        "Contradiction: one is not two.",
        "Contradiction: a < b.",
    ]


def test_the_document_is_written_into_a_checkout_only(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="needs a checkout of the source"):
        write_validation_docs(FOUND, tmp_path)
    (tmp_path / "docs").mkdir()
    with pytest.raises(InputError, match="needs a checkout of the source"):
        checkout(tmp_path)
    (tmp_path / "pyproject.toml").write_text("")
    path = write_validation_docs(FOUND, tmp_path)
    assert path == tmp_path / "docs" / "reference" / "validation.md"
    assert path.read_text(encoding="utf-8") == validation_markdown(FOUND)
    shutil.rmtree(tmp_path / "docs")
    with pytest.raises(InputError, match="needs a checkout of the source"):
        checkout(tmp_path)


def test_without_a_root_it_is_the_checkout_that_the_package_runs_from() -> None:
    assert Path(page.__file__).is_relative_to(checkout() / "src" / "squeezefilm")


def reproduction(folder: Path, found: Reproduction, monkeypatch: pytest.MonkeyPatch) -> str:
    # The figures take two whole analyses and have a test of their own.
    monkeypatch.setattr(
        figures, "reproduction_figures", lambda tell: tell("drawing") or [("5 < 6", "<svg>x</svg>")]
    )
    told: list[str] = []
    path = write_reproduction(found, folder, progress=told.append)
    assert told[0] == "drawing"
    assert path == folder / "reproduction.html"
    # A number and its unit stay in one line of the page.
    return path.read_text(encoding="utf-8").replace("\u00a0", " ")


def test_the_page_has_claims_figures_procedure_and_errata(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = reproduction(tmp_path / "new", FOUND, monkeypatch)
    assert (
        '<tr><th scope="row">section 2</th><td>statement 2 &lt;b&gt;</td><td>&gt; 2 µm</td>'
        "<td>3 µm</td><td>2.5 µm</td><td><b>misprint</b></td></tr>\n"
        '<tr><th scope="row">section 3</th>' in text
    )
    assert text.count('<tr><th scope="row">section') == 5
    assert (
        '<tr><th scope="row">eq 7</th><td>a|b</td><td>a&amp;b|c</td><td>because &lt;i&gt;</td></tr>'
        in text
    )
    assert (
        '<section class="figure">\n<h2>5 &lt; 6</h2>\n<figure><div class="scroll" tabindex="0">'
        "<svg>x</svg></div></figure>\n</section>" in text
    )
    assert (
        "<li><b>statement 3 &lt;b&gt;</b> (misprint): why 3. <em>(another reading gives 4 µm; "
        "as read)</em></li>" in text
    )
    for sentence in design_sentences(DESIGN):
        assert f"<li>{as_html(str(sentence))}</li>".replace("\u00a0", " ") in text
    assert "Directions" not in text
    places = [text.index(one) for one in ("<h2>Claims", "<h2>The paper", "<h2>Errata", "5 &lt; 6")]
    assert places == sorted(places)
    assert "the default model is fitted to it" in text
    # Nothing may be loaded from elsewhere.
    assert "default-src 'none'; style-src 'unsafe-inline'\"" in text
    data = json.loads((tmp_path / "new" / "claims.json").read_text(encoding="utf-8"))
    assert [one["id"] for one in data["claims"]][-1] == "squeeze-number-1"
    assert data["changed"] == [one.claim.id for one in FOUND.results]


def test_the_page_has_directions_where_they_were_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = reproduction(tmp_path, ASKED, monkeypatch)
    assert (
        '<tr><th scope="row">Biet et al., section 6</th><td>statement 6 &lt;b&gt;</td>'
        "<td>partial-levitation</td><td>≤ 2 µm</td><td>3 µm</td><td><b>misprint</b></td></tr>"
        in text
    )
    assert (
        "<li><b>statement 6 &lt;b&gt;</b><ul><li>partial-levitation (misprint): why 6. "
        "<em>(slow)</em></li><li>intermittent-contact (misprint): why 7.</li></ul></li>" in text
    )
    missed = "<h2>What measurements say and the models do not</h2>\n<p><code>partial-levitation"
    assert missed in text
    data = json.loads((tmp_path / "claims.json").read_text(encoding="utf-8"))
    assert [one["model"] for one in data["claims"]] == [
        *[None] * 5, "partial-levitation", "intermittent-contact",
    ]  # fmt: skip


def test_the_prototype_is_left_out_where_it_was_not_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study: Any = object()
    monkeypatch.setattr(page, "prototype_parts", lambda one: [Part("It", [f"{one is study}"])])
    monkeypatch.setattr(Reproduction, "summary", lambda _: {"provenance": {}})
    with_it = Reproduction(FOUND.results, FOUND.errata, DESIGN, study)
    assert "<h2>It</h2>\n<p>True</p>" in reproduction(tmp_path, with_it, monkeypatch)
    assert "<p>True</p>" not in reproduction(tmp_path, FOUND, monkeypatch)
    assert "why 5.\n\n## It\n\nTrue\n\n## The paper's" in validation_markdown(with_it)
