"""A stator fitted to one frequency: what it refuses, by day; how good it is, in verification."""

from __future__ import annotations

import pytest

from squeezefilm.errors import UnreachableError
from squeezefilm.plate.ring.stator import fit_stator


def test_a_frequency_that_no_thickness_has_is_refused_with_those_that_some_has() -> None:
    with pytest.raises(UnreachableError, match=r"no ring thickness from .* lies between") as caught:
        fit_stator(frequency=400e3, degree=3)
    assert caught.value.quantity == "frequency"
