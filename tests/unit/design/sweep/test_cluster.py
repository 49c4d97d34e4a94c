"""The workers of a Dask scheduler, in processes of their own, which are killed."""

from pathlib import Path
from typing import Any

import pytest
from tests.cluster import LocalCluster, killed, local_cluster
from tests.counted_tasks import counted, deadly, held, lines, refused, whose

import squeezefilm as sf
from squeezefilm.core.errors import WorkersError
from squeezefilm.design.sweep import workers as clusters
from squeezefilm.design.sweep.sweep import SweepRequest, sweep_until_stopped
from squeezefilm.design.sweep.tasks import NoAnswer
from squeezefilm.design.sweep.workers import workers

pytestmark = pytest.mark.slow


def test_all_are_answered_once_by_both_workers_and_alike_ones_by_one(tmp_path: Path) -> None:
    told: list[str] = []
    with local_cluster(2) as cluster, workers(scheduler=cluster.address, tell=told.append) as pool:
        found = dict(pool.answers(counted, {k: (tmp_path, k) for k in range(200)}))
        assert found == {k: k * k for k in range(200)}
        assert lines(tmp_path, "ended") == dict.fromkeys(range(200), 1)
        tasks = {k: (k, 0.1) for k in range(8)}
        answers: Any = dict(pool.answers(whose, tasks, {k: k % 2 for k in tasks}))
        assert len({process for _, process in answers.values()}) == 2
        for group in (range(0, 8, 2), range(1, 8, 2)):
            assert len({answers[k][1] for k in list(group)[:2]}) == 1
        with pytest.raises(ZeroDivisionError, match="by three"):
            list(pool.answers(refused, {k: (k,) for k in range(6)}))
        # One that is closed early leaves the workers as they are.
        coming: Any = pool.answers(counted, {k: (tmp_path, k) for k in range(50)})
        next(coming)
        coming.close()
        assert dict(pool.answers(refused, {7: (7,)})) == {7: 7}
    assert told[0].startswith(f"scheduler at {cluster.address}")


def test_a_worker_that_is_killed_costs_no_finished_task(tmp_path: Path) -> None:
    tasks = {k: (tmp_path, k, 30) for k in range(120)}
    with local_cluster(2) as cluster, workers(scheduler=cluster.address) as pool:
        answered: dict[int, Any] = {}
        for key, answer in pool.answers(held, tasks):
            answered[key] = answer
            if len(answered) == 30:
                finished = set(answered)
                killed(cluster.workers[0])
                (tmp_path / "go").touch()
            if len(answered) == 60:
                cluster.start_workers(1)
    assert answered == {k: k * k for k in tasks}
    begun = lines(tmp_path, "begun")
    assert all(begun[key] == 1 for key in finished)
    # The one that it was at, and those that ended in the moment before and were not fetched yet.
    assert sum(begun.values()) <= len(tasks) + 5


def test_what_a_slow_listener_has_not_heard_yet_outlives_its_worker(tmp_path: Path) -> None:
    """Both workers answer all that they are given, and die before anybody looks."""
    tasks = {k: (tmp_path, k) for k in range(4)}
    with local_cluster(2) as cluster, workers(scheduler=cluster.address) as pool:
        coming = pool.answers(counted, tasks)
        first = next(coming)
        while sum(lines(tmp_path, "ended").values()) < 4:
            pass
        # What they have sent is on its way for some milliseconds.
        cluster.start_workers(1)
        killed(cluster.workers[0])
        killed(cluster.workers[1])
        assert dict([first, *coming]) == {k: k * k for k in tasks}


def test_a_scheduler_that_is_killed_is_told_and_the_rest_is_answered_by_the_next(
    tmp_path: Path,
) -> None:
    tasks = {k: (tmp_path, k, 30) for k in range(80)}
    answered: dict[int, Any] = {}
    with local_cluster(2) as cluster:

        def asked() -> None:
            with workers(scheduler=cluster.address) as pool:
                for key, answer in pool.answers(held, tasks):
                    answered[key] = answer
                    if len(answered) == 30:
                        cluster.kill_scheduler()

        with pytest.raises(WorkersError, match="answers no more; start it"):
            asked()
        kept = set(answered)
        assert 30 <= len(kept) < len(tasks)
        (tmp_path / "go").touch()
        for process in cluster.workers:
            process.wait(60)
        cluster.start_scheduler()
        cluster.start_workers(2)
        with workers(scheduler=cluster.address) as pool:
            rest = {key: tasks[key] for key in tasks if key not in kept}
            answered |= dict(pool.answers(held, rest))
    assert answered == {k: k * k for k in tasks}
    begun = lines(tmp_path, "begun")
    assert all(begun[key] == 1 for key in kept)
    # The one that each of two workers was at, and those that were not fetched yet.
    assert sum(begun.values()) <= len(tasks) + 6


def test_a_sweep_is_the_same_through_a_cluster_whose_worker_and_scheduler_are_killed(
    tmp_path: Path,
) -> None:
    asked: dict[str, Any] = {
        "vary": {"voltage": "20 V..100 V:20", "normal_force": "0.3 N, 0.5 N"},
        "ask": "relative_friction,vibration_amplitude",
    }
    here = sf.sweep("biet2008-stator", **asked)
    with local_cluster(2) as cluster:
        told: list[str] = []

        def tell(text: str) -> None:
            told.append(text)
            if text.startswith("8 of 40"):
                killed(cluster.workers[0])
            if text.startswith("16 of 40"):
                cluster.kill_scheduler()

        request = SweepRequest(
            sf.load_display("biet2008-stator"),
            **asked,
            scheduler=cluster.address,
            out=tmp_path,
            progress=tell,
        )
        part, why = sweep_until_stopped(request)
        assert "answers no more" in why
        assert part.missing == 40 - part.answered <= 24
        cluster.workers[1].wait(60)
        cluster.start_scheduler()
        cluster.start_workers(2)
        there = sf.sweep("biet2008-stator", **asked, scheduler=cluster.address, out=tmp_path)
    assert there.computed == part.missing
    for name in here.names:
        assert there.column(name).tolist() == here.column(name).tolist()


def test_a_task_that_workers_die_of_is_lost_and_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES", "1")
    with local_cluster(0) as cluster:
        cluster.start_workers(2, nanny=True)
        with workers(scheduler=cluster.address) as pool:
            found = dict(pool.answers(deadly, {k: (tmp_path, k) for k in range(10, 16)}))
    assert found == {k: k * k for k in range(10, 16) if k != 13} | {13: NoAnswer()}
    # Twice beside others, and twice alone.
    assert lines(tmp_path, "begun")[13] == 4


def test_what_cannot_be_used_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with local_cluster(0) as cluster:
        monkeypatch.setattr(clusters, "_PATIENCE", 0.5)
        with (
            pytest.raises(WorkersError, match=r"no worker for .*dask worker tcp://"),
            workers(scheduler=cluster.address) as pool,
        ):
            list(pool.answers(whose, {1: (1,)}))
        cluster.start_workers(1, threads=2)
        with (
            pytest.raises(WorkersError, match=r"has 2 threads.*--nthreads 1"),
            workers(scheduler=cluster.address) as pool,
        ):
            list(pool.answers(whose, {1: (1,)}))
        killed(cluster.workers[0])
        cluster.start_workers(1)
        monkeypatch.setattr(clusters, "__version__", "0.0.1")
        with (
            pytest.raises(WorkersError, match=r"here it is 0\.0\.1 \(code \w+\); install the same"),
            workers(scheduler=cluster.address) as pool,
        ):
            list(pool.answers(whose, {1: (1,)}))


def test_no_scheduler_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clusters, "_ANSWERS", 0.5)
    nobody = LocalCluster(Path(), address="tcp://127.0.0.1:9")
    with (
        pytest.raises(WorkersError, match=r"no scheduler answers .*dask scheduler"),
        workers(scheduler=nobody.address),
    ):
        pass
