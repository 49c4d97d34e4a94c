"""Processes of this machine: each answers one task at a time; one that dies costs its own task."""

import multiprocessing
import time
from pathlib import Path

import pytest
from tests.children import children_left
from tests.counted_tasks import counted, deadly, lines, refused, whose

from squeezefilm.design.sweep.tasks import NoAnswer
from squeezefilm.design.sweep.workers import Processes

pytestmark = pytest.mark.slow


def test_all_are_answered_once_and_processes_stay_for_the_next_asking(tmp_path: Path) -> None:
    with Processes(2) as pool:
        found = dict(pool.answers(counted, {f"at {k}": (tmp_path, k) for k in range(20)}))
        first = {process for _, (_, process) in pool.answers(whose, {k: (k,) for k in range(20)})}
        again = {process for _, (_, process) in pool.answers(whose, {k: (k,) for k in range(20)})}
    assert found == {f"at {k}": k * k for k in range(20)}
    assert lines(tmp_path, "ended") == dict.fromkeys(range(20), 1)
    assert len(first | again) == 2


def test_processes_that_know_what_they_will_be_asked_begin_at_once() -> None:
    before = set(multiprocessing.active_children())
    with Processes(2, whose) as pool:
        begun = {one.pid for one in set(multiprocessing.active_children()) - before}
        found = dict(pool.answers(whose, {k: (k, 0.1) for k in range(8)}))
    assert len(begun) == 2
    assert {process for _, process in found.values()} == begun


def test_those_that_are_alike_are_answered_by_one_process() -> None:
    tasks = {k: (k, 0.1) for k in range(8)}
    with Processes(2) as pool:
        assert dict(pool.answers(whose, {k: (k, 0.5) for k in range(2)}))  # both have begun
        found = dict(pool.answers(whose, tasks, {k: k % 2 for k in tasks}))
    for group in (range(0, 8, 2), range(1, 8, 2)):
        # The other may have helped with the later half where it was done first.
        assert len({found[k][1] for k in list(group)[:2]}) == 1  # type: ignore[index]


def test_one_that_dies_costs_its_own_task_which_is_tried_once_more(tmp_path: Path) -> None:
    with Processes(2) as pool:
        found = dict(pool.answers(deadly, {k: (tmp_path, k) for k in range(8, 20)}))
    assert found == {k: k * k for k in range(8, 20) if k != 13} | {13: NoAnswer()}
    assert lines(tmp_path, "begun") == {k: 2 if k == 13 else 1 for k in range(8, 20)}


def test_one_that_dies_while_it_has_nothing_to_do_is_replaced() -> None:
    before = set(multiprocessing.active_children())
    with Processes(2) as pool:
        assert dict(pool.answers(whose, {k: (k, 0.2) for k in range(2)}))  # both have begun
        idle = set(multiprocessing.active_children()) - before
        for process in idle:
            process.kill()
            process.join(20)
        time.sleep(0.5)  # the pool's thread notices it; where it has not yet, a task is tried again
        found = dict(pool.answers(whose, {k: (k,) for k in range(4)}))
    assert set(found) == set(range(4))
    assert NoAnswer() not in found.values()


def test_what_a_task_raises_is_raised_and_no_process_is_left() -> None:
    before = set(multiprocessing.active_children())
    with Processes(2) as pool:
        with pytest.raises(ZeroDivisionError, match="by three"):
            list(pool.answers(refused, {k: (k,) for k in range(6)}))
        assert dict(pool.answers(refused, {7: (7,)})) == {7: 7}
    assert not children_left(before)


def test_no_process_is_left_where_the_asking_is_stopped(tmp_path: Path) -> None:
    # Other tests of the same process may have children of their own.
    before = set(multiprocessing.active_children())
    with Processes(2) as pool:
        coming = pool.answers(counted, {k: (tmp_path, k, 0.05) for k in range(6)})
        next(coming)
        begun = set(multiprocessing.active_children()) - before
        assert len(begun) == 2
        coming.close()  # type: ignore[attr-defined]
        assert not children_left(before)
