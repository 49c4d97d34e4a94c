from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from tests.unit.design.search.made_up import formula, random_designs, requirements

from squeezefilm.core.errors import InputError
from squeezefilm.design.search.limits import Made
from squeezefilm.design.search.store import FILE, DesignStore


def test_what_was_found_is_there_again(tmp_path: Path) -> None:
    wanted = requirements()
    store = DesignStore(wanted, tmp_path)
    found = [formula(wanted, d, "screened") for d in random_designs(wanted, 20)]
    found[0] = replace(found[0], numbers={**found[0].numbers, "finest_period": math.inf})
    found[1] = replace(found[1], numbers={}, broken=(), reason="does not fit")
    store.add(found)
    again = DesignStore(wanted, tmp_path)
    assert len(again) == len({one.design for one in found})
    for one in found:
        assert again.get(one.design, "screened") == one
        assert again.get(one.design, "solved") is None


def test_limits_are_judged_anew_and_another_display_is_not_mixed_up(tmp_path: Path) -> None:
    wanted = requirements()
    designs = random_designs(wanted, 20)
    DesignStore(wanted, tmp_path).add([formula(wanted, d, "screened") for d in designs])
    strict = requirements(**{'least_frequency = "20 kHz"': 'least_frequency = "1 MHz"'})
    store = DesignStore(strict, tmp_path)
    kept = [one for d in designs if (one := store.get(d, "screened")) is not None]
    assert len(kept) == len(designs)
    assert not any(one.is_feasible for one in kept)
    other = requirements(**{"[limits]": 'touch = { speed = "150 mm/s" }\n[limits]'})
    assert len(DesignStore(other, tmp_path)) == 0


def test_a_line_that_was_cut_off_costs_itself_only(tmp_path: Path) -> None:
    wanted = requirements()
    designs = random_designs(wanted, 10)
    DesignStore(wanted, tmp_path).add([formula(wanted, d, "screened") for d in designs])
    file = tmp_path / FILE
    whole = file.read_bytes()
    for cut in (1, 2, 60, 120, 199):
        file.write_bytes(whole[:-cut])
        store = DesignStore(wanted, tmp_path)
        assert len(store) >= len(set(designs)) - 1
        store.add([formula(wanted, designs[-1], "screened")])
        assert len(DesignStore(wanted, tmp_path)) == len(set(designs))


def test_what_may_be_another_one_another_time_is_kept_in_memory_only(tmp_path: Path) -> None:
    wanted = requirements()
    one = formula(wanted, random_designs(wanted, 1)[0], "solved")
    store = DesignStore(wanted, tmp_path)
    store.add([replace(one, reason="not foreseen: KeyError: 'x'", lasting=False)])
    assert store.get(one.design, "solved") is not None
    assert len(DesignStore(wanted, tmp_path)) == 0


def test_a_folder_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "here").write_text("")
    with pytest.raises(InputError, match="choose another folder"):
        DesignStore(requirements(), tmp_path / "here")


def test_what_is_made_of_a_drawing_is_taken_up_by_who_asks_the_same(tmp_path: Path) -> None:
    wanted = requirements()
    (design,) = random_designs(wanted, 1)
    made = Made(64, 0.5, {"temperature_rise": 30}, {"mass": (0.1, 0.2)}, {"thickness": {}}, 3)
    first = DesignStore(wanted, tmp_path)
    assert first.made(design) is None
    first.add_made(design, made)
    assert first.made(design) == made
    again = DesignStore(wanted, tmp_path)
    assert again.made(design) == made
    assert len(again) == 0
    # Other limits are another question.
    limits = replace(wanted.limits, most_temperature_rise=50.0)
    assert DesignStore(replace(wanted, limits=limits), tmp_path).made(design) is None
