"""What a page is told where a request fails, and with which number."""

import asyncio
import json

import pytest

from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.lab.wire import Dispatcher, as_text
from squeezefilm.lab.worker import SupersededError


def answer_to(error: Exception, text: str = '{"id": 7, "type": "x"}') -> dict:
    async def fail() -> dict:
        raise error

    dispatcher = Dispatcher()
    dispatcher.add("x", fail)
    return asyncio.run(dispatcher.answer(text))


def test_only_what_was_not_written_may_be_asked_again():
    full = answer_to(RecordError("the disk is full"))
    assert full == {"id": 7, "type": "error", "message": "the disk is full", "again": True}
    assert "again" not in answer_to(InputError("no such trial"))


def test_a_mistake_of_ours_is_answered_with_the_requests_number(caplog):
    found = answer_to(ZeroDivisionError("inside"))
    assert (found["id"], found["type"]) == (7, "error")
    assert "inside" not in found["message"]
    assert "ZeroDivisionError" in caplog.text


def test_superseded_work_is_not_answered():
    with pytest.raises(SupersededError):
        answer_to(SupersededError("newer"))


@pytest.mark.parametrize("number", ["-1", "true", '"7"', "1e400", "9007199254740993"])
def test_a_number_that_is_none_is_refused(number):
    found = answer_to(InputError("x"), f'{{"id": {number}, "type": "x"}}')
    assert found["type"] == "error"
    assert json.loads(as_text(found))["type"] == "error"
