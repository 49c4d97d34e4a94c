"""What the Search area is told of plates, fronts and reasons."""

from __future__ import annotations

import itertools
import json
from typing import Any

import numpy as np
import pytest

from squeezefilm.design.search.found import DesignSearch, FrontMember
from squeezefilm.design.search.limits import EmptyCorner, Made, corner_in_words
from squeezefilm.lab import search_process as shown
from squeezefilm.lab.wire import as_text

from .small import evaluated, requirements

GOOD = {
    "relative_friction": 0.3, "finest_period": 0.4e-3, "resonance_frequency": 25e3,
    "squeeze_number": 12.0, "temperature_rise": 60.0, "cost": 1.0,
}  # fmt: skip
ASKED = requirements()
FIRST = evaluated(ASKED, 0.2, **GOOD)
SECOND = evaluated(ASKED, 0.7, **{**GOOD, "relative_friction": 0.4, "finest_period": 0.3e-3})
WORSE = {"relative_friction": 0.5, "finest_period": 0.35e-3, "squeeze_number": 9.0}
REFERENCE = evaluated(ASKED, 0.5, **{**GOOD, **WORSE})


def test_a_plate_has_what_is_drawn_in_si_and_what_is_read_in_words() -> None:
    found = shown.plate(ASKED, FIRST, Made(64, 0.75, {}, {}, {}))
    assert found["name"] == FIRST.design.address
    assert found["objectives"] == [0.3, 0.4e-3]
    assert found["words"] == ["0.3", "400 µm"]
    assert ["resonance_frequency", "resonance", "25 kHz"] in found["numbers"]
    assert "cost" not in {key for key, _, _ in found["numbers"]}
    assert ["thickness", "1 mm"] in found["chosen"]
    assert ["nodal lines", "7"] in found["chosen"]
    assert found["design"] == {"shape": 0, "values": FIRST.design.settings}
    assert found["yield"] == 0.75
    assert shown.plate(ASKED, FIRST)["yield"] is None


def test_a_glimpse_has_both_fronts_and_the_reference() -> None:
    found = shown.glimpse(search(stage="solving", left="about 9 s"))
    assert (found["stage"], found["screened"], found["solved"]) == ("solving", 32, 2)
    assert found["left"] == "about 9 s"
    assert found["screened_front"] == [[0.3, 0.4e-3], [0.4, 0.3e-3]]
    assert [one["name"] for one in found["front"]] == [
        one.design.address for one in (FIRST, SECOND)
    ]
    assert found["reference"]["name"] == "biet2008-plate"
    assert found["reference"]["objectives"] == [0.5, 0.35e-3]
    assert found["reference"]["breaks"] == ["squeeze number is 9, at least 10 is wanted"]
    assert found["reference"]["reason"] == ""
    empty = shown.glimpse(search(screened=(), solved=(), front=(), reference=None))
    assert (empty["reference"], empty["screened_front"]) == (None, [])


def test_a_long_front_is_thinned_evenly() -> None:
    many = search()
    vars(many)["screened_front"] = np.array([(float(k), -float(k)) for k in range(5000)])
    found = shown.glimpse(many)["screened_front"]
    assert len(found) <= shown.MOST_POINTS
    assert len(found) > shown.MOST_POINTS / 2
    steps = {b[0] - a[0] for a, b in itertools.pairwise(found)}
    assert len(steps) == 1


def search(**changes: Any) -> DesignSearch:
    bad = evaluated(
        ASKED, 0.9, "screened", **{**GOOD, "temperature_rise": 90.0, "relative_friction": 0.1}
    )
    screened = (FIRST, SECOND, *[bad] * 30)
    given: dict[str, Any] = {
        "requirements": ASKED, "seed": 1, "screened": screened, "solved": (FIRST, SECOND),
        "front": (FrontMember(FIRST), FrontMember(SECOND, Made(64, 0.5, {}, {}, {}))),
        "reference": REFERENCE, "corrections": (None,), "computed": 30, "kept": 4,
        "seconds": 1.0, "stopped": False, "provenance": {}, **changes,
    }  # fmt: skip
    return DesignSearch(**given)


def test_a_result_says_what_to_build_and_what_each_limit_costs() -> None:
    found = shown.result(search())
    names = [one["name"] for one in found["front"]]
    assert names == [FIRST.design.address, SECOND.design.address]
    assert found["chosen"] in names
    assert found["beats"] == [SECOND.design.address]
    assert [one["yield"] for one in found["front"]] == [None, 0.5]
    assert found["limits"][0].startswith(
        "temperature rise at most 75 K: broken by 30 of 32 screened"
    )
    assert not any("broken by 0 of" in one for one in found["limits"])
    assert "without it µ′/µ at the best place of 0.1" in found["limits"][0]
    assert any("none of 30 screened designs is feasible" in one for one in found["corners"])
    assert (found["screened"], found["solved"], found["kept"]) == (32, 2, 4)
    assert 0 < found["hypervolume"] < 1
    # What is told goes over a websocket.
    assert json.loads(as_text(found))["chosen"] == found["chosen"]


def test_an_empty_front_has_nothing_to_build() -> None:
    found = shown.result(search(front=(), reference=None, stopped=True))
    assert (found["chosen"], found["front"], found["beats"], found["reference"]) == (
        None,
        [],
        [],
        None,
    )
    assert found["stopped"]
    assert found["hypervolume"] == 0


@pytest.mark.parametrize(
    ("corner", "says"),
    [
        (
            EmptyCorner("strips", "nodal lines 12", 20, "temperature_rise", 1.0, "at best 88 K"),
            "strips, nodal lines 12: none of 20 screened designs is feasible; 100 % of them break "
            "the limit of temperature rise (at best 88 K)",
        ),
        (
            EmptyCorner("disc", "circles 4", 25, "", 0.4, "too many"),
            "disc, circles 4: none of 25 screened designs is feasible; 40 % cannot be built, for "
            "example: too many",
        ),
    ],
)
def test_an_empty_corner_is_a_sentence(corner: EmptyCorner, says: str) -> None:
    assert corner_in_words(corner) == says


def test_thickness_is_called_as_elsewhere() -> None:
    found = search()
    vars(found)["ranks"] = {"thickness": 0.9}
    assert shown.result(found)["ranks"] == {"thickness with ceramics": 0.9}
