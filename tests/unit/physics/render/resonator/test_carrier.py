"""The carrier: phases sample by sample, and commands of whole numbers of samples."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.resonator.envelope import carrier_block, samples_per_command


def test_a_block_goes_on_where_the_last_one_ended() -> None:
    command, advance = np.array([2.0, -1.0, 0.5]), 2.3
    whole = np.empty(12)
    last = carrier_block.py_func(0.4, advance, command, 4, 1.5, whole)
    turns = 0.4 + advance * np.arange(12)
    assert whole == pytest.approx(1.5 * np.repeat(command, 4) * np.sin(turns))
    assert last == pytest.approx(math.fmod(0.4 + 12 * advance, 2 * math.pi))
    assert 0 <= last < 2 * math.pi
    one, two = np.empty(4), np.empty(8)
    phase = carrier_block.py_func(0.4, advance, command[:1], 4, 1.5, one)
    assert carrier_block.py_func(phase, advance, command[1:], 4, 1.5, two) == pytest.approx(last)
    assert np.concatenate([one, two]) == pytest.approx(whole)


def test_commands_last_whole_numbers_of_samples() -> None:
    assert samples_per_command(1e3) == 192
    assert samples_per_command(192e3) == 1
    assert samples_per_command(7.0, 21.0) == 3
    with pytest.raises(InputError, match=r"does not divide 192 kHz; take 1\.005 kHz"):
        samples_per_command(1003.0)
    with pytest.raises(InputError, match="command_rate"):
        samples_per_command(193e3)
