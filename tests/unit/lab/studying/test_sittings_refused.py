"""What a sitting is refused: surfaces and answers that are not its turn, or no longer are."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.lab.studying.devices import MeasuredDevice
from squeezefilm.lab.studying.studies import Studies
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.conduct.study_device import (
    DeviceIdentity,
    DeviceVerification,
    TrialMotion,
)

FINE, BOARD = Stimulus("fine", 4e-3, "period"), Grating("board", 4e-3, "period")


class Run:
    """A run whose next trial is "token" and presents these surfaces."""

    def __init__(self, *surfaces: Stimulus | Grating) -> None:
        trial = SimpleNamespace(number=4, seed=17)
        self.next: Any = SimpleNamespace(token="token", surfaces=surfaces, trial=trial)
        self.shown: list[bool] = []
        self.known: set[str] = set()

    def next_trial(self, shown: bool = True) -> Any:
        """The trial; kept is whether it counts as presented."""
        self.shown.append(shown)
        return self.next

    def presented(self, token: str) -> Any:
        """The trial and its surfaces."""
        assert token == "token"
        return self.next

    def recorded(self, token: str) -> bool:
        """True where it is answered."""
        return token in self.known


def sitting_of(
    *surfaces: Stimulus | Grating, ended: bool = False, device: str = "twin", session: Any = "s"
) -> tuple[Any, Run]:
    """Studies with one sitting, "a", and its run."""
    studies: Any = Studies.__new__(Studies)
    run = Run(*(surfaces or (FINE, BOARD)))
    sitting = SimpleNamespace(id="a", ended=ended, device=device, session=session, study="small")
    studies.sittings = SimpleNamespace(get=lambda _: sitting)
    studies._runs = {} if session is None else {"a": run}
    waited: list[Any] = []
    studies.by_hand = SimpleNamespace(
        wait=lambda *said: waited.append(said), in_place=lambda _: ("token", 0), waited=waited
    )
    return studies, run


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda: sitting_of(ended=True)[0].asked_to_feel("a", "token", 0), "has ended"),
        (lambda: sitting_of()[0].asked_to_feel("a", "other", 0), "not the one to be presented"),
        (lambda: sitting_of()[0].asked_to_feel("a", "token", 2), "4 has 2 surfaces; asked: 2"),
        (lambda: sitting_of()[0].asked_to_feel("a", "token", -1), "asked: -1"),
        (lambda: sitting_of()[0].asked_to_feel("a", "token", 1), "'board' is a real grating"),
        (lambda: sitting_of(session=None)[0].asked_to_feel("a", "token", 0), "not consented to"),
        (lambda: sitting_of(session=None)[0].respond("a", "token", None), "not consented to"),
    ],
)
def test_what_is_not_its_turn_is_refused(ask: Callable[[], object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        ask()


@pytest.mark.parametrize(
    ("surface", "device", "place", "how", "shown"),
    [
        (FINE, "twin", 0, "on a device", [False, True]),
        (FINE, "twin", 1, "on a device", [False]),
        (BOARD, "none", 0, "lies there", [False, True]),
        (FINE, "none", 0, "by hand", [False]),
    ],
)
def test_a_trial_counts_as_presented_from_its_first_surface_on(
    surface: Any, device: str, place: int, how: str, shown: list[bool]
) -> None:
    """One that somebody has to put there is waited for, and counts from when it is there."""
    studies, run = sitting_of(surface, surface, device=device)
    # What a device plays comes with the seed of its trial.
    played = (surface, 17) if how == "on a device" else None
    assert studies.asked_to_feel("a", "token", place) == (how, played)
    assert run.shown == shown
    by_hand = how == "by hand"
    assert studies.by_hand.waited == ([("a", "token", place)] if by_hand else [])
    if by_hand:
        assert studies.in_place("a") == ("small", 0)
        assert run.shown == [False, False, True]
        studies.by_hand.in_place = lambda _: ("token", 1)
        assert studies.in_place("a") == ("small", 1)
        assert run.shown[3:] == [False]


def test_a_surface_put_in_place_too_late_is_told() -> None:
    studies, run = sitting_of(FINE, device="none")
    for over in (None, SimpleNamespace(token="next", surfaces=(FINE,))):
        run.next = over
        with pytest.raises(InputError, match="whose surface was waited for is over"):
            studies.in_place("a")


def test_an_answer_needs_the_device_that_played_what_it_is_of() -> None:
    studies, run = sitting_of(FINE)
    assert studies.needs_device("a", "token")
    run.known.add("token")
    assert not studies.needs_device("a", "token")
    assert not sitting_of(BOARD)[0].needs_device("a", "token")
    assert not sitting_of(FINE, device="none")[0].needs_device("a", "token")
    assert not sitting_of(FINE, session=None)[0].needs_device("a", "token")


def test_a_measurement_says_what_was_found_and_plays_nothing() -> None:
    who = DeviceIdentity("bench")
    found: DeviceVerification = object()  # type: ignore[assignment]
    device = MeasuredDevice(who, found)
    assert (device.identity(), device.verify_device()) == (who, found)
    assert device.stop() == TrialMotion()
