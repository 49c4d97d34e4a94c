"""The drawings of all shapes: sound as DXF, their dimensions those of the description, their texts
apart."""

from __future__ import annotations

import dataclasses
import io
import itertools
from collections.abc import Callable
from typing import Any

import pytest
from ezdxf.filemanagement import read
from hypothesis import given, settings
from hypothesis import strategies as st

import squeezefilm as sf
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.distributions import Normal, Uniform
from squeezefilm.core.formats.drawing import APPLICATION, Drawing, dxf_text
from squeezefilm.core.kit.sheet import sheet_figure
from squeezefilm.design.fabrication.fabricate import Fabrication
from squeezefilm.design.fabrication.report import sheet_parts
from squeezefilm.design.fabrication.report.page import drawing_sheet
from squeezefilm.design.fabrication.report.plans import rectangular_sheet
from squeezefilm.design.fabrication.report.rows import layout_rows
from squeezefilm.design.fabrication.report.section_view import Cut, best_cut, spans, stretch_for
from squeezefilm.design.fabrication.report.sheet_parts import (
    LETTER,
    PAPER,
    Sheet,
    scale_for,
    table,
    tolerance_said,
)
from squeezefilm.design.fabrication.wiring import NodalLines
from squeezefilm.physics.plate.layout import CeramicPatch, DiscPlate, RectangularPlate
from squeezefilm.physics.uncertainty.parameters import value_at

Preset = Callable[[str], Fabrication]
WithBody = Callable[..., Fabrication]


ORDINATE = 6
"""The kind of a dimension in a DXF that shows a distance from the origin."""


def entities(drawing: Drawing, kind: str, layer: str = "*") -> list[Any]:
    """The entities of a kind on a layer, on all without one."""
    where = "" if layer == "*" else f'[layer=="{layer}"]'
    return list(drawing.document.modelspace().query(f"{kind}{where}"))


def number_of(dimension: Any) -> Any:
    """The text of a dimension, as it stands on the paper."""
    (text,) = (part for part in dimension.virtual_entities() if part.dxftype() == "MTEXT")
    return text


def words_of(drawing: Drawing) -> list[str]:
    """All that is written beside the dimensions."""
    return [text.dxf.text for text in entities(drawing, "TEXT")]


def shown(drawing: Drawing) -> dict[str, list[float]]:
    """What the dimensions of a DXF show (mm), by the key of the value that they are of."""
    found = read(io.StringIO(dxf_text(drawing)))
    assert not found.audit().errors
    values: dict[str, list[float]] = {}
    for one in found.modelspace().query("DIMENSION"):
        if not one.has_xdata(APPLICATION):
            continue
        key = one.get_xdata(APPLICATION)[0].value
        measured: Any = one.get_measurement()
        if one.dimtype == ORDINATE:
            along_x = bool(one.dxf.dimtype & 64)
            measured = abs(measured.x if along_x else measured.y)
        values.setdefault(key, []).append(measured * one.override().get("dimlfac"))
    return values


def require_those_of_the_description(made: Fabrication, drawing: Drawing) -> dict[str, list[float]]:
    """All dimensions of a drawing are the description's values."""
    found = shown(drawing)
    for key, values in found.items():
        wanted = 1e3 * value_at(made.display, key)[0]
        assert values == pytest.approx([wanted] * len(values), abs=1e-6), key
    return found


def require_apart(drawing: Drawing) -> None:
    """No text lies on another or off the paper, by the room that letters take (mm)."""
    boxes = []
    for text in entities(drawing, "TEXT"):
        align, (x, y, _), _ = text.get_placement()
        half, size = 0.72 * len(text.dxf.text) * text.dxf.height / 2, text.dxf.height
        turned = text.dxf.rotation != 0
        middle = x + half * (0 if turned else {"L": 1, "C": 0, "R": -1}[align.name[7]])
        wide, high = (size / 2, half) if turned else (half, size / 2)
        boxes.append((text.dxf.text, middle - wide, y - high, middle + wide, y + high))
    for dimension in entities(drawing, "DIMENSION"):
        if dimension.dimtype != ORDINATE:
            text = number_of(dimension)
            (x, y, _), high = text.dxf.insert, text.dxf.char_height / 2
            half = 0.72 * len(text.text) * high
            boxes.append((text.text, x - half, y - high, x + half, y + high))
    x, y = (1e3 * place for place in drawing.corner)
    ends = [
        start + 1e3 * extent / drawing.scale
        for start, extent in zip((x, y), drawing.paper, strict=True)
    ]
    for said, left, bottom, right, top in boxes:
        assert x < left < right < ends[0], said
        assert y < bottom < top < ends[1], said
    for a, b in itertools.combinations(boxes, 2):
        apart = a[3] <= b[1] or b[3] <= a[1] or a[4] <= b[2] or b[4] <= a[2]
        assert apart, (a[0], b[0])


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] * name.endswith("glass"))
        for name in sf.display_names()
    ],
)
def test_every_preset_has_a_sound_drawing_of_its_own_sizes(preset: Preset, name: str) -> None:
    made = preset(name)
    drawing = drawing_sheet(made)
    found = require_those_of_the_description(made, drawing)
    require_apart(drawing)
    wanted = {
        "rectangular_plate": {"actuator.length", "actuator.width", "actuator.thickness"},
        "disc": {"actuator.diameter", "actuator.thickness", "actuator.ceramic_thickness"},
        "annular_stator": {"actuator.mean_diameter", "actuator.radial_width"},
    }[made.display.actuator.type]
    assert wanted <= set(found)


@pytest.mark.parametrize("name", ["biet2008-plate", "winfield2007-tpad"])
def test_a_sheet_is_as_described(
    preset: Preset, name: str, figures_as_described: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    origin = {
        "squeezefilm_version": "1.2.3",
        "config_sha256": "0123456789abcdef" * 4,
        "created_utc": "2026-01-02T03:04:05+00:00",
    }
    monkeypatch.setattr(sheet_parts, "stamp", lambda _: origin)
    sheet_figure(drawing_sheet(preset(name)))


@st.composite
def plates(draw: st.DrawFn) -> RectangularPlate:
    """Plates of any size with 1 to 11 strips along either side, on one face or both."""
    base = sf.load_display(draw(st.sampled_from(["biet2008-plate", "touchpad-glass"]))).actuator
    assert isinstance(base, RectangularPlate)
    length, width = draw(st.floats(8e-3, 0.3)), draw(st.floats(4e-3, 0.3))
    count, along_x = draw(st.integers(1, 11)), draw(st.booleans())
    side, other = (length, width) if along_x else (width, length)
    pitch, share = side / count, draw(st.floats(0.3, 0.98))
    inset = draw(st.floats(0.0, 0.3)) * other
    patches = []
    for number in range(count):
        place = (number * pitch, inset, share * pitch, other - inset)
        x, y, dx, dy = place if along_x else (place[1], place[0], place[3], place[2])
        patches.append(
            CeramicPatch(
                x, y, dx, dy, draw(st.floats(0.1e-3, 2e-3)),
                polarity=draw(st.sampled_from([1, -1])),
                poling=draw(st.sampled_from([1, -1])),
                face=draw(st.sampled_from(["bottom", "bottom", "top"])),
            )
        )  # fmt: skip
    return dataclasses.replace(
        base,
        length=length,
        width=width,
        thickness=draw(st.floats(0.3e-3, 5e-3)),
        patches=tuple(patches),
        supports=(),
    )


@pytest.mark.slow
@settings(settings.get_profile("dear"))
@given(plate=plates())
def test_dimensions_of_any_plate_are_its_description(
    preset: Preset, with_body: WithBody, plate: RectangularPlate
) -> None:
    made = with_body(preset("biet2008-plate"), plate)
    found = require_those_of_the_description(made, drawing_sheet(made))
    assert {"actuator.length", "actuator.width", "actuator.thickness"} <= set(found)
    assert "actuator.patches.0.length" in found
    assert any(key.endswith(".thickness") and "patches" in key for key in found)


@pytest.mark.parametrize("face", ["bottom", "top"])
def test_eleven_strips_on_a_thin_plate_are_legible(
    preset: Preset, with_body: WithBody, face: Any
) -> None:
    base = preset("biet2008-plate")
    plate = base.display.actuator
    assert isinstance(plate, RectangularPlate)
    strips = tuple(
        CeramicPatch(1e-3 + k * 10.75e-3, 1e-3, 9.5e-3, 18e-3, 0.2e-3, (-1) ** k, face)  # type: ignore[arg-type] # ±1
        for k in range(11)
    )
    thin = dataclasses.replace(plate, length=0.12, width=0.02, thickness=0.5e-3, patches=strips)
    drawing = rectangular_sheet(with_body(base, thin), ("A is driven with +V, B with −V.",))
    require_apart(drawing)
    ordinates = [one for one in entities(drawing, "DIMENSION") if one.dimtype == ORDINATE]
    starts = [number_of(one).text for one in ordinates if one.dxf.dimtype & 64]
    assert starts == [f"{1 + 10.75 * k:g}" for k in range(11)]
    assert {"1 A", "2 B", "11 A"} <= set(words_of(drawing))
    # Seen from below y runs down the sheet; from above, up.
    (outline,) = entities(drawing, "LWPOLYLINE", "OUTLINE")
    ys = [y for _, y in outline.get_points("xy")]
    assert (min(ys), max(ys)) == pytest.approx((-20.0, 0.0) if face == "bottom" else (0.0, 20.0))


def test_a_small_disc_and_a_ring_of_sectors_are_legible(
    preset: Preset, with_body: WithBody
) -> None:
    base = preset("winfield2007-tpad")
    disc = base.display.actuator
    assert isinstance(disc, DiscPlate)
    small = dataclasses.replace(
        disc, diameter=5e-3, ceramic_outer_diameter=5e-3, thickness=0.3e-3, ceramic_thickness=0.2e-3
    )
    ring = dataclasses.replace(
        disc, inner_diameter=6e-3, ceramic_inner_diameter=8e-3, ceramic_outer_diameter=22e-3,
        nodal_circles=0, nodal_diameters=2, sectors=4,
    )  # fmt: skip
    for body, keys in ((small, 5), (ring, 7)):
        made = with_body(base, body)
        drawing = drawing_sheet(made)
        require_apart(drawing)
        assert len(require_those_of_the_description(made, drawing)) == keys
        words = words_of(drawing)
        for name, kind in (("Substrate", "substrate"), ("Ceramic", "ceramic")):
            materials = {part.material for part in made.parts if part.kind == kind}
            assert words[words.index(name) + 1] in materials


def test_nodal_lines_leave_labels_free(preset: Preset) -> None:
    # Through the middle of the first ceramic, where its number stands.
    nodal = NodalLines("x", (5.5e-3, 41.5e-3))
    drawing = drawing_sheet(dataclasses.replace(preset("biet2008-plate"), nodal=nodal))
    labels = [
        text
        for text in entities(drawing, "TEXT")
        if text.get_placement()[0].name == "MIDDLE_CENTER"
    ]
    lines = [line.get_points("xy") for line in entities(drawing, "LWPOLYLINE", "NODAL_LINES")]
    assert len(lines) > 2  # they are interrupted
    for text, ((x, low), (_, high)) in itertools.product(labels, lines):
        half = 0.72 * len(text.dxf.text) * text.dxf.height / 2
        _, place, _ = text.get_placement()
        crossed = abs(x - place.x) < half and min(low, high) < place.y < max(low, high)
        assert not crossed, text.dxf.text


def test_tolerances_of_the_description_stand_behind_their_numbers(
    preset: Preset, with_body: WithBody
) -> None:
    base = preset("biet2008-plate")
    stated = {
        **base.display.provenance,
        "actuator.length": Provenance("drawing 17", "measured", Normal(83e-3, 0.05e-3)),
        "actuator.thickness": Provenance("sheet", "measured", Uniform(1.9e-3, 2.2e-3)),
    }
    made = with_body(base, base.display.actuator, provenance=stated)
    drawing = drawing_sheet(made)
    said = {
        one.get_xdata(APPLICATION)[0].value: number_of(one).text
        for one in entities(drawing, "DIMENSION")
    }
    assert said["actuator.length"] == "83 ±0.1"
    assert said["actuator.thickness"] == "2 (1.9 to 2.2)"
    assert said["actuator.width"] == "49"
    require_those_of_the_description(made, drawing)
    assert tolerance_said(made.display, "actuator.width") == ""
    even = {"actuator.thickness": Provenance("sheet", "measured", Uniform(1.9e-3, 2.1e-3))}
    narrow = with_body(base, base.display.actuator, provenance=even)
    assert tolerance_said(narrow.display, "actuator.thickness") == " ±0.1"
    assert any("two standard deviations" in one for one in drawing.notes)
    assert any("states no tolerance" in one for one in drawing_sheet(base).notes)


def test_the_cut_meets_as_many_ceramics_as_can_be(preset: Preset) -> None:
    assert best_cut(preset("biet2008-plate").parts).upright is False
    glass = preset("touchpad-glass").parts
    cut = best_cut(glass)
    assert cut == Cut(True, 0.05)
    assert [spans(one, cut) for one in glass if one.kind == "ceramic"] == [
        [(0.0, 5e-3)],
        [(pytest.approx(55e-3), pytest.approx(60e-3))],
    ]
    assert stretch_for(3e-3, 2.0) == 5
    assert stretch_for(1.0, 1.0) == 1


def test_scales_are_usual_ones() -> None:
    scales = [scale_for(one, one, (100.0, 100.0)) for one in (5e-3, 0.06, 0.3)]
    assert scales == [20.0, 1.0, 0.2]
    assert scale_for(90.0, 90.0, (100.0, 100.0)) == pytest.approx(100 / 90e3)
    assert scale_for(0.083, 0.049, (172.0, 150.0)) == 2.0


def test_a_table_that_is_too_long_says_what_is_left_out() -> None:
    sheet = Sheet(sf.load_display("biet2008-plate"), 1.0, (0.0, 0.0))
    rows = [(f"{k}", "x" * 500) for k in range(200)]
    assert table(sheet, ("No.", "Long"), rows, 280.0, 180.0) > 150.0
    texts = words_of(sheet)
    assert any("more: electrodes.csv" in one for one in texts)
    longest = max(len(one) for one in texts)
    assert longest * LETTER * 2.0 < PAPER[0]


def test_rows_of_ceramics_and_sectors_are_in_millimetres_and_degrees(preset: Preset) -> None:
    _, rows = layout_rows(preset("biet2008-plate"))
    assert rows[1] == ("2", "12", "0", "11", "49", "1", "B", "away")
    _, sectors = layout_rows(preset("biet2008-stator"))
    assert sectors[1] == ("E2", "20°", "40°", "A", "towards")


def test_tolerances_without_room_are_a_note(preset: Preset, with_body: WithBody) -> None:
    base = preset("winfield2007-tpad")
    stated = {
        f"actuator.{key}": Provenance("a", "measured", Uniform(0.123 * value, 1.0123 * value))
        for key, value in (
            ("thickness", 1.6e-3),
            ("ceramic_thickness", 1e-3),
            ("glue.thickness", 2e-5),
        )
    }
    made = with_body(base, base.display.actuator, provenance=stated)
    drawing = drawing_sheet(made)
    require_apart(drawing)
    assert any(one.startswith("Thicknesses: substrate 1.6 (") for one in drawing.notes)


def test_ceramics_on_both_faces_have_their_thicknesses(preset: Preset, with_body: WithBody) -> None:
    base = preset("biet2008-plate")
    plate = base.display.actuator
    assert isinstance(plate, RectangularPlate)
    above = tuple(dataclasses.replace(one, face="top", thickness=0.3e-3) for one in plate.patches)
    made = with_body(base, dataclasses.replace(plate, patches=(*plate.patches, *above)))
    drawing = drawing_sheet(made)
    require_apart(drawing)
    found = require_those_of_the_description(made, drawing)
    assert {"actuator.patches.6.thickness", "actuator.patches.13.thickness"} <= set(found)
    assert "Dashed: 7 ceramics on the upper face." in drawing.notes
