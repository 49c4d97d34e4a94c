"""Who takes which task next, and this process as the one that answers."""

import pytest

from squeezefilm.design.sweep.tasks import Shares, Workers, grouped


def test_a_worker_keeps_to_its_group_and_helps_where_none_is_left() -> None:
    shares = Shares([[0, 1, 2, 3, 4, 5], [6, 7]])
    assert [shares.next(0), shares.next(1), shares.next(1)] == [0, 6, 7]
    # The second has done its group: it takes the later half of what the first has left.
    assert [shares.next(1) for _ in range(3)] == [3, 4, 5]
    assert [shares.next(0), shares.next(0)] == [1, 2]
    assert [shares.next(0), shares.next(1), shares.next(2)] == [None, None, None]


def test_every_task_is_taken_once_whoever_asks() -> None:
    groups = [[0, 1, 2], [3], [4, 5, 6, 7, 8, 9, 10]]
    for turn in ([0, 1, 2], [0, 0, 1], [2, 1, 1, 0]):
        shares = Shares(groups)
        taken = []
        for _ in range(11):
            taken += [n for worker in turn if (n := shares.next(worker)) is not None]
        assert sorted(taken) == list(range(11)), turn


def test_what_a_worker_that_is_gone_has_left_is_taken_by_others() -> None:
    shares = Shares([["a", "b", "c", "d"]])
    assert shares.next("gone") == "a"
    assert sorted(str(shares.next("other")) for _ in range(3)) == ["b", "c", "d"]


def test_tasks_that_are_alike_follow_each_other() -> None:
    tasks = {key: (key,) for key in "abcd"}
    assert grouped(tasks, None) == [["a"], ["b"], ["c"], ["d"]]
    alike = {"a": 1, "b": 2, "c": 1, "d": 2}
    assert grouped(tasks, alike) == [["a", "c"], ["b", "d"]]
    assert list(Workers().answers(str.upper, tasks, alike)) == [
        ("a", "A"), ("c", "C"), ("b", "B"), ("d", "D"),
    ]  # fmt: skip


def test_what_a_task_raises_ends_the_asking() -> None:
    with pytest.raises(ZeroDivisionError):
        list(Workers().answers(divmod, {1: (1, 1), 2: (1, 0)}))
