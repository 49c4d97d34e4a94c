"""Stand-ins for the slow functions behind the verbs: they keep what they are asked."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import pytest


@dataclass
class StandIn:
    """Stands where a slow function was: keeps its calls, tells one step, gives its answer."""

    answer: Any = None
    tells: bool = True
    calls: list[tuple[tuple[Any, ...], dict[str, Any]]] = field(default_factory=list)

    def __call__(self, *given: Any, **named: Any) -> Any:
        """The answer."""
        tell = named.pop("progress", None) if self.tells else None
        self.calls.append((given, named))
        if tell is not None:
            tell("a step")
        return self.answer

    @property
    def given(self) -> tuple[Any, ...]:
        """What the only call was given by position."""
        ((given, _),) = self.calls
        return given

    @property
    def named(self) -> dict[str, Any]:
        """What the only call was given by name, without the function that is told each step."""
        ((_, named),) = self.calls
        return named


StandsIn = Callable[..., StandIn]


@pytest.fixture
def stands_in(monkeypatch: pytest.MonkeyPatch) -> StandsIn:
    """Puts a stand-in with an answer in the place of ``module:function``."""

    def put(place: str, answer: Any = None, *, tells: bool = True) -> StandIn:
        module, _, name = place.partition(":")
        stand_in = StandIn(answer, tells)
        monkeypatch.setattr(importlib.import_module(f"squeezefilm.{module}"), name, stand_in)
        return stand_in

    return put
