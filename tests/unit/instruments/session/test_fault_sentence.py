"""What is said of a device that stopped: whose watchdog it was, and who was held up."""

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.instruments.device.wire.frames import Fault
from squeezefilm.instruments.session.play.real_time import fault_sentence


def player(fault: Fault, held_up: float, twin: bool) -> Any:
    plan = SimpleNamespace(device=SimpleNamespace(twin=twin))
    return SimpleNamespace(fault=fault, held_up=held_up, plan=plan)


@pytest.mark.parametrize(
    ("twin", "whose"),
    [
        (False, "the device heard nothing for 50 ms, took"),
        (True, "the twin heard nothing for 50 ms of its own time, took"),
    ],
)
def test_a_watchdog_says_whose_it_was_and_who_was_held_up(twin: bool, whose: str) -> None:
    held_up = fault_sentence(player(Fault.WATCHDOG, 0.312, twin))
    assert held_up.startswith(whose)
    assert "this program was held up for 312 ms" in held_up
    lost = fault_sentence(player(Fault.WATCHDOG, 0.012, twin))
    assert lost.startswith(whose)
    assert "this program was not held up" in lost


def test_every_other_fault_has_its_sentence() -> None:
    said = {fault_sentence(player(fault, 1.0, False)) for fault in Fault}
    assert len(said) == len(Fault)
    assert not any("held up for" in one and "watchdog" not in one for one in said)
