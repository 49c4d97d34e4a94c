"""What plays, as every page's stop bar is told."""

from __future__ import annotations

from typing import Any

from squeezefilm.lab.connections import NowPlaying


def test_pages_are_told_of_every_change_and_a_stop_stops_all() -> None:
    told: list[list[tuple[str, bool]]] = []
    stopped: list[str] = []

    def tell(message: dict[str, Any]) -> None:
        assert message["type"] == "playing"
        told.append([(one["key"], one["plays"]) for one in message["now"]])

    def work() -> None:
        playing = NowPlaying(tell)
        playing.note("a", "a texture", lambda: stopped.append("a"), plays=False)
        playing.note("a", "a texture", lambda: stopped.append("a"), plays=False)
        playing.note("b", "a surface", lambda: playing.forget("b"), plays=True)
        playing.note("a", "a texture", lambda: stopped.append("a"), plays=True)
        playing.stop()
        playing.forget("b")
        assert [one["text"] for one in playing.message()["now"]] == ["a texture"]

    work()
    assert stopped == ["a"]
    # The same is not said twice.
    assert len(told) == 4
    assert told[-1] == [("a", True)]
