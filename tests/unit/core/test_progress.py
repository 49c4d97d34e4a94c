"""Time that a solve may take, and what is told of the time that is left."""

import pytest

from squeezefilm.core.progress import NO_HURRY, Deadline, Pace, about, said_with_time_left


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_a_deadline_allows_what_ends_in_time() -> None:
    clock = Clock()
    deadline = Pace(budget=10.0, clock=clock).deadline()
    assert deadline == Deadline(110.0)
    assert deadline.allows(10.0)
    assert not deadline.allows(10.5)
    assert not deadline.earlier(3.0).allows(8.0)
    assert deadline.slower(2.0).allows(5.0)
    assert not deadline.slower(2.0).allows(5.5)
    assert deadline.earlier(3.0).slower(2.0).allows(2.0)
    assert not deadline.earlier(3.0).slower(2.0).allows(2.5)
    clock.now = 108.0
    assert deadline.allows(2.0)
    assert not deadline.allows(2.5)


def test_without_a_budget_there_is_none() -> None:
    assert NO_HURRY.deadline() is None
    assert NO_HURRY.share(0.0, 1.0) is None


def test_a_cache_sees_the_budget_and_not_who_is_told() -> None:
    told: list[str] = []
    assert Pace(5.0, lambda text, share: told.append(text)) == Pace(5.0)
    assert hash(Pace(5.0, lambda text, share: None)) == hash(Pace(5.0))
    assert Pace(5.0) != Pace(6.0) != NO_HURRY


def test_a_part_of_the_work_tells_its_share_of_the_whole() -> None:
    told: list[tuple[str, float]] = []
    share = Pace(tell=lambda text, fraction: told.append((text, fraction))).share(0.5, 0.9)
    assert share is not None
    share("half", 0.5)
    assert told == [("half", pytest.approx(0.7))]


def test_the_time_left_follows_from_what_was_done() -> None:
    said, clock = [], Clock()
    tell = said_with_time_left(said.append, clock)
    tell("coarse mesh", 0.0)
    clock.now += 20.0
    tell("fine mesh", 0.25)
    clock.now += 40.0
    tell("response", 0.9)
    clock.now += 5.0
    tell("done", 1.0)
    assert said == [
        "coarse mesh",
        "fine mesh (25 %, about 60 s left)",
        "response (90 %, about 7 s left)",
        "done",
    ]


def test_less_than_a_second_is_not_told() -> None:
    said, clock = [], Clock()
    tell = said_with_time_left(said.append, clock)
    clock.now += 0.5
    tell("response", 0.5)
    assert said == ["response (50 %)"]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.2, "less than 1 s"), (1, "about 1 s"), (120, "about 2 min"), (7200, "about 2 h")],
)
def test_times_are_told_as_people_do(seconds: float, text: str) -> None:
    assert about(seconds) == text
