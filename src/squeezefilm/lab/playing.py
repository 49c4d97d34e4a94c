"""What plays or may play at any moment: what every page's stop bar shows, and what it stops."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Message = dict[str, Any]


@dataclass(frozen=True, slots=True)
class _Held:
    text: str
    plays: bool
    stop: Callable[[], None]


class Playing:
    """What plays or may play, each by a key, with how it is stopped.

    `tell` sends a message to the experimenters' pages; they are told of every change. Its methods
    are called on the server's loop.
    """

    def __init__(self, tell: Callable[[Message], None]) -> None:
        self._tell = tell
        self._held: dict[str, _Held] = {}

    def note(self, key: str, text: str, stop: Callable[[], None], *, plays: bool) -> None:
        """`text` names what plays, or where `plays` is false may begin to at any moment.

        `stop` silences it and returns at once.
        """
        before = self._held.get(key)
        self._held[key] = _Held(text, plays, stop)
        if before is None or before.plays is not plays:
            self._changed()

    def forget(self, key: str) -> None:
        """It cannot play any more."""
        if self._held.pop(key, None) is not None:
            self._changed()

    def stop(self) -> None:
        """Silence everything; whoever holds it notes when it is silent."""
        for one in list(self._held.values()):
            one.stop()

    def message(self) -> Message:
        """What a page is told."""
        now = [
            {"key": key, "text": one.text, "plays": one.plays} for key, one in self._held.items()
        ]
        return {"type": "playing", "now": now}

    def _changed(self) -> None:
        self._tell(self.message())
