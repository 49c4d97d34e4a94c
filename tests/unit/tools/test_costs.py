"""The table of what tests cost: sums by folder and by file, the dearest first."""

from types import SimpleNamespace

import pytest
from tests.costs import Stopwatch, table

TIMES = {
    "tests/unit/physics/film/test_gap.py": {False: 2.0, True: 0.0},
    "tests/unit/physics/film/test_mobility.py": {False: 0.5, True: 4.0},
    "tests/e2e/test_cli.py": {False: 3.0, True: 0.0},
}
COUNTS = dict.fromkeys(TIMES, 2)


def test_folders_and_files_are_summed_and_sorted() -> None:
    rows = [line for line in table(TIMES, COUNTS).splitlines() if " | " in line]
    assert rows == [
        "folder | tests | quick, s | slow, s", "unit/physics/film | 4 | 2.5 | 4.0",
        "e2e | 2 | 3.0 | 0.0", "**all** | 6 | 5.5 | 4.0",
        "file of 1 s and more | tests | quick, s | slow, s",
        "unit/physics/film/test_mobility.py | 2 | 0.5 | 4.0", "e2e/test_cli.py | 2 | 3.0 | 0.0",
        "unit/physics/film/test_gap.py | 2 | 2.0 | 0.0",
    ]  # fmt: skip


def test_what_was_not_run_has_no_column() -> None:
    quick = {file: {False: 1.0, True: 0.0} for file in TIMES}
    assert "slow, s" not in table(quick, COUNTS)


@pytest.mark.parametrize(("within", "stops"), [(0.0, True), (1e9, False)])
def test_no_test_is_begun_when_the_time_is_spent(within: float, stops: bool) -> None:
    session = SimpleNamespace(shouldstop="")
    item = SimpleNamespace(session=session, get_closest_marker=lambda name: None)
    phase = Stopwatch(within).pytest_runtest_makereport(item)
    next(phase)
    with pytest.raises(StopIteration):
        phase.send(SimpleNamespace())
    assert bool(session.shouldstop) is stops
