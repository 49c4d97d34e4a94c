"""A drawing as DXF: sound, with dimensions that measure what they should."""

from __future__ import annotations

import io
import math
from typing import Any

import pytest
from ezdxf.filemanagement import read

from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.drawing import (
    APPLICATION,
    Drawing,
    Layer,
    arrows_outside,
    dxf_text,
    millimetres,
)

LAYERS = {"A": Layer(7), "B": Layer(1, "DASHDOT", 0.5e-3)}


@pytest.fixture
def drawing() -> Drawing:
    return Drawing(LAYERS)


def opened(drawing: Drawing) -> Any:
    document = read(io.StringIO(dxf_text(drawing)))
    assert not document.audit().errors
    return document


def test_every_item_is_an_entity_in_millimetres_on_its_layer(drawing: Drawing) -> None:
    drawing.rectangle("A", 1e-3, 2e-3, 10e-3, 5e-3)
    drawing.line("B", ((0.0, 0.0), (1e-3, 1e-3)))
    drawing.arc("B", 0.0, 0.0, 4e-3)
    drawing.arc("B", 0.0, 0.0, 4e-3, 0.0, math.pi / 2)
    drawing.text("words", 1e-3, 1e-3, align="center")
    space = opened(drawing).modelspace()
    kinds = [one.dxftype() for one in space]
    assert kinds == ["LWPOLYLINE", "LWPOLYLINE", "CIRCLE", "ARC", "TEXT"]
    assert [tuple(p) for p in space[0].get_points("xy")][2] == pytest.approx((11.0, 7.0))
    assert space[2].dxf.radius == pytest.approx(4.0)
    assert (space[3].dxf.start_angle, space[3].dxf.end_angle) == pytest.approx((0.0, 90.0))
    assert [one.dxf.layer for one in space] == ["A", "B", "B", "B", "TEXT"]


def test_layers_have_their_line_types(drawing: Drawing) -> None:
    layer = opened(drawing).layers.get("B")
    assert (layer.dxf.linetype, layer.dxf.lineweight, layer.color) == ("DASHDOT", 50, 1)


def said(dimension: Any) -> str:
    """The text that a dimension shows on paper."""
    (text,) = (part.text for part in dimension.virtual_entities() if part.dxftype() == "MTEXT")
    return str(text)


def test_a_dimension_measures_what_lies_between_its_places(drawing: Drawing) -> None:
    key = "actuator.length"
    drawing.dimension((1e-3, 0.0), (12.5e-3, 3e-3), 5e-3, (6e-3, 5.5e-3), value_of=key)
    drawing.dimension(
        (0.0, 0.0), (0.0, 11e-3), -3e-3, (-4e-3, 5e-3), upright=True, stretch=10.0, suffix=" glue"
    )
    first, second = opened(drawing).modelspace().query("DIMENSION")
    assert (said(first), said(second)) == ("11.5", "1.1 glue")
    assert first.get_measurement() == pytest.approx(11.5)
    assert first.get_xdata(APPLICATION)[0].value == key
    # What a program shows is the distance times this factor.
    factor = second.override().get("dimlfac")
    assert second.get_measurement() * factor == pytest.approx(1.1)
    assert second.dxf.text == "<> glue"


def test_an_ordinate_measures_from_the_origin_whichever_way_it_lies(drawing: Drawing) -> None:
    drawing.ordinate(3e-3, -7e-3, 9e-3, upright=True, value_of="actuator.patches.1.y")
    drawing.ordinate(2e-3, 0.0, -5e-3)
    down, along = opened(drawing).modelspace().query("DIMENSION")
    assert (said(down), said(along)) == ("7", "2")
    assert abs(down.get_measurement().y) == pytest.approx(7.0)
    assert abs(along.get_measurement().x) == pytest.approx(2.0)


def test_numbers_are_short_and_round_to_a_ten_thousandth() -> None:
    assert [millimetres(one) for one in (0.083, 20e-6, 1.23456e-3, 0.1)] == [
        "83", "0.02", "1.2346", "100",
    ]  # fmt: skip
    assert arrows_outside(1e-3, 2.5e-3)
    assert not arrows_outside(10e-3, 2.5e-3)


def test_the_same_drawing_is_the_same_file(drawing: Drawing) -> None:
    other = Drawing(LAYERS)
    for each in (drawing, other):
        each.rectangle("A", 0.0, 0.0, 1e-3, 1e-3)
    assert dxf_text(drawing) == dxf_text(drawing) == dxf_text(other)
    # In every process, whatever the order that sets have in it.
    classes = [dxf_class.dxf.name for dxf_class in opened(drawing).classes]
    assert classes == sorted(classes)


def test_what_has_no_size_is_refused(drawing: Drawing) -> None:
    with pytest.raises(InputError):
        drawing.arc("A", 0.0, 0.0, 0.0)
    with pytest.raises(InputError):
        drawing.dimension((0.0, 0.0), (1.0, 0.0), 0.0, (0.0, 0.0), stretch=0.0)
