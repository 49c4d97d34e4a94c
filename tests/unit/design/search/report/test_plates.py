"""The plates of a front as files: read back they are the same, and every number has its source."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.unit.design.search.report.made_search import made_search, requirements_of

from squeezefilm.core import config
from squeezefilm.core.config.provenance import UNSTATED
from squeezefilm.core.results import config_hash
from squeezefilm.design.search.found import DesignSearch, FrontMember
from squeezefilm.design.search.report.page import plate_file
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import GlueLayer


def with_requirements(found: DesignSearch, requirements: Requirements) -> DesignSearch:
    """All solved plates as a front, under other requirements of the same shapes."""
    return replace(
        found, requirements=requirements, front=tuple(FrontMember(one) for one in found.solved)
    )


def text_of_member(found: DesignSearch, member: FrontMember) -> str:
    return plate_file(found.requirements, member.evaluated.design)


@pytest.mark.parametrize("shapes", [1, 2])
def test_read_back_it_is_the_same_display_with_the_same_hash(shapes: int) -> None:
    found = with_requirements(
        made_search(shapes=shapes, screened=60, solved=12), requirements_of(shapes=shapes)
    )
    substrates = set()
    for member in found.front:
        display = found.display(member.name)
        read = config.load_text(Display, text_of_member(found, member))
        assert read == display
        assert config_hash(read) == config_hash(display)
        assert read.provenance == display.provenance
        substrates.add(display.actuator.substrate.name)  # type: ignore[union-attr]
    assert len(substrates) > 1


def test_every_number_has_its_source_and_says_who_chose_it() -> None:
    found = made_search(screened=60, solved=12)
    member = found.front[0]
    read = config.load_text(Display, text_of_member(found, member))
    said = read.provenance
    assert [path for path, one in said.items() if one.evidence == UNSTATED] == []
    assert said["actuator.length"].source.startswith("given by the requirements")
    for path in ("actuator.thickness", "actuator.patches.0.x", "drive.voltage"):
        assert said[path].evidence == "derived"
        assert said[path].source.startswith("chosen by squeezefilm design for the requirements")
    assert said["actuator.quality_factor"].evidence == "assumed"
    assert said["finger.speed"].evidence == "assumed"
    assert said["surfaces.0.roughness"].source == "paper, section 3.2.1"


def test_a_material_of_the_library_brings_its_sources_and_ranges() -> None:
    found = with_requirements(made_search(screened=80, solved=30), requirements_of())
    of_library = [
        one for one in found.front if one.evaluated.design.settings["substrate"] == "aluminium 7075"
    ]
    read = config.load_text(Display, text_of_member(found, of_library[0]))
    from squeezefilm.core.presets import materials

    for path, value in materials.named("aluminium 7075").leaves():
        one = read.provenance[f"actuator.substrate.{path}"]
        assert one.source == value["source"]
        assert (one.distribution is not None) == ("range" in value or "uncertainty" in value)


def test_another_surface_first_glue_and_force_are_told() -> None:
    own = requirements_of()
    glued = replace(own.shapes[0], glue=GlueLayer(20e-6, 3e9))
    requirements = replace(
        own, shapes=(glued,), touch=replace(own.touch, surface="bare", normal_force=0.7)
    )
    found = with_requirements(made_search(screened=30, solved=4), requirements)
    read = config.load_text(Display, text_of_member(found, found.front[0]))
    assert read == found.display(found.front[0].name)
    assert read.surfaces[0].name == "bare"
    assert "of the stator" in read.provenance["surfaces.0.roughness"].source
    assert read.provenance["surfaces.1.roughness"].source == "paper, section 3.2.1"
    assert read.provenance["actuator.glue.thickness"].source.startswith("given by the requirements")
    assert read.provenance["finger.normal_force"].source.startswith("asked for by")
    given = with_requirements(found, replace(requirements, quality_factor=80.0))
    read = config.load_text(Display, text_of_member(given, given.front[0]))
    assert read.provenance["actuator.quality_factor"].source.startswith("given by")


def test_a_name_with_line_ends_stays_within_its_remark(tmp_path: Path) -> None:
    own = replace(requirements_of(), name='odd\nname = "x"')
    found = with_requirements(made_search(screened=30, solved=4), own)
    text = text_of_member(found, found.front[0])
    assert config.load_text(Display, text) == found.display(found.front[0].name)
