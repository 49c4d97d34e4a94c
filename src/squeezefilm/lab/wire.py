"""Messages between page and server over the websocket: JSON, checked by pydantic.

A request has an `id` that its answer carries, a `type`, and fields of its own. An answer is
``{"id", "type", …}``; an error is ``{"id", "type": "error", "message"}``, in words that a person
can act on.
"""

from __future__ import annotations

import inspect
import json
import logging
import typing
from collections.abc import Awaitable, Callable
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model

from squeezefilm.core.errors import InputError, RecordError, SqueezefilmError
from squeezefilm.core.results import to_json
from squeezefilm.lab.worker import SupersededError

LARGEST_MESSAGE = 8 * 1024 * 1024
"""Bytes of a websocket message."""
LARGEST_FROM_PARTICIPANT = 64 * 1024
"""Characters of a participant's message: an answer, never a file."""
LONGEST_TEXT = 400_000
"""Characters of one text in a message, a TOML file's for instance."""

# What arguments of handlers may be, and so fields of messages.
Text = Annotated[str, Field(max_length=LONGEST_TEXT)]
Name = Annotated[str, Field(max_length=100)]
FileName = Annotated[str, Field(max_length=64)]
Seed = Annotated[int, Field(ge=0, le=2**53)]


class Request(BaseModel):
    """Base of every request."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: int = Field(ge=0, le=2**53)
    type: str = Field(max_length=64)

    @property
    def own(self) -> dict[str, Any]:
        """The fields of its own, beside id and type."""
        names = type(self).model_fields.keys() - {"id", "type"}
        return {name: getattr(self, name) for name in names}


_LOG = logging.getLogger("squeezefilm.lab")
_OURS = "The lab failed on this request; the terminal it runs in shows why."

Answer = dict[str, Any]
Handler = Callable[..., Awaitable[Answer]]


def request_of(handler: Handler) -> type[Request]:
    """The model of a message whose fields are a handler's arguments."""
    hints = typing.get_type_hints(handler, include_extras=True)
    fields: dict[str, Any] = {
        name: (hints[name], ... if argument.default is argument.empty else argument.default)
        for name, argument in inspect.signature(handler).parameters.items()
        if name != "self"
    }
    model: type[Request] = create_model("Message", __base__=Request, **fields)
    return model


class Dispatcher:
    """Readers and answerers of messages by type; longer ones than `longest` are refused."""

    def __init__(self, longest: int = LARGEST_MESSAGE) -> None:
        self._longest = longest
        self._known: dict[str, tuple[type[Request], Handler]] = {}

    def add(self, kind: str, handler: Handler, model: type[Request] | None = None) -> None:
        """Answer messages of a type by a handler, called with their fields as its arguments, or
        with the whole message where it has a `model`."""
        if model is None:
            self._known[kind] = request_of(handler), lambda asked: handler(**asked.own)
        else:
            self._known[kind] = model, handler

    async def answer(self, text: str) -> Answer:
        """The answer to one message's text; never raises for what a page may send.

        An error that carries ``"again": true`` changed nothing and may be asked again as it was.
        Raises `SupersededError` where newer work took this one's place: nobody waits for it.
        """
        number: int | None = None
        try:
            if len(text) > self._longest:
                raise InputError(
                    f"a message of {len(text)} characters; at most {self._longest} are read"
                )
            raw = json.loads(text, parse_constant=_no_constant)
            if not isinstance(raw, dict):
                raise InputError("a message must be an object with id and type")
            number = raw.get("id") if isinstance(raw.get("id"), int) else None
            kind = raw.get("type")
            if not isinstance(kind, str) or kind not in self._known:
                raise InputError(
                    f"a message of type {str(kind)[:64]!r} is not known; known: "
                    f"{', '.join(sorted(self._known))}"
                )
            model, handler = self._known[kind]
            request = model.model_validate(raw)
            reply = await handler(request)
        except ValidationError as error:
            first = error.errors()[0]
            place = ".".join(str(part) for part in first["loc"])
            return _error(number, f"{place}: {first['msg']}")
        except RecordError as error:
            # Nothing was written, and the same request may be sent again.
            return {**_error(number, str(error)), "again": True}
        except (SqueezefilmError, ValueError, RecursionError) as error:
            return _error(number, str(error))
        except SupersededError as error:
            error.number = number
            raise
        except Exception:
            # A mistake of ours: said on the page and in the terminal; the conversation goes on.
            _LOG.exception("the lab could not answer a message")
            return _error(number, _OURS)
        return {"id": request.id, **reply}


def as_text(answer: Answer) -> str:
    """JSON text; a number that is not finite becomes null, which JSON can carry."""
    return json.dumps(to_json(answer), ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def _error(number: int | None, message: str) -> Answer:
    return {"id": number, "type": "error", "message": message[:4000]}


def _no_constant(name: str) -> float:
    raise InputError(f"{name} is no JSON number")
