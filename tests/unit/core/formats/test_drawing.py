"""A drawing as DXF: sound, with dimensions that measure what they should."""

from __future__ import annotations

import io
import math

import ezdxf
import pytest
from ezdxf.filemanagement import read

from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.drawing import (
    APPLICATION,
    Arc,
    Dimension,
    Drawing,
    Layer,
    Ordinate,
    Polyline,
    Text,
    arrows_outside,
    dxf_text,
    millimetres,
    rectangle,
)

LAYERS = {"A": Layer(7), "B": Layer(1, "DASHDOT", 0.5e-3)}


def opened(*items: object) -> ezdxf.document.Drawing:
    found = read(io.StringIO(dxf_text(Drawing(LAYERS, items))))  # type: ignore[arg-type] # items
    assert not found.audit().errors
    return found


def test_every_item_is_an_entity_in_millimetres_on_its_layer() -> None:
    space = opened(
        rectangle("A", 1e-3, 2e-3, 10e-3, 5e-3),
        Polyline("B", ((0.0, 0.0), (1e-3, 1e-3))),
        Arc("B", 0.0, 0.0, 4e-3),
        Arc("B", 0.0, 0.0, 4e-3, 0.0, math.pi / 2),
        Text("words", 1e-3, 1e-3, align="middle"),
    ).modelspace()
    kinds = [one.dxftype() for one in space]
    assert kinds == ["LWPOLYLINE", "LWPOLYLINE", "CIRCLE", "ARC", "TEXT"]
    assert [tuple(p) for p in space[0].get_points("xy")][2] == pytest.approx((11.0, 7.0))
    assert space[2].dxf.radius == pytest.approx(4.0)
    assert (space[3].dxf.start_angle, space[3].dxf.end_angle) == pytest.approx((0.0, 90.0))
    assert [one.dxf.layer for one in space] == ["A", "B", "B", "B", "TEXT"]


def test_layers_have_their_line_types() -> None:
    found = opened(rectangle("A", 0.0, 0.0, 1e-3, 1e-3))
    layer = found.layers.get("B")
    assert (layer.dxf.linetype, layer.dxf.lineweight, layer.color) == ("DASHDOT", 50, 1)


def test_a_dimension_measures_what_lies_between_its_places() -> None:
    flat = Dimension(1e-3, 0.0, 12.5e-3, 3e-3, 5e-3, 6e-3, 5.5e-3, value_of="actuator.length")
    tall = Dimension(
        0.0, 0.0, 0.0, 11e-3, -3e-3, -4e-3, 5e-3, upright=True, stretch=10.0, suffix=" glue"
    )
    assert (flat.measured, flat.said) == (pytest.approx(11.5e-3), "11.5")
    assert (tall.measured, tall.said) == (pytest.approx(1.1e-3), "1.1 glue")
    first, second = opened(flat, tall).modelspace().query("DIMENSION")
    assert first.get_measurement() == pytest.approx(11.5)
    assert first.get_xdata(APPLICATION)[0].value == "actuator.length"
    # What a program shows is the distance times this factor.
    factor = second.override().get("dimlfac")
    assert second.get_measurement() * factor == pytest.approx(1.1)
    assert second.dxf.text == "<> glue"


def test_an_ordinate_measures_from_the_origin_whichever_way_it_lies() -> None:
    down = Ordinate(3e-3, -7e-3, 9e-3, upright=True, value_of="actuator.patches.1.y")
    assert down.measured == pytest.approx(7e-3)
    assert down.said == "7"
    along = Ordinate(2e-3, 0.0, -5e-3)
    assert along.measured == pytest.approx(2e-3)
    found, other = opened(down, along).modelspace().query("DIMENSION")
    assert abs(found.get_measurement().y) == pytest.approx(7.0)
    assert abs(other.get_measurement().x) == pytest.approx(2.0)


def test_numbers_are_short_and_round_to_a_ten_thousandth() -> None:
    assert [millimetres(one) for one in (0.083, 20e-6, 1.23456e-3, 0.1)] == [
        "83", "0.02", "1.2346", "100",
    ]  # fmt: skip
    assert arrows_outside(1e-3, 2.5e-3)
    assert not arrows_outside(10e-3, 2.5e-3)


def test_the_same_drawing_is_the_same_file() -> None:
    whole = Drawing(LAYERS, (rectangle("A", 0.0, 0.0, 1e-3, 1e-3),))
    assert dxf_text(whole) == dxf_text(whole)
    # In every process, whatever the order that sets have in it.
    classes = [dxf_class.dxf.name for dxf_class in read(io.StringIO(dxf_text(whole))).classes]
    assert classes == sorted(classes)


def test_what_has_no_size_is_refused() -> None:
    with pytest.raises(InputError):
        Arc("A", 0.0, 0.0, 0.0)
    with pytest.raises(InputError):
        Dimension(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, stretch=0.0)
