"""Surfaces that somebody puts before a participant by hand, and the one that is waited for.

A sitting without a device waits before each surface until it is said to be in place, on the
experimenter's page or the participant's. Only then the trial counts as presented and the question
comes, so that no response time includes the swap.
"""

from __future__ import annotations

from typing import Any

from squeezefilm.core.errors import InputError


class ByHand:
    """The surfaces of the trials that are presented by hand now, by their sittings."""

    def __init__(self) -> None:
        self._names: dict[str, tuple[str, ...]] = {}
        self._waits: dict[str, tuple[str, int]] = {}

    def comes_next(self, sitting: str, names: tuple[str, ...]) -> None:
        """The surfaces of a sitting's next trial, in their order; none is waited for yet."""
        self._names[sitting] = names
        self._waits.pop(sitting, None)

    def wait(self, sitting: str, token: str, place: int) -> None:
        """Surface number `place` (from 0) of the trial with this token is waited for.

        Raises `InputError` for a place that the trial has not.
        """
        count = len(self._names.get(sitting, ()))
        if not 0 <= place < count:
            raise InputError(f"the trial has {count} surfaces; asked: {place}")
        self._waits[sitting] = token, place

    def in_place(self, sitting: str) -> tuple[str, int]:
        """The token and place of the surface that was waited for, and is in place now.

        Raises `InputError` where none is waited for.
        """
        if sitting not in self._waits:
            raise InputError(
                "no surface is waited for at this sitting; it is once the participant's page asks "
                "for it"
            )
        return self._waits.pop(sitting)

    def over(self, sitting: str) -> None:
        """The trial was answered, or the sitting ended."""
        self._names.pop(sitting, None)
        self._waits.pop(sitting, None)

    def status(self, sitting: str) -> dict[str, Any]:
        """What the experimenter's page shows: the surfaces, and the place of the one waited for."""
        _, waited = self._waits.get(sitting, ("", None))
        return {"by_hand": list(self._names.get(sitting, ())), "waits_for": waited}
