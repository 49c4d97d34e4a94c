"""What connections do when a request does not end or a page does not answer; tests/e2e holds real
ones open."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from squeezefilm.lab.connections import SLOWEST_REQUEST, PageProtocol, TimedProtocol


class Loop:
    """An event loop that keeps what shall be done later."""

    def __init__(self) -> None:
        self.later: list[Any] = []

    def call_later(self, delay: float, what: Any) -> Any:
        timer = SimpleNamespace(delay=delay, what=what, cancelled=False)
        timer.cancel = lambda: setattr(timer, "cancelled", True)
        self.later.append(timer)
        return timer


class Transport:
    """A transport that notes what became of it."""

    def __init__(self) -> None:
        self.aborted, self.closing, self.written = 0, False, b""

    def is_closing(self) -> bool:
        return self.closing

    def abort(self) -> None:
        self.aborted += 1

    def write(self, data: bytes) -> None:
        self.written += data


@pytest.fixture
def timed(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A connection whose own protocol does nothing."""
    for name in ("connection_made", "connection_lost", "data_received"):
        monkeypatch.setattr(H11Protocol, name, lambda *_: None)
    monkeypatch.setattr(H11Protocol, "handle_events", lambda _: None)
    monkeypatch.setattr(H11Protocol, "handle_websocket_upgrade", lambda *_: None)
    made: Any = TimedProtocol.__new__(TimedProtocol)
    made.loop, made.transport, made.cycle = Loop(), Transport(), None
    made.connection_made(made.transport)
    return made


def test_a_request_that_does_not_end_is_cut_off(timed: Any) -> None:
    (clock,) = timed.loop.later
    assert clock.delay == SLOWEST_REQUEST
    timed.data_received(b"GET")
    assert len(timed.loop.later) == 1
    clock.what()
    assert timed.transport.aborted == 1
    # Bytes that come all the same start another clock.
    timed.data_received(b" /")
    assert len(timed.loop.later) == 2


def test_what_closes_already_is_not_cut_off(timed: Any) -> None:
    timed.transport.closing = True
    timed.loop.later[0].what()
    assert timed.transport.aborted == 0


def test_a_whole_request_has_no_deadline_until_the_next_begins(timed: Any) -> None:
    timed.handle_events()
    assert not timed.loop.later[0].cancelled
    timed.cycle = SimpleNamespace(response_complete=False)
    timed.handle_events()
    assert timed.loop.later[0].cancelled
    timed.data_received(b"more of a body")
    assert len(timed.loop.later) == 1
    timed.cycle.response_complete = True
    timed.data_received(b"GET")
    assert len(timed.loop.later) == 2
    for end in (lambda: timed.connection_lost(None), lambda: timed.handle_websocket_upgrade(None)):
        end()
        assert timed.loop.later[-1].cancelled
        timed.data_received(b"GET")
        assert not timed.loop.later[-1].cancelled


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Any:
    """An open page."""
    monkeypatch.setattr(WebSocketsSansIOProtocol, "shutdown", lambda _: None)
    monkeypatch.setattr(
        WebSocketsSansIOProtocol,
        "send_receive_event_to_app",
        lambda self: self.queue.put_nowait("handed on"),
    )
    made: Any = PageProtocol.__new__(PageProtocol)
    made.loop, made.transport, made.close_sent = Loop(), Transport(), False
    queued: list[Any] = []
    made.queued, made.queue = queued, SimpleNamespace(put_nowait=queued.append)
    closed: list[Any] = []
    made.closed = closed
    made.conn = SimpleNamespace(
        send_close=lambda *why: closed.append(why), data_to_send=lambda: [b"by", b"e"]
    )
    return made


def test_a_page_is_refused_once_with_a_reason_and_dropped_soon_after(page: Any) -> None:
    page.refuse(1008, "why")
    assert page.closed == [(1008, "why")]
    assert page.queued == [{"type": "websocket.disconnect", "code": 1008, "reason": "why"}]
    assert page.transport.written == b"bye"
    page.refuse(1008, "again")
    assert len(page.closed) == 1
    assert [timer.delay for timer in page.loop.later] == [2.0, 2.0]
    page.loop.later[0].what()
    assert page.transport.aborted == 1
    page.transport.closing = True
    page.refuse(1008, "too late")
    assert len(page.loop.later) == 2


def test_a_page_that_answers_no_ping_or_outlives_the_server_is_closed(page: Any) -> None:
    page.pong_timer = object()
    page.keepalive_timeout()
    assert page.pong_timer is None
    assert page.closed == [(1011, "the page did not answer")]
    page.shutdown()
    assert page.loop.later[-1].what == page.transport.abort
    assert len(page.loop.later) == 2


def test_a_message_that_is_no_text_is_refused_and_others_are_handed_on(page: Any) -> None:
    page.curr_msg_data_type, page.frames = "text", [b"\xc3", b"\xa9"]
    page.send_receive_event_to_app()
    page.curr_msg_data_type, page.frames = "bytes", [b"\xff"]
    page.send_receive_event_to_app()
    assert page.queued == ["handed on", "handed on"]
    page.curr_msg_data_type = "text"
    page.send_receive_event_to_app()
    assert [code for code, _ in page.closed] == [1007]
    assert page.queued[2:] == [
        {"type": "websocket.disconnect", "code": 1007, "reason": page.closed[0][1]}
    ]
