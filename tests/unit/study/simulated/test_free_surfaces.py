"""A surface felt by a hand that explores freely: both ways."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception import path_percepts
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.simulated import chain_tables as module
from squeezefilm.study.simulated.chain_tables import felt_virtually, free_path

PLATE, PEOPLE = load_display("biet2008-plate"), load_observer()
FINGER = PEOPLE.median_finger()


def run(*periods: float) -> Any:
    felt = Candidates(np.array(periods), np.arange(float(len(periods))))
    return SimpleNamespace(candidates=felt)


def test_a_free_hand_feels_both_ways_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    kept: dict[str, Any] = {}

    def felt(display: Any, surface: Any, observer: Any, finger: Any, paths: Any, run_: Any) -> Any:
        asked.append((display, surface.title, observer, finger, paths, run_))
        return SimpleNamespace(along=run(4e-3, 2e-3), across=run(5e-3, 1e-3))

    monkeypatch.setattr(path_percepts, "path_percept", felt)

    def found_or_made(asked: str, make: Any) -> Any:
        return kept[asked] if asked in kept else kept.setdefault(asked, make())

    monkeypatch.setattr(module, "_KEPT", SimpleNamespace(found=found_or_made))
    monkeypatch.setattr(module, "_REMEMBERED", {})
    fine, apparatus = Stimulus("fine", 4e-3, "period"), module.Apparatus()
    found: Any = felt_virtually("free", fine, PLATE, PEOPLE, FINGER, apparatus)
    assert found.period.tolist() == [[4e-3, 2e-3], [5e-3, 1e-3]]
    assert found.d_prime.tolist() == [[0.0, 1.0], [0.0, 1.0]]
    ((display, title, observer, whose, (path,), how),) = asked
    assert (display, title, observer, whose, how) == (PLATE, "fine", PEOPLE, FINGER, apparatus)
    # Asked again nothing is computed: not in this process, and not in one that has its disk.
    assert felt_virtually("free", fine, PLATE, PEOPLE, FINGER, apparatus) is found
    module._REMEMBERED.clear()
    assert felt_virtually("free", fine, PLATE, PEOPLE, FINGER, apparatus) is found
    assert len(asked) == 1
    assert list(kept.values()) == [found]
    # Another surface is another request.
    felt_virtually("free", Stimulus("fine", 5e-3, "period"), PLATE, PEOPLE, FINGER, apparatus)
    assert len(asked) == 2
    plate: Any = PLATE.actuator
    assert np.ptp(path.x) <= plate.extent[0]
    assert np.ptp(path.y) <= plate.extent[1]


def test_a_ring_is_not_explored_freely() -> None:
    with pytest.raises(InputError, match=r"'biet2008-stator' is a ring, .* take a plate, or"):
        free_path(load_display("biet2008-stator"), PEOPLE, FINGER)
