"""What the terminal shows of a search: whole sentences, nothing clipped at 80 columns."""

from collections.abc import Callable
from dataclasses import replace

import pytest
from tests.unit.design.search.report.made_search import made_search

from squeezefilm.design.search.report.figures import show_design, show_requirements

Printed = Callable[[], str]  # `printed` itself holds that no line is longer than 80 columns


def one_line(text: str) -> str:
    return " ".join(text.replace("–", " ").split())


@pytest.mark.parametrize("kinds", [{}, {"shapes": 2, "objectives": 3}])
def test_a_search_is_shown_whole(printed: Printed, kinds: dict[str, int]) -> None:
    found = made_search(**kinds)  # type: ignore[arg-type]
    show_design(found)
    shown = printed()
    assert "…" not in shown
    for member in found.front:
        assert shown.count(member.name) >= 2  # what it does, and what was chosen
    for part in (
        "The front: what each plate does",
        "The plate to build",
        "Beside biet2008-plate",
        "What each limit does",
        "How good the screening was",
        "What all of this assumes",
        "Spearman's ρ = ",
        "to compare",
    ):
        assert part in one_line(shown), part


def test_an_empty_front_says_what_to_do(printed: Printed) -> None:
    show_design(made_search(limits={"most_temperature_rise": 20.5}))
    shown = one_line(printed())
    assert "No plate meets the requirements" in shown
    assert "ease the one that most designs break" in shown
    assert "The nearest that was screened:" in shown
    assert "designs cannot be built: 9 ceramics on 83 mm are too short" in shown
    assert "The plate to build" not in shown


def test_a_search_stopped_before_anything_came_is_shown_too(printed: Printed) -> None:
    show_design(made_search(screened=0, solved=0, stopped=True))
    shown = one_line(printed())
    assert "The search was stopped" in shown
    assert "was not judged" in shown


def test_the_presets_are_listed_with_what_to_do(printed: Printed) -> None:
    show_requirements()
    shown = one_line(printed())
    assert "biet2008-plate" in shown
    assert "squeezefilm design NAME" in shown


def test_of_the_reasons_why_nothing_can_be_built_the_three_most_common_are_said(
    printed: Printed,
) -> None:
    found = made_search(limits={"most_temperature_rise": 20.5})
    reasons = ["too short", "too wide", "too deep", "too thin"]
    feasible = [one for one in found.screened if not one.reason]
    odd = [
        replace(feasible[k], reason=reason)
        for k, reason in enumerate(reason for n, reason in enumerate(reasons) for _ in range(5 - n))
    ]
    show_design(replace(found, screened=(*odd, *feasible[len(odd) :])))
    shown = one_line(printed())
    for count, reason in zip((5, 4, 3), reasons, strict=False):
        assert f"! {count} designs cannot be built: {reason}" in shown
    assert "too thin" not in shown
