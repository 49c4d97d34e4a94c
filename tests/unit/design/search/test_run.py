from __future__ import annotations

import contextlib
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.unit.design.search.made_up import evaluated_by_formula, random_designs, requirements

import squeezefilm.design.search.run as run
from squeezefilm.core.errors import ConfigError, InputError, WorkersError
from squeezefilm.core.results import config_hash
from squeezefilm.design.search import candidate
from squeezefilm.design.search.candidate import Design, Evaluated, Level
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.limits import Made, limit_in_words, margins
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.design.sweep.tasks import NoAnswer

FEW = {"screened": 40, "solved": 6}


def _made(wanted: object, one: Evaluated) -> Made:
    return Made(64, 0.9, {"power": 6}, {"power": (1.0, 2.5)}, {"sides": {"power": 0.125}})


@pytest.fixture
def by_formula(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "evaluate_all", evaluated_by_formula)
    monkeypatch.setattr(run, "made_of", _made)


def _search(folder: Path | None = None, **changes: int) -> DesignSearch:
    # What a folder keeps shows in a search that is too small for a good front.
    size = {"screened": 400, "solved": 60} if folder is None else {"screened": 100, "solved": 16}
    asked = size | {"seed": 1} | changes
    return run.search_designs(requirements(), out=folder, **asked)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def solved_tasks() -> list[tuple[Design, ...]]:
    """What the usual search solves together, once `whole` has been searched."""
    return []


@pytest.fixture(scope="module")
def whole(solved_tasks: list[tuple[Design, ...]]) -> DesignSearch:
    """The usual search, by formula, that several tests read."""

    def noted(wanted: Requirements, designs: tuple[Design, ...], level: Level) -> list[Evaluated]:
        if level == "solved":
            solved_tasks.append(designs)
        return evaluated_by_formula(wanted, designs, level)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "evaluate_all", noted)
        patch.setattr(run, "made_of", _made)
        return _search()


@pytest.fixture(scope="module")
def small() -> DesignSearch:
    """The search that a folder keeps, by formula and without a folder."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "evaluate_all", evaluated_by_formula)
        patch.setattr(run, "made_of", _made)
        return _search(screened=100, solved=16)


@pytest.mark.usefixtures("by_formula")
def test_the_front_is_feasible_and_nobody_beats_it(whole: DesignSearch) -> None:
    found = whole
    assert len(found.front) >= 8
    assert all(one.evaluated.is_feasible for one in found.front)
    assert all(one.evaluated.level == "solved" for one in found.front)
    first = found.objectives[:, 0]
    assert np.all(np.diff(first) > 0)
    assert np.all(np.diff(found.objectives[:, 1]) < 0)
    assert found.plates_solved <= 60
    assert len(_search(screened=130, solved=0).screened) <= 130
    assert found.ranks["relative_friction"] > 0.9
    assert 0 < found.hypervolume < 1


def test_a_search_whose_designs_cannot_be_built_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def unbuilt(_: Requirements, designs: tuple[Design, ...], level: Level) -> list[Evaluated]:
        return [Evaluated(one, level, {}, reason="too short for its ceramics") for one in designs]

    monkeypatch.setattr(run, "evaluate_all", unbuilt)
    with pytest.raises(InputError, match="can be built, for example: too short for its ceramics"):
        _search(screened=8, solved=0)


@pytest.mark.usefixtures("by_formula")
def test_a_plate_is_one_task_with_voltages_over_the_whole_range(
    whole: DesignSearch, solved_tasks: list[tuple[Design, ...]]
) -> None:
    found = whole
    assert solved_tasks
    assert all(len({one.plate for one in task}) == 1 for task in solved_tasks)
    assert len(found.front) > found.plates_on_front > 8
    assert found.plates_solved <= 60 < len(found.solved)
    volts: dict[Design, set[float]] = {}
    for one in found.solved:
        volts.setdefault(one.design.plate, set()).add(float(one.design.settings["voltage"]))
    assert all({5.0, 7.5, 10.0, 12.5, 15.0} <= every for every in volts.values())
    # Where no voltage may be chosen each plate is one design.
    fixed = requirements(**{', least_voltage = "5 V"': ""})
    alone = run.search_designs(fixed, **FEW)
    assert len(alone.solved) == alone.plates_solved


@pytest.mark.nightly
@pytest.mark.usefixtures("by_formula")
def test_seeds_agree() -> None:
    """The campaign in tests/recovery asks it of real plates."""
    volumes = [_search(seed=seed, screened=800, solved=240).hypervolume for seed in range(1, 6)]
    assert np.ptp(volumes) < 0.03 * np.mean(volumes)


@pytest.mark.usefixtures("by_formula")
def test_asked_again_it_computes_nothing_and_says_the_same(tmp_path: Path) -> None:
    first = _search(tmp_path, **FEW)
    again = _search(tmp_path, **FEW)
    assert again.computed == 0
    assert again.front == first.front
    assert again.hypervolume == first.hypervolume


@pytest.mark.slow
@pytest.mark.usefixtures("by_formula")
def test_hosts_that_search_in_one_folder_end_with_what_all_have_solved(tmp_path: Path) -> None:
    def solved(member: int) -> set[Design]:
        found = _search(tmp_path, member=member, **FEW)
        return {one.design for one in found.solved}

    first, second = solved(0), solved(1)
    assert second > first
    # Asked again, the first has what the second found.
    assert solved(0) >= second - first


@pytest.mark.parametrize(
    "after",
    [3, *(pytest.param(after, marks=pytest.mark.slow) for after in (15, 25, 50))],
)
@pytest.mark.usefixtures("by_formula")
def test_a_search_that_was_stopped_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: int, small: DesignSearch
) -> None:
    count = 0

    def stopping(*args: object) -> list[Evaluated]:
        nonlocal count
        count += 1
        if count > after:
            raise KeyboardInterrupt
        return evaluated_by_formula(*args)  # type: ignore[arg-type]

    monkeypatch.setattr(run, "evaluate_all", stopping)
    stopped, why = run.search_until_stopped(
        run.SearchRequest(requirements(), screened=100, solved=16, out=tmp_path)
    )
    assert (stopped.stopped, why) == (True, "stopped")
    monkeypatch.setattr(run, "evaluate_all", evaluated_by_formula)
    found = _search(tmp_path)
    assert not found.stopped
    assert [one.evaluated for one in found.front] == [one.evaluated for one in small.front]


class _Deadly:
    """Workers of which one dies of every eighth task."""

    def answers(
        self, function: Callable[..., Any], tasks: dict[Any, Any], alike: object = None
    ) -> Iterator[tuple[Any, Any]]:
        for number, (key, arguments) in enumerate(tasks.items()):
            yield key, NoAnswer() if number % 8 == 0 else function(*arguments)


@pytest.mark.usefixtures("by_formula")
def test_designs_that_a_process_died_of_are_asked_again_another_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as dying:
        dying.setattr(run, "workers", lambda **_: contextlib.nullcontext(_Deadly()))
        lost = _search(tmp_path, **FEW)
    assert any(one.reason == NoAnswer().reason for one in lost.screened)
    again = _search(tmp_path, **FEW)
    assert again.computed > 0
    assert not any(one.reason for one in again.screened)


def test_a_fault_of_ours_is_told_and_may_be_mended_another_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def faulty(*_: object) -> None:
        raise KeyError("x")

    wanted = requirements()
    monkeypatch.setattr(candidate, "display_of", faulty)
    found = candidate.evaluate(wanted, random_designs(wanted, 1)[0], "screened")
    assert found.reason == "not foreseen: KeyError: 'x'"
    assert not found.lasting


class _Gone:
    """Workers of a cluster whose scheduler dies after so many tasks."""

    def __init__(self, left: int) -> None:
        self.left = left

    def answers(
        self, function: Callable[..., Any], tasks: dict[Any, Any], alike: object = None
    ) -> Iterator[tuple[Any, Any]]:
        for key, arguments in tasks.items():
            if not self.left:
                raise WorkersError("the scheduler answers no more; start it")
            self.left -= 1
            yield key, function(*arguments)


@pytest.mark.usefixtures("by_formula")
def test_a_cluster_that_is_gone_leaves_what_was_found_and_why_it_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    asked = run.SearchRequest(
        requirements(), screened=200, solved=40, scheduler="tcp://there:1", progress=told.append,
        out=tmp_path,
    )  # fmt: skip
    with monkeypatch.context() as clustered:
        gone = _Gone(60)
        clustered.setattr(run, "workers", lambda **_: contextlib.nullcontext(gone))
        found, why = run.search_until_stopped(asked)
        assert (found.stopped, why) == (True, "the scheduler answers no more; start it")
        assert found.front
        solving = [one for one in told if one.startswith("solving")]
        assert solving
        # How many solve at once is not known.
        assert not any("left" in one for one in solving)
        with pytest.raises(WorkersError):
            run.search_designs(requirements(), screened=20, scheduler="tcp://there:1")
        # Without anything found there is nothing to show.
        with pytest.raises(WorkersError):
            run.search_until_stopped(replace(asked, out=None))


def _made_of_low_voltages(wanted: object, one: Evaluated) -> Made:
    kept = 0.95 if float(one.design.settings["voltage"]) < 12 else 0.5
    return Made(64, kept, {"power": 6}, {}, {})


@pytest.mark.usefixtures("by_formula")
def test_what_comes_to_the_front_for_a_plate_of_a_low_yield_is_asked_for_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(run, "made_of", _made_of_low_voltages)
    heat = 'most_temperature_rise = "60 K"'
    wanted = requirements(**{heat: f"{heat}\nleast_yield = 0.9"})
    found = run.search_designs(wanted, screened=150, solved=24)
    assert found.front
    assert [one.made.kept if one.made else 0.0 for one in found.front] == [0.95] * len(found.front)


@pytest.mark.usefixtures("by_formula")
def test_whoever_watches_sees_the_front_grow() -> None:
    seen: list[DesignSearch] = []
    found = run.search_designs(requirements(), **FEW, watch=seen.append)
    assert seen[-1].plates_solved == found.plates_solved
    assert len(seen[0].screened_front)
    assert seen[0].stage.startswith("screening")
    assert [one.name for one in seen[-1].front] == [one.name for one in found.front]


def test_the_reasons_name_the_limits_and_what_they_cost(whole: DesignSearch) -> None:
    found = whole
    said = [limit_in_words(one, len(found.screened)) for one in found.limits]
    hot = next(text for text in said if text.startswith("temperature rise"))
    assert "at most 60 K" in hot
    assert "without it" in hot
    chosen = found.chosen
    assert chosen is not None
    near = margins(found.requirements, chosen.evaluated)
    assert list(near.values()) == sorted(near.values())
    assert min(near.values()) >= 0
    corner = [one for one in found.corners if "nodal lines 5" in one.where]
    assert corner
    assert corner[0].key == "resonance_frequency"


def test_the_nearest_limits_come_first_whatever_is_not_known() -> None:
    wanted = requirements()
    wanted = replace(wanted, limits=replace(wanted.limits, most_deflection=1e-3, most_mass=0.1))
    one = evaluated_by_formula(wanted, tuple(random_designs(wanted, 1)), "solved")[0]
    near = margins(wanted, replace(one, numbers={**one.numbers, "deflection": math.nan}))
    assert set(near) == {"relative_friction", "resonance_frequency", "temperature_rise"}
    assert list(near.values()) == sorted(near.values())


def test_a_plate_of_the_front_is_a_display_that_can_be_written_and_read(
    whole: DesignSearch,
) -> None:
    from squeezefilm.core import config
    from squeezefilm.core.config.schema import text_of
    from squeezefilm.physics.display import Display

    found = whole
    display = found.display()
    again = config.load_text(Display, text_of(display, display.provenance))
    assert config_hash(again) == config_hash(display)
    with pytest.raises(InputError, match="no plate 'zzz'"):
        found.display("zzz")


@pytest.mark.usefixtures("by_formula")
def test_requirements_that_nothing_meets_end_with_reasons_and_no_front() -> None:
    hard = requirements(**{'most_temperature_rise = "60 K"': 'most_temperature_rise = "0.1 K"'})
    found = run.search_designs(hard, screened=100, solved=20)
    assert found.front == ()
    assert found.chosen is None
    assert found.limits[0].broken == len(found.screened)
    assert found.summary()["chosen"] is None
    with pytest.raises(InputError, match="front is empty"):
        found.display()


def test_bad_asking_is_refused_before_anything_is_computed() -> None:
    with pytest.raises(InputError, match="screened"):
        run.search_designs(requirements(), screened=0)
    with pytest.raises(InputError, match="seed"):
        run.search_designs(requirements(), seed=-1)
    with pytest.raises(ConfigError, match="neither a file"):
        run.search_designs("biet2008-plat")


@pytest.mark.nightly
def test_a_small_search_of_real_plates(tmp_path: Path) -> None:
    """Against the paper's plate: whatever is on the front keeps the limits, solved."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = run.search_designs("biet2008-plate", screened=60, solved=8, jobs=2, out=tmp_path)
    assert found.reference is not None
    assert found.reference.is_feasible
    assert found.front
    for one in found.front:
        assert one.evaluated.is_feasible
        assert one.made is not None
    again = run.search_designs("biet2008-plate", screened=60, solved=8, jobs=1, out=tmp_path)
    assert again.computed == 0
    assert again.hypervolume == found.hypervolume
