"""Bodies as STEP: another program opens them, finds them sound, and measures what they are."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

import squeezefilm as sf
from squeezefilm.design.fabrication.step_file import step_text
from squeezefilm.physics.plate.parts import Part, Rectangle, Sector, parts_of

CREATED = "2026-01-02T03:04:05+00:00"
# A ring, half a turn and more of one, a slice of a disc, a disc, a plate off the origin.
FOOTPRINTS = (
    Sector(2e-3, 10e-3),
    Sector(2e-3, 10e-3, 0.3, 6.0),
    Sector(0.0, 10e-3, -0.3, 2.0),
    Sector(0.0, 10e-3),
    Rectangle(-1e-3, 2e-3, 83e-3, 49e-3),
)
PARTS = tuple(
    Part("ceramic", number, "P1-91", 7700.0, shape, -1e-3, 0.25e-3)
    for number, shape in enumerate(FOOTPRINTS, 1)
)


def measured(file: Path) -> list[tuple[float, Any]]:
    """Volume (mm³) and centre (mm) of each solid that Open CASCADE reads; each is sound."""
    check = pytest.importorskip("OCP.BRepCheck", reason="Open CASCADE: the extra oracles has it")
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer

    reader = STEPControl_Reader()
    reader.ReadFile(str(file))
    reader.TransferRoots()
    shape = reader.OneShape()
    assert check.BRepCheck_Analyzer(shape).IsValid()
    solids, found = TopExp_Explorer(shape, TopAbs_SOLID), []
    while solids.More():
        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(solids.Current(), properties)
        centre = properties.CentreOfMass()
        found.append((properties.Mass(), (centre.X(), centre.Y(), centre.Z())))
        solids.Next()
    return found


def centre(part: Part) -> tuple[float, float, float]:
    """Centre of mass of a part (mm)."""
    shape, height = part.footprint, 1e3 * (part.bottom + part.top) / 2
    if isinstance(shape, Rectangle):
        return 1e3 * (shape.x + shape.length / 2), 1e3 * (shape.y + shape.width / 2), height
    half, middle = (shape.end - shape.start) / 2, (shape.end + shape.start) / 2
    cubes = shape.outer_radius**3 - shape.inner_radius**3
    squares = shape.outer_radius**2 - shape.inner_radius**2
    away = 1e3 * 2 / 3 * math.sin(half) / half * cubes / squares
    return away * math.cos(middle), away * math.sin(middle), height


@pytest.mark.parametrize("parts", [PARTS, parts_of(sf.load_display("biet2008-stator").actuator)])
def test_another_program_measures_the_same_bodies(parts: tuple[Part, ...], tmp_path: Path) -> None:
    file = tmp_path / "assembly.step"
    file.write_text(step_text(parts, "made 'so'\n", CREATED), encoding="ascii")
    found = measured(file)
    assert len(found) == len(parts)
    for part, (volume, place) in zip(parts, found, strict=True):
        assert volume == pytest.approx(1e9 * part.volume, rel=1e-8)
        assert place == pytest.approx(centre(part), abs=1e-6)


def test_bodies_share_no_entities_of_a_shape_and_names_are_text() -> None:
    text = step_text(PARTS[:2], "made 'so'\\\n", CREATED)
    assert text.startswith("ISO-10303-21;\nHEADER;\n")
    assert text.endswith("ENDSEC;\nEND-ISO-10303-21;\n")
    assert "'2026-01-02T03:04:05'" in text
    assert "PRODUCT('made ''so''/" in text
    assert "MANIFOLD_SOLID_BREP('ceramic 1'" in text
    entities = dict(line.split("=", 1) for line in text.splitlines() if line.startswith("#"))
    assert list(entities) == [f"#{number}" for number in range(1, len(entities) + 1)]
    # Two rings of the same planes: each body has its own.
    assert sum(entity.startswith("PLANE(") for entity in entities.values()) == 2 + 4
