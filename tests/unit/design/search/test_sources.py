"""Where the numbers of a search's plates are from, and that their ranges count where it judges."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.unit.design.search.made_up import requirements

from squeezefilm.core import config
from squeezefilm.design.search.candidate import (
    design_of,
    evaluate,
    reference_of,
    sourced_display_of,
)
from squeezefilm.design.search.report.page import plate_file
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.uncertainty.uncertainty import uncertain_friction

CHOSEN = {
    "substrate": "aluminium 6061", "thickness": 1.5e-3, "ceramic": "as described",
    "ceramic_thickness": 0.5e-3, "nodal_lines": 8.0, "width": 0.03, "length": 0.07, "cover": 1.0,
    "voltage": 12.0,
}  # fmt: skip


def test_a_sheet_of_the_library_brings_its_ranges() -> None:
    said = sourced_display_of(requirements(), design_of(0, CHOSEN)).provenance
    sheet = {at: one for at, one in said.items() if at.startswith("actuator.substrate.")}
    assert any(one.distribution is not None for one in sheet.values())
    assert said["finger.speed"].source.startswith("asked for by the requirements")


@pytest.mark.slow
def test_what_is_judged_with_confidence_is_what_the_plates_file_says() -> None:
    wanted = requirements()
    sure = replace(wanted, limits=replace(wanted.limits, confidence="95 %"))
    design = design_of(0, CHOSEN)
    judged = evaluate(sure, design, "solved").numbers["surest_friction"]
    read = config.load_text(Display, plate_file(sure, design))
    # The file has its numbers in another order, in which the same points are drawn.
    said = uncertain_friction(read, predict(read))
    assert judged == pytest.approx(said.interval[1], rel=1e-4)
    bare = replace(read, provenance={})
    unsaid = uncertain_friction(bare, predict(bare))
    # One end may come out alike.
    assert [*unsaid.interval, unsaid.median] != pytest.approx(
        [*said.interval, said.median], rel=1e-3
    )


@pytest.mark.slow
def test_the_display_to_compare_with_keeps_the_ranges_of_its_own_body() -> None:
    wanted = replace(requirements(), compare_with="biet2008-plate")
    sure = replace(wanted, limits=replace(wanted.limits, confidence="95 %"))
    own, base = load_display("biet2008-plate"), sure.base
    display = replace(own, finger=base.finger, surfaces=base.surfaces)
    found = predict(display, voltage=sure.drive.voltage)
    expected = uncertain_friction(display, found).interval[1]
    assert reference_of(sure).numbers["surest_friction"] == pytest.approx(expected, rel=1e-12)
