"""The time that is left of long work in steps."""

from __future__ import annotations

from squeezefilm.measure.calibration.steps import Steps


class Clock:
    """A clock that the test moves."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_the_time_left_of_steps_is_their_own_pace_and_what_is_expected_of_the_later() -> None:
    said: list[str] = []
    clock = Clock()
    steps = Steps(said.append, (10.0, 60.0), clock)
    tell = steps.next()
    tell("plates", 0.0)
    clock.now += 20.0
    tell("plates", 0.5)
    tell = steps.next()
    clock.now += 30.0
    tell("draws", 0.0)
    tell("draws", 1.0)
    assert said == [
        "plates (about 70 s left)",
        "plates (about 80 s left)",
        "draws (about 30 s left)",
        "draws",
    ]
