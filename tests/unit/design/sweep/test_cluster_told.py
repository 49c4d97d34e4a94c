"""What is made of a cluster's answers, on a cluster that is made up and answers at once."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm import __version__
from squeezefilm.core.errors import WorkersError
from squeezefilm.design.sweep import workers as clusters
from squeezefilm.design.sweep.tasks import NoAnswer
from squeezefilm.design.sweep.workers import Cluster

AT = "tcp://here:1"


class KilledWorkerError(Exception):
    """Whoever computed it died too often."""


class CancelledError(Exception):
    """The scheduler is gone."""


class Told:
    """A future as Dask's: its answer, or what it raised."""

    def __init__(self, do: Callable[[], Any]) -> None:
        self.released = False
        self.result: Any = None
        self.error: Exception | None = None
        try:
            self.result = do()
        except CancelledError as error:
            self.result = error
        except Exception as error:
            self.error = self.result = error
        self.status = "finished" if self.error is None else "error"

    def exception(self) -> Exception | None:
        """What it raised."""
        return self.error

    def release(self) -> None:
        """Keep that it was."""
        self.released = True


class Client:
    """A client of one worker that computes at once; `after` it has given so many it is closed."""

    def __init__(self, threads: Any = (AT,), dashboard: bool = False) -> None:
        self.threads, self.status, self.loop = threads, "running", "the loop"
        self.dashboard_link = "http://here"
        self._services = {"dashboard": 1} if dashboard else {}
        self.futures: list[Told] = []
        self.firsts: list[Any] = []
        self.cancelled: list[Any] = []
        self.closed: list[float] = []
        self.waited: list[tuple[int, float]] = []

    def submit(
        self, work: Any, code: str, first: Any, function: Any, arguments: Any, *, pure: bool
    ) -> Told:
        """The answer."""
        assert (work, code, pure) == (clusters._work, clusters._code_here(), False)
        self.firsts.append(first)
        self.futures.append(Told(lambda: function(*arguments)))
        return self.futures[-1]

    def scheduler_info(self, n_workers: int) -> dict[str, Any]:
        """What the scheduler offers."""
        return {"services": self._services}

    def nthreads(self) -> Any:
        """The workers."""
        if isinstance(self.threads, Exception):
            raise self.threads
        return self.threads

    def wait_for_workers(self, count: int, timeout: float) -> None:
        """Nobody comes."""
        self.waited.append((count, timeout))
        raise TimeoutError

    def cancel(self, keys: list[Any]) -> None:
        """Keep what was."""
        self.cancelled += keys

    def close(self, timeout: float) -> None:
        """Keep that it was."""
        self.closed.append(timeout)


class Coming:
    """Answers, one batch after the other with nothing between; none from the `end`-th on."""

    def __init__(self, futures: list[Told], end: int, client: Client) -> None:
        self._left, self._end, self._client, self._look = list(futures), end, client, 0

    def next_batch(self, block: bool) -> list[tuple[Told, Any]]:
        """The next, at every second look."""
        assert not block
        self._look += 1
        if self._look % 2:
            return []
        if not self._end:
            self._client.status = "closed"
            return []
        self._end -= 1
        future = self._left.pop(0)
        return [(future, future.result)]


def cluster(
    client: Client, monkeypatch: pytest.MonkeyPatch, end: int = 1000
) -> tuple[Cluster, list[str]]:
    """A cluster of the client, and what is told of it."""
    monkeypatch.setattr(clusters, "_LOOK", 0.0)
    told: list[str] = []

    def coming(keys: list[Told], loop: Any, *, with_results: bool, raise_errors: bool) -> Coming:
        assert (loop, with_results, raise_errors) == ("the loop", True, False)
        return Coming(keys, end, client)

    def connected(address: str, timeout: float, *, set_as_default: bool) -> Client:
        assert (address, set_as_default) == (AT, False)
        return client

    made = Cluster.__new__(Cluster)
    made._address, made._tell, made._client = AT, told.append, None
    made._dask = SimpleNamespace(
        Client=connected,
        as_completed=coming,
        KilledWorker=KilledWorkerError,
        client=SimpleNamespace(FutureCancelledError=CancelledError),
    )
    return made, told


def test_answers_come_with_their_keys_and_are_let_go(monkeypatch: pytest.MonkeyPatch) -> None:
    client = Client(dashboard=True)
    pool, told = cluster(client, monkeypatch)
    with pool:
        tasks = {k: (k, 3) for k in range(6)}
        found = dict(pool.answers(divmod, tasks, {k: k % 2 for k in tasks}))
    assert found == {k: divmod(k, 3) for k in tasks}
    # Each of a group goes where the first of it is: 0, 2, 4 and 1, 3, 5.
    even, odd = client.futures[0], client.futures[3]
    assert client.firsts == [None, even, even, None, odd, odd]
    assert all(future.released for future in client.futures)
    assert (client.cancelled, client.closed) == ([], [2])
    assert told == [f"scheduler at {AT}, dashboard at http://here"]


def test_a_task_that_workers_die_of_is_tried_once_more_and_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def deadly(key: int) -> int:
        if key == 1:
            raise KilledWorkerError
        return -key

    client = Client()
    pool, told = cluster(client, monkeypatch)
    with pool:
        assert list(pool.answers(deadly, {k: (k,) for k in range(3)})) == [
            (0, 0), (2, -2), (1, NoAnswer()),
        ]  # fmt: skip
    assert len(client.futures) == 4
    assert told == [f"scheduler at {AT}"]


@pytest.mark.parametrize(
    ("error", "kind", "says"),
    [
        (ZeroDivisionError("by three"), ZeroDivisionError, "by three"),
        (CancelledError(), WorkersError, f"the scheduler at {AT} answers no more; start it"),
        (
            ModuleNotFoundError(name="numba"),
            WorkersError,
            f"a worker of {AT} lacks numba; install squeezefilm {__version__} there",
        ),
    ],
)
def test_what_a_task_raises_is_raised_and_the_rest_cancelled(
    error: Exception, kind: type[Exception], says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(key: int) -> int:
        if key:
            raise error
        return key

    client = Client()
    pool, _ = cluster(client, monkeypatch)
    with pool:
        coming = pool.answers(refused, {k: (k,) for k in range(3)})
        assert next(coming) == (0, 0)
        with pytest.raises(kind, match=says.replace(".", r"\.")):
            list(coming)
    # The last was under way, and nobody waits for it.
    assert client.cancelled == client.futures[2:]


def test_a_scheduler_that_ends_is_told_though_nothing_comes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    client = Client()
    pool, _ = cluster(client, monkeypatch, end=1)
    with pool:
        coming = pool.answers(abs, {k: (k,) for k in range(3)})
        assert next(coming) == (0, 0)
        with pytest.raises(WorkersError, match="answers no more"):
            next(coming)
    assert client.cancelled == client.futures[1:]


def test_a_cluster_without_workers_is_waited_for_and_told(monkeypatch: pytest.MonkeyPatch) -> None:
    client = Client(())
    pool, told = cluster(client, monkeypatch)
    with pool, pytest.raises(WorkersError, match="has had no worker for 120 s; start some with"):
        list(pool.answers(abs, {1: (1,)}))
    assert told[-1] == f"waiting for workers at {AT}"
    assert client.waited == [(1, 120.0)]
    gone, _ = cluster(Client(OSError()), monkeypatch)
    with gone, pytest.raises(WorkersError, match="answers no more"):
        list(gone.answers(abs, {1: (1,)}))


@pytest.mark.parametrize("error", [OSError(), ValueError(), TypeError()])
def test_an_address_without_a_scheduler_is_told(
    error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    def nobody(*_: Any, **__: Any) -> Any:
        raise error

    pool, _ = cluster(Client(), monkeypatch)
    pool._dask.Client = nobody
    with pytest.raises(WorkersError, match=f"no scheduler answers at {AT}; start one"), pool:
        pass


def test_a_worker_of_other_code_or_with_threads_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    state = SimpleNamespace(nthreads=1)
    worker = SimpleNamespace(
        address="tcp://there:2", state=state, scheduler=SimpleNamespace(address=AT)
    )
    dask = SimpleNamespace(get_worker=lambda: worker)
    monkeypatch.setitem(sys.modules, "distributed", dask)
    here = clusters._code_here()
    assert here.startswith(f"{__version__} (code ")
    assert clusters._work(here, None, divmod, (7, 2)) == (3, 1)
    with pytest.raises(WorkersError, match=r"tcp://there:2 has squeezefilm .* here it is 0\.1;"):
        clusters._work("0.1", None, divmod, (7, 2))
    state.nthreads = 2
    with pytest.raises(WorkersError, match=f"has 2 threads.*{AT} --nworkers 2 --nthreads 1"):
        clusters._work(here, None, divmod, (7, 2))
