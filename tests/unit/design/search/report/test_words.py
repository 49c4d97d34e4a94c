"""A search in words: what is not known is said so, and what is compared is compared rightly."""

import math
from dataclasses import replace
from typing import Any

import pytest
from tests.unit.design.search.report.made_search import made_search, requirements_of

from squeezefilm.design.search.candidate import Evaluated, design_of
from squeezefilm.design.search.criteria import CRITERIA, OF_SOLVED, Breach
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.limits import conflict_of, nearest_of
from squeezefilm.design.search.report import words
from squeezefilm.design.search.requirements import Requirements


@pytest.fixture(scope="module")
def found() -> DesignSearch:
    return made_search()


def test_values_that_are_none_are_said_in_words() -> None:
    assert CRITERIA["finest_period"].shown(math.inf) == "none"
    assert CRITERIA["neighbour"].shown(math.inf) == "none takes part"
    assert CRITERIA["power"].shown(None) == "not known"
    assert CRITERIA["deflection"].shown(math.nan) == "not known"
    assert CRITERIA["area"].shown(0.984) == "98 %"
    assert CRITERIA["resonance_frequency"].shown(21325.1) == "21.3 kHz"
    assert CRITERIA["squeeze_number"].limit_said(10.0) == "squeeze number at least 10"
    assert CRITERIA["temperature_rise"].limit_said(75.0) == "temperature rise at most 75 K"


def test_what_was_chosen_has_every_free_setting_with_its_unit(found: DesignSearch) -> None:
    requirements = found.requirements
    for member in found.front:
        said = words.chosen_words(requirements, member.evaluated.design)
        for variable in requirements.spaces[0].free:
            value = words.setting_words(variable, member.evaluated.design, requirements)
            assert value in said, variable.name
    assert "as described" not in said or "P1-91 (as described)" in said


def test_a_share_of_the_pitch_is_told_only_where_it_may_be_chosen() -> None:
    own = requirements_of()
    free, fixed = (
        replace(own, shapes=(replace(own.shapes[0], least_cover=least),)) for least in (0.5, 1.0)
    )
    shares = dict.fromkeys((one.name for one in free.spaces[0]), 0.5)
    design = design_of(0, free.spaces[0].at(shares))
    assert "ceramics cover 75 %" in words.chosen_words(free, design)
    assert "cover" not in words.chosen_words(fixed, design_of(0, fixed.spaces[0].at(shares)))


def test_several_shapes_are_told_apart() -> None:
    found = made_search(shapes=2, screened=80, solved=20)
    for one in found.solved:
        shape = found.requirements.spaces[one.design.shape].shape
        assert words.chosen_words(found.requirements, one.design).startswith(f"{shape}: ")


def test_what_the_reference_left_is_the_best_of_the_plates_no_worse_elsewhere(
    found: DesignSearch,
) -> None:
    said = words.reference_sentences(found)
    assert found.reference is not None
    own = found.reference.objectives(found.requirements.objectives)
    rows = found.objectives
    best = rows[rows[:, 1] <= own[1], 0].min()
    assert any(f"can be {best:.3g} in place of {own[0]:.3g}" in one for one in said), said
    count = len(found.beats_reference)
    assert said[-1].startswith(f"Of {len(found.front)} plates of the front {count} beat it")


def test_a_reference_that_nothing_beats_that_breaks_a_limit_or_is_not_there(
    found: DesignSearch,
) -> None:
    assert found.reference is not None
    numbers = {**found.reference.numbers, "relative_friction": 0.01, "finest_period": 1e-5}
    perfect = replace(found, reference=replace(found.reference, numbers=numbers))
    said = words.reference_sentences(perfect)
    assert any("no plate was found whose µ′/µ at the best place is below 0.01" in o for o in said)
    assert said[-1] == "No plate of the front is better than it in an objective and worse in none."
    strict = made_search(screened=60, solved=20, limits={"most_temperature_rise": 60.0})
    assert any(
        one.startswith("It breaks a limit: temperature rise is 73.8 K")
        for one in words.reference_sentences(strict)
    )
    stopped = made_search(screened=0, solved=0, stopped=True)
    assert "the search was stopped before" in words.reference_sentences(stopped)[0]
    alone = replace(found, requirements=replace(found.requirements, compare_with=""))
    assert words.reference_sentences(alone) == []


def test_the_chosen_plate_is_told_with_its_nearest_limits_and_its_yield(
    found: DesignSearch,
) -> None:
    said = " ".join(words.chosen_sentences(found))
    assert said.startswith(found.chosen_name)
    assert "Its nearest limits: " in said
    assert "53 % keep all limits but those on half-bandwidths to the nearest mode" in said
    assert "; limits broken: temperature rise in 30" in said
    member = replace(found.front[0], made=None)
    assert words.made_sentences(found.requirements, member) == [
        "How many plates made of its drawing keep the limits was not computed."
    ]
    assert words.front_row(found.requirements, member)[-1] == "not known"


def test_a_yield_names_the_limits_that_it_does_not_ask_of_what_is_made(found: DesignSearch) -> None:
    limits = found.requirements.limits

    def asking(**changed: Any) -> Requirements:
        return replace(found.requirements, limits=replace(limits, **changed))

    plain = asking(least_neighbour=None)
    (said,) = words.made_sentences(plain, found.front[0])
    assert "keep all limits;" in said
    assert not any("yield" in one for one in plain.assumed)
    sure = asking(least_neighbour=3.0, confidence="95 %")
    (said,) = words.made_sentences(sure, found.front[0])
    left_out = "µ′/µ with 95 % confidence and half-bandwidths to the nearest mode"
    assert f"keep all limits but those on {left_out}, which only a solved plate" in said
    assert sum("the yield asks nothing of" in one for one in sure.assumed) == 2


def test_effects_of_tolerances_have_their_size_and_sign(found: DesignSearch) -> None:
    head, rows = words.effect_table(found.requirements, found.front[0])
    assert rows[0][0] == "thickness of the sheet +20 µm"
    assert rows[0][1:] == ("+160 Hz", "+0.001", "not known")
    assert rows[1][1:] == ("none", "−0.022", "not known")
    assert len(rows[0]) == 1 + len(head)


def test_limits_that_nothing_breaks_share_a_sentence_and_the_dear_one_is_named(
    found: DesignSearch,
) -> None:
    said = words.limit_sentences(found)
    broken = [one for one in found.limits if one.broken]
    idle = [one for one in found.limits if not one.broken]
    shared = {one.key in OF_SOLVED for one in idle}
    assert len(said) == len(broken) + len(shared)
    gain = words.limit_gain(found)
    first = next((one for one in found.limits if one.best_without), None)
    assert bool(gain) == (first is not None)
    assert "screened, not solved" in gain or first is None


def test_a_limit_that_no_screened_design_was_asked_is_not_said_to_be_kept() -> None:
    found = made_search(limits={"least_neighbour": 3.0, "most_sound_level": 90.0})
    said = words.limit_sentences(found)
    asked = "half-bandwidths to the nearest mode at least 3; sound level at 0.5 m at most 90 dB"
    assert said[-1] == f"Asked of solved plates only: {asked}."
    assert not any("neighbour" in one for one in said[:-1])


def test_an_empty_front_names_the_limits_that_conflict_and_the_nearest_plate() -> None:
    found = made_search(limits={"most_temperature_rise": 20.5})
    assert not found.front
    said = words.empty_front_sentences(found)
    nearest = nearest_of(found.screened)
    assert nearest is not None
    assert nearest.broken[0].sentence in said[-1]
    worst = nearest.broken[0].excess
    assert all(max((b.excess for b in o.broken), default=0.0) >= worst
               for o in found.screened if not o.reason)  # fmt: skip
    conflict = conflict_of(found.screened)
    assert len(said) == 1 + (conflict is not None)
    assert words.empty_front_sentences(made_search()) == []


def test_limits_conflict_where_designs_keep_each_and_none_both() -> None:
    design = made_search(screened=12, solved=3).screened[0]

    def breaking(**excess: float) -> Evaluated:
        broken = tuple(Breach(key, 1.0, 1.0, by) for key, by in excess.items())
        return replace(design, broken=broken, reason="")

    hot, heavy = breaking(power=0.2), breaking(mass=0.5)
    assert conflict_of([hot, heavy]) == ("mass", "power", 0.2)
    assert conflict_of([hot, heavy, breaking()]) is None
    # Where one is kept by nobody, it stands in the way alone.
    assert conflict_of([hot, breaking(power=0.3, mass=0.5)]) is None


def test_too_few_solved_plates_say_so() -> None:
    assert "Too few plates" in words.rank_sentences(made_search(screened=40, solved=4))[0]


def test_a_voltage_that_may_be_chosen_and_a_larger_plate_are_told() -> None:
    own = requirements_of()
    wide = replace(
        own,
        drive=replace(own.drive, least_voltage=5.0),
        workspace=replace(own.workspace, largest_length=0.1),
    )
    first = words.asked_sentences(wide)[0]
    assert "whose centre explores 73 mm × 39 mm" in first
    assert "at least 83 mm × 49 mm and at most 100 mm × 49 mm" in first
    assert "driven with 5 V to 15 V" in first
