"""The verb that recomputes claims: what it draws, and exit code 1 where a verdict changed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.e2e.program import run

from squeezefilm.cli.claims import reproduce

StandsIn = Callable[..., Any]


def reproduced(*changed: SimpleNamespace) -> SimpleNamespace:
    """All claims recomputed, as far as the verb looks at them."""
    return SimpleNamespace(changed=changed, summary=lambda: {"claims": []})


CHANGED = SimpleNamespace(
    claim=SimpleNamespace(name="two-micrometres", verdict="holds"), verdict="does not hold"
)


@pytest.fixture
def claims(stands_in: StandsIn, tmp_path: Path) -> SimpleNamespace:
    """What `reproduce` calls."""
    return SimpleNamespace(
        asked=stands_in("validation.command:reproduce", reproduced()),
        shown=stands_in("validation.report.page:show_claims"),
        page=stands_in("validation.report.page:write_reproduction", tmp_path / "index.html"),
        checkout=stands_in("core.kit.folder:checkout"),
        docs=stands_in(
            "validation.report.page:write_validation_docs", "docs/reference/validation.md"
        ),
    )


def test_claims_are_shown_without_figures_unless_asked(claims: SimpleNamespace) -> None:
    done = run(reproduce.__name__)
    assert done.returncode == 0, done.stderr
    assert claims.asked.named == {"prototype": False}
    assert claims.shown.given == (claims.asked.answer,)
    assert (done.stdout, done.stderr) == ("", "  a step …\n")
    assert claims.page.calls == claims.checkout.calls == claims.docs.calls == []


def test_a_page_and_the_docs_need_the_prototype(claims: SimpleNamespace, tmp_path: Path) -> None:
    done = run("reproduce", "--out", tmp_path)
    assert claims.asked.calls[-1][1] == {"prototype": True}
    assert claims.page.given == (claims.asked.answer, tmp_path)
    assert done.stdout == f"report: {tmp_path / 'index.html'}\n"
    assert claims.checkout.calls == []
    done = run("reproduce", "--write-docs")
    assert claims.asked.calls[-1][1] == {"prototype": True}
    assert len(claims.checkout.calls) == 1
    assert claims.docs.given == (claims.asked.answer,)
    assert "wrote docs/reference/validation.md\n" in done.stderr
    assert done.stdout == ""
    assert len(claims.page.calls) == 1


def test_json_is_all_that_is_printed(claims: SimpleNamespace, tmp_path: Path) -> None:
    done = run("reproduce", "--json", "--out", tmp_path)
    assert json.loads(done.stdout) == {"claims": []}
    assert done.stderr == ""
    assert claims.shown.calls == []


@pytest.mark.parametrize("options", [(), ("--json",)])
def test_a_changed_verdict_is_told_and_ends_with_1(
    options: tuple[str, ...], claims: SimpleNamespace
) -> None:
    claims.asked.answer = reproduced(CHANGED, CHANGED)
    done = run("reproduce", *options)
    assert done.returncode == 1
    told = "the verdict on 'two-micrometres' changed: holds is on record, does not hold was found\n"
    assert done.stderr.endswith(2 * told)


def test_measured_curves_are_compared_in_place_of_the_claims(
    claims: SimpleNamespace, stands_in: StandsIn, tmp_path: Path
) -> None:
    compared = stands_in("validation.published_friction:compare_folder", [])
    stands_in("validation.report.published:show_comparisons")
    done = run("reproduce", "--data", tmp_path)
    assert done.returncode == 0, done.stderr
    assert compared.given[0] == tmp_path
    refused = run("reproduce", "--data", tmp_path, "--write-docs")
    assert refused.returncode == 2
    assert "of --data published, of no other data" in refused.stderr
    assert len(compared.calls) == 1
    assert claims.asked.calls == claims.checkout.calls == []


def test_without_a_checkout_no_curve_is_compared_for_its_page(
    claims: SimpleNamespace, stands_in: StandsIn
) -> None:
    compared = stands_in("validation.published_friction:compare_folder", [])
    stands_in("validation.report.published:show_comparisons")
    page = stands_in("validation.report.published:write_friction_docs", "docs/friction.md")
    done = run("reproduce", "--data", "published", "--write-docs")
    assert done.returncode == 0, done.stderr
    assert len(claims.checkout.calls) == len(page.calls) == len(compared.calls) == 1
    assert "wrote docs/friction.md\n" in done.stderr
