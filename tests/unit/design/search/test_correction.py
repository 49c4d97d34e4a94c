from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.unit.design.search.made_up import formula, random_designs, requirements

from squeezefilm.design.search.worth_solving import LEAST_PLATES, learned


def test_a_smooth_factor_is_learned_and_its_error_is_told() -> None:
    wanted = requirements()
    designs = random_designs(wanted, 60)
    screened = {one: formula(wanted, one, "screened") for one in designs}
    solved = [formula(wanted, one, "solved") for one in designs[:40]]
    found = learned(wanted.spaces[0], screened, solved)
    assert found is not None
    assert found.plates == 40
    assert found.errors["relative_friction"] < 0.3 * found.raw["relative_friction"]
    # Of designs that were not solved it is as wrong as it says.
    unseen = designs[40:]
    corrected = found.of_all([screened[one] for one in unseen])
    truth = [formula(wanted, one, "solved").numbers for one in unseen]
    off = [
        np.log(c["relative_friction"] / t["relative_friction"])
        for c, t in zip(corrected, truth, strict=True)
    ]
    assert float(np.std(off)) < 3 * found.errors["relative_friction"] + 1e-3


def test_noise_is_not_learned() -> None:
    """What differs from design to design without a rule is left, and told as the error."""
    wanted, draw = requirements(), np.random.default_rng(2)
    designs = random_designs(wanted, 80)
    screened = {one: formula(wanted, one, "screened") for one in designs}
    solved = []
    for one in designs:
        before = screened[one]
        numbers = dict(before.numbers)
        numbers["relative_friction"] *= float(np.exp(0.1 * draw.standard_normal()))
        solved.append(replace(before, level="solved", numbers=numbers))
    found = learned(wanted.spaces[0], screened, solved)
    assert found is not None
    assert found.errors["relative_friction"] == pytest.approx(0.1, rel=0.3)


def test_from_few_designs_nothing_is_learned() -> None:
    wanted = requirements()
    designs = random_designs(wanted, LEAST_PLATES - 1)
    screened = {one: formula(wanted, one, "screened") for one in designs}
    assert (
        learned(wanted.spaces[0], screened, [formula(wanted, d, "solved") for d in designs]) is None
    )


def test_from_four_plates_one_factor_is_learned() -> None:
    """A theory that is off by the same share everywhere is corrected by the first few plates."""
    wanted = requirements()
    designs = random_designs(wanted, 12)
    screened = {design: formula(wanted, design, "screened") for design in designs}
    solved = []
    for design in designs[:LEAST_PLATES]:
        before = screened[design]
        numbers = {
            **before.numbers,
            "resonance_frequency": 0.93 * before.numbers["resonance_frequency"],
        }
        solved.append(replace(before, level="solved", numbers=numbers))
    correction = learned(wanted.spaces[0], screened, solved)
    assert correction is not None
    unseen = [screened[design] for design in designs[LEAST_PLATES:]]
    for corrected, before in zip(correction.of_all(unseen), unseen, strict=True):
        assert corrected["resonance_frequency"] == pytest.approx(
            0.93 * before.numbers["resonance_frequency"], rel=1e-6
        )
