"""Noise by number, against splitmix64 written anew with Python's whole numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.instruments.twin.plant_kernel import gaussian, mixed, uniform

WORD = 2**64 - 1
STEP = 0x9E3779B97F4A7C15
FIRST = 0xBF58476D1CE4E5B9
SECOND = 0x94D049BB133111EB


def splitmix(state: int) -> int:
    """What splitmix64 gives for a state before its step."""
    z = (state + STEP) & WORD
    z = ((z ^ (z >> 30)) * FIRST) & WORD
    z = ((z ^ (z >> 27)) * SECOND) & WORD
    return z ^ (z >> 31)


def share(seed: int, stream: int, number: int) -> float:
    z = splitmix(splitmix(seed) ^ splitmix((stream + FIRST) & WORD))
    z = splitmix(z ^ splitmix((number + SECOND) & WORD))
    return ((z >> 11) + 0.5) / 2**53


def test_the_mixing_is_that_of_splitmix64() -> None:
    # The first numbers that the generator's public test vector gives for the state 1234567.
    assert int(mixed(np.uint64(1234567))) == 6457827717110365317
    assert int(mixed(np.uint64(1234567 + STEP))) == 3203168211198807973
    for state in (0, 1, 2**63, WORD, 0x0123456789ABCDEF):
        assert int(mixed(np.uint64(state))) == splitmix(state)


@pytest.mark.parametrize("seed", [0, 1, 9, 2**40])
def test_values_are_those_of_seed_stream_and_number(seed: int) -> None:
    for stream in (0, 1, 4, 7):
        for number in (0, 1, 2, 1000, 2**33):
            assert uniform(seed, stream, number) == share(seed, stream, number)
            one, two = share(seed, 2 * stream, number), share(seed, 2 * stream + 1, number)
            expected = math.sqrt(-2 * math.log(one)) * math.cos(2 * math.pi * two)
            assert gaussian(seed, stream, number) == pytest.approx(expected, rel=1e-12, abs=1e-13)
