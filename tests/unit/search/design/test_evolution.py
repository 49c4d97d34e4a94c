from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.unit.search.design.made_up import formula, random_designs, requirements

from squeezefilm.search.design.candidate import Design
from squeezefilm.search.design.evolution import Proposals
from squeezefilm.search.design.front import hypervolume

WORST = np.array([0.7, 5e-4])


def _run(proposals: Proposals, batches: range, size: int = 100) -> list[Design]:
    wanted, every = requirements(), list[Design]()
    for batch in batches:
        asked = proposals.ask(size, batch)
        proposals.tell([(trial, formula(wanted, d, "screened")) for trial, d in asked])
        every += [d for _, d in asked]
    return every


def test_generations_learn_what_is_feasible_and_lose_nothing_to_chance() -> None:
    wanted = requirements()
    found = _run(Proposals(wanted, 0, None, 1), range(6))
    drawn = random_designs(wanted, 600)

    def rows(designs: list[Design]) -> np.ndarray:
        every = [formula(wanted, one, "screened") for one in designs]
        return np.array([e.objectives(wanted.objectives) for e in every if e.is_feasible])

    assert len(rows(found[-100:])) > 2 * len(rows(drawn)) / 6
    assert hypervolume(rows(found), WORST) > 0.99 * hypervolume(rows(drawn), WORST)


@pytest.mark.parametrize("dear", [False, True])
def test_what_was_interrupted_goes_on_as_it_would_have(tmp_path: Path, dear: bool) -> None:
    wanted = requirements()
    whole = _run(Proposals(wanted, 0, tmp_path, 1, dear=dear), range(3), 20)
    other = tmp_path / "other"
    other.mkdir()
    first = _run(Proposals(wanted, 0, other, 1, dear=dear), range(2), 20)
    # Asked and never told: the process was killed.
    Proposals(wanted, 0, other, 1, dear=dear).ask(20, 2)
    rest = _run(Proposals(wanted, 0, other, 1, dear=dear), range(2, 3), 20)
    assert first + rest == whole


def test_hosts_that_share_a_folder_propose_different_designs(tmp_path: Path) -> None:
    wanted = requirements()
    one = Proposals(wanted, 0, tmp_path, 1).ask(10, 0)
    two = Proposals(wanted, 0, tmp_path, 1, member=1).ask(10, 0)
    assert {d for _, d in one}.isdisjoint(d for _, d in two)
    assert len({trial.number for trial, _ in [*one, *two]}) == 20


def test_the_dear_sampler_learns_from_what_others_solved() -> None:
    """Told of many designs, it proposes near the best of them: mostly feasible ones."""
    wanted = requirements()
    proposals = Proposals(wanted, 0, None, 1, dear=True)
    known = [formula(wanted, d, "solved") for d in random_designs(wanted, 150)]
    proposals.known(known)
    found = [formula(wanted, d, "solved").is_feasible for _, d in proposals.ask(40, 0)]
    assert np.mean(found) > 1.2 * np.mean([one.is_feasible for one in known])
