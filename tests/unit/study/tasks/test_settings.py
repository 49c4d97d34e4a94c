"""Settings: runs from above and from below, of each person and of all."""

from __future__ import annotations

import numpy as np
import pytest
from tests.recovery.task_people import EVERY, Person, answered

from squeezefilm.study.adaptive.staircase import Ending
from squeezefilm.study.tasks import thresholds


def test_runs_from_above_and_from_below_keep_their_names(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever stops late ends runs from above low and those from below high."""
    runs = [Ending(-0.5, True), Ending(-0.5, True), Ending(1.0, False), Ending(7.0, False)]
    monkeypatch.setattr(thresholds, "endings", lambda main, person: runs)
    random = np.random.default_rng(1)
    main = answered(EVERY["adjustment"], [Person(0.1, 1.0, 0.0)] * 2, random).main(0)
    found = thresholds.settings_of(main, 0.95, 0, lambda _: None)
    means = {one.name: one.magnitude.value for one in found.conditions if one.magnitude}
    # Means of logarithms: a half, and twice and eight times make four.
    assert means == pytest.approx({"from above": -0.5, "from below": 3.0})
    assert [person.estimate.value for person in found.persons] == pytest.approx([2**0.5 - 1] * 2)
    assert found.notes == ()
