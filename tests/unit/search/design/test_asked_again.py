"""A search's proposals (`search.design.evolution`) when it is asked again in the same folder."""

from pathlib import Path

from squeezefilm.search.design.candidate import Design, Evaluated
from squeezefilm.search.design.evolution import Proposals
from squeezefilm.search.design.requirements import load_requirements

REQUIREMENTS = load_requirements("biet2008-plate")


def answer(design: Design) -> Evaluated:
    """Heavier with every line: something to learn from."""
    lines = float(design.settings["nodal_lines"])
    numbers = {"relative_friction": lines / 20, "finest_period": 1e-2 / lines}
    return Evaluated(design, "screened", numbers)


def proposed(folder: Path, batches: int, *, member: int = 0, dear: bool = False) -> list[Design]:
    """The designs of so many batches of eight, all answered."""
    proposals = Proposals(REQUIREMENTS, 0, folder, 1, member=member, dear=dear)
    if dear and not proposals.answered:
        proposals.known([answer(one) for one in proposed(folder / "other", 1)])
    found = []
    for batch in range(batches):
        asked = proposals.ask(8, batch)
        proposals.tell([(trial, answer(design)) for trial, design in asked])
        found += [design for _, design in asked]
    return found


def test_it_goes_the_same_way_and_then_on(tmp_path: Path) -> None:
    for dear in (False, True):
        folder = tmp_path / str(dear)
        folder.mkdir()
        (folder / "other").mkdir()
        first = proposed(folder, 2, dear=dear)
        again = proposed(folder, 3, dear=dear)
        assert again[:16] == first
        assert again[16:] == proposed(folder, 3, dear=dear)[16:]
        assert len(set(again)) > len(set(first)) > 8


def test_what_another_member_proposed_is_its_own(tmp_path: Path) -> None:
    first = proposed(tmp_path, 1)
    second = proposed(tmp_path, 1, member=1)
    assert first != second
    assert proposed(tmp_path, 1) == first
    assert proposed(tmp_path, 1, member=1) == second


def test_until_it_comes_to_what_is_new_it_says_that_it_repeats(tmp_path: Path) -> None:
    proposed(tmp_path, 1)
    proposals = Proposals(REQUIREMENTS, 0, tmp_path, 1)
    assert proposals.repeats
    assert all(trial is None for trial, _ in proposals.ask(8, 0))
    assert not proposals.repeats
    assert all(trial is not None for trial, _ in proposals.ask(4, 1))
