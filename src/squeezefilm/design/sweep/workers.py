"""Who answers: this process, processes of this machine, or a Dask cluster; one method wide.

with workers(jobs=2) as pool:                      # or workers(scheduler="tcp://host:8786")
    for key, answer in pool.answers(function, {key: (argument, ...), ...}):
        ...
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Annotated, Any

from squeezefilm.core import quantities as si
from squeezefilm.core.progress import SayProgress
from squeezefilm.design.sweep.processes import Processes
from squeezefilm.design.sweep.tasks import ThisProcess, Workers


@contextmanager
@si.checked_numbers
def workers(
    jobs: Annotated[int, si.AtLeast(1)] = 1,
    scheduler: str | None = None,
    tell: SayProgress | None = None,
    first: Callable[..., Any] | None = None,
) -> Iterator[Workers]:
    """Those who answer, for the block: this process where `jobs` is 1, else so many of their own
    beside it, or all workers of the Dask `scheduler` (``"tcp://host:8786"``) however many there
    are, `jobs` then counting for nothing. `tell` is told of a cluster who is there and where its
    dashboard is. Processes begin at once where it is known which function they are asked `first`,
    while this process has other things to do.

    Raises `InputError` where Dask is not installed, and `WorkersError` where no scheduler answers
    or its workers cannot be used. More than one process in a script needs
    ``if __name__ == "__main__":``.
    """
    if scheduler is not None:
        from squeezefilm.design.sweep.cluster import Cluster

        with Cluster(scheduler, tell or (lambda _: None)) as cluster:
            yield cluster
    elif jobs == 1:
        yield ThisProcess()
    else:
        with Processes(jobs, first) as processes:
            yield processes
