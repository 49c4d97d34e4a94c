"""Who answers is chosen in one place."""

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep.tasks import ThisProcess
from squeezefilm.design.sweep.workers import Processes, workers


def test_one_process_is_this_one_and_more_are_a_pool() -> None:
    with workers() as pool:
        assert isinstance(pool, ThisProcess)
        assert dict(pool.answers(divmod, {"a": (7, 2)})) == {"a": (3, 1)}
    with workers(jobs=2) as pool:
        assert isinstance(pool, Processes)


def test_no_process_answers_nothing() -> None:
    with pytest.raises(InputError, match="jobs = 0"), workers(jobs=0):
        pass
