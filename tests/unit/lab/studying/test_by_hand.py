"""What is put before participants by hand, and what is waited for."""

from __future__ import annotations

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.lab.studying.sittings import SurfacesByHand


def test_a_surface_is_waited_for_until_it_is_in_place_once() -> None:
    hand = SurfacesByHand()
    hand.comes_next("a", ("4 mm", "8 mm"))
    assert hand.status("a") == {"by_hand": ["4 mm", "8 mm"], "waits_for": None}
    hand.wait("a", "token", 1)
    assert hand.status("a")["waits_for"] == 1
    assert hand.status("b") == {"by_hand": [], "waits_for": None}
    assert hand.in_place("a") == ("token", 1)
    with pytest.raises(InputError, match="no surface is waited for"):
        hand.in_place("a")


def test_what_the_trial_has_not_is_not_waited_for() -> None:
    hand = SurfacesByHand()
    hand.comes_next("a", ("4 mm",))
    for sitting, place in (("a", 1), ("a", -1), ("b", 0)):
        with pytest.raises(InputError, match="surfaces; asked"):
            hand.wait(sitting, "token", place)


def test_another_trial_and_an_end_forget_what_was_waited_for() -> None:
    hand = SurfacesByHand()
    for forget in (lambda: hand.comes_next("a", ("8 mm",)), lambda: hand.over("a")):
        hand.comes_next("a", ("4 mm",))
        hand.wait("a", "token", 0)
        forget()
        with pytest.raises(InputError, match="no surface is waited for"):
            hand.in_place("a")
