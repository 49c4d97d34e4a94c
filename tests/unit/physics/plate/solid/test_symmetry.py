"""Which mirrors a plate has, what its drive excites, and how it is layered."""

from __future__ import annotations

import dataclasses
import itertools
from typing import Any

import pytest
from tests.verification.rims import rim_supports

from squeezefilm.core.errors import GeometryError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.layout import (
    CeramicPatch,
    FoamSupport,
    GlueLayer,
    RectangularPlate,
)
from squeezefilm.physics.plate.solid.layers import COARSE, NORMAL
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.symmetry import (
    all_classes,
    drive_classes,
    drive_signs,
    mirror_map,
    symmetric_axes,
    told_of,
)

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)


def patch(x: float, y: float, **changes: Any) -> CeramicPatch:
    """4 mm × 3 mm of half a millimetre."""
    return CeramicPatch(x, y, 4e-3, 3e-3, 0.5e-3, **changes)


def plate(*patches: CeramicPatch, **changes: Any) -> RectangularPlate:
    return RectangularPlate(24e-3, 14e-3, 1.2e-3, 3, 60, GLASS, CERAMIC, tuple(patches), **changes)


LEFT, RIGHT = patch(1e-3, 5.5e-3), patch(19e-3, 5.5e-3)


def test_a_class_is_told_in_plain_words() -> None:
    assert told_of((None, None)) == "all modes"
    assert told_of((None, "A")) == "modes that move opposite on both halves of the width"
    assert told_of(("S", "A")) == (
        "modes that move alike on both halves of the length and "
        "opposite on both halves of the width"
    )


def test_a_mirror_takes_patches_to_patches() -> None:
    both = plate(LEFT, RIGHT)
    assert mirror_map(both, 0) == [1, 0]
    assert mirror_map(both, 1) == [0, 1]
    assert symmetric_axes(both) == (True, True)
    assert symmetric_axes(plate(LEFT)) == (False, True)
    assert symmetric_axes(plate(patch(1e-3, 5e-3), patch(19e-3, 6e-3))) == (False, False)


@pytest.mark.parametrize(
    "changes",
    [
        {"thickness": 0.6e-3}, {"face": "top"}, {"electrode": "open"}, {"x": 19.1e-3},
        {"electrode": "shunted", "shunt_resistance": 10.0}, {"length": 4.1e-3},
    ],
)  # fmt: skip
def test_patches_that_differ_are_no_mirror_images(changes: dict[str, Any]) -> None:
    assert mirror_map(plate(LEFT, dataclasses.replace(RIGHT, **changes)), 0) is None


def test_what_turns_the_sign_only_breaks_no_mirror() -> None:
    for changes in ({"polarity": -1}, {"poling": -1}):
        assert mirror_map(plate(LEFT, dataclasses.replace(RIGHT, **changes)), 0) == [1, 0]


def test_clamped_edges_and_supports_must_be_mirrored_too() -> None:
    both = plate(LEFT, RIGHT)
    for edges, axes in (
        (("left",), (False, True)), (("right",), (False, True)),
        (("left", "right"), (True, True)), (("front",), (True, False)),
        (("front", "back", "left"), (False, True)),
    ):  # fmt: skip
        clamped = dataclasses.replace(both, clamped_edges=edges)  # type: ignore[arg-type]
        assert symmetric_axes(clamped) == axes
    foam = FoamSupport(0.0, 0.0, 1e-3, 14e-3, 2e-3, 1e5, 3.0)
    other = dataclasses.replace(foam, x=23e-3)
    assert symmetric_axes(dataclasses.replace(both, supports=(foam,))) == (False, True)
    assert symmetric_axes(dataclasses.replace(both, supports=(foam, other))) == (True, True)
    stiff = dataclasses.replace(other, young_modulus=2e5)
    assert symmetric_axes(dataclasses.replace(both, supports=(foam, stiff))) == (False, True)


@pytest.mark.parametrize(
    ("left", "right", "classes"),
    [
        ({}, {}, ["S"]),
        ({}, {"polarity": -1}, ["A"]),
        ({"poling": -1}, {"polarity": -1}, ["S"]),
        ({"electrode": "shorted"}, {"electrode": "shorted"}, ["S"]),
    ],
)
def test_a_drive_excites_what_has_its_signs(
    left: dict[str, Any], right: dict[str, Any], classes: list[str]
) -> None:
    one = plate(dataclasses.replace(LEFT, **left), dataclasses.replace(RIGHT, **right))
    assert drive_classes(one) == [(a, "S") for a in classes]
    assert all_classes(one) == [("S", "S"), ("S", "A"), ("A", "S"), ("A", "A")]
    lone = plate(dataclasses.replace(LEFT, **left))
    assert drive_classes(lone) == [(None, "S")]
    assert all_classes(lone) == [(None, "S"), (None, "A")]


def test_a_drive_with_both_parts_excites_both_classes() -> None:
    four = [patch(x, y) for x in (1e-3, 19e-3) for y in (1e-3, 10e-3)]
    # Across y in step on the left and against each other on the right: all but nothing is there.
    signs = [1, 1, 1, -1]
    mixed = plate(*(dataclasses.replace(p, polarity=s) for p, s in zip(four, signs, strict=True)))
    assert drive_signs(mixed).tolist() == signs
    assert drive_classes(mixed) == [("S", "S"), ("S", "A"), ("A", "S"), ("A", "A")]
    turned = dataclasses.replace(four[3], poling=-1, polarity=-1)
    assert drive_signs(plate(*four[:3], turned)).tolist() == [1, 1, 1, 1]


@pytest.mark.parametrize(("near", "order"), [((), 5), ((0.1,), 3)])
@pytest.mark.parametrize("faces", [("bottom",), ("top",), ("bottom", "top")])
@pytest.mark.parametrize("glue", [None, GlueLayer(30e-6, 3e9, 0.35, 1200.0, 40.0)])
def test_layers_lie_one_on_another_and_shrink_towards_the_bonds(
    glue: GlueLayer | None, faces: tuple[str, ...], near: tuple[float, ...], order: int
) -> None:
    layered = plate(*(patch(1e-3, 1e-3, face=face) for face in faces), glue=glue)
    resolution = dataclasses.replace(COARSE, bond_layers=near, order_z=order)
    z = plate_model(layered, 30e3, resolution).model.z
    bond = 0.0 if glue is None else 30e-6
    own, outer = 1.2e-3, 0.5e-3
    expected = {0.0, own}
    if "bottom" in faces:
        expected |= {-bond, -bond - outer}
        expected |= {c * own for c in near} | {-bond - c * outer for c in near}
    if "top" in faces:
        expected |= {own + bond, own + bond + outer}
        expected |= {own - c * own for c in near} | {own + bond + c * outer for c in near}
    assert z.edges == pytest.approx(sorted(expected), abs=1e-12)
    # A thin layer of glue needs no higher order than the fourth.
    thin = [abs(b - a - 30e-6) < 1e-9 for a, b in itertools.pairwise(z.edges)]
    assert z.orders == tuple(min(order, 4) if one else order for one in thin)
    assert sum(thin) == (0 if glue is None else len(faces))


def test_a_class_that_the_plate_does_not_have_is_refused() -> None:
    with pytest.raises(GeometryError, match="not symmetric along x"):
        plate_model(plate(LEFT), 30e3, NORMAL, ("S", None))
    with pytest.raises(GeometryError, match="not symmetric along y"):
        plate_model(plate(patch(1e-3, 1e-3)), 30e3, NORMAL, (None, "A"))


@pytest.mark.parametrize("dx", [-5e-3, -4e-3, -3e-3, 0.0, 2e-3, 4e-3, 5e-3])
@pytest.mark.parametrize("dy", [-4e-3, -3e-3, -1e-3, 0.0, 2e-3, 3e-3])
def test_parts_of_one_face_overlap_where_they_do_along_both_sides(dx: float, dy: float) -> None:
    other = patch(10e-3 + dx, 5e-3 + dy)
    foam = FoamSupport(10e-3 + dx, 5e-3 + dy, 4e-3, 3e-3, 2e-3, 1e5, 3.0)
    plate(patch(10e-3, 5e-3), dataclasses.replace(other, face="top"))
    plate(patch(10e-3, 5e-3), supports=(dataclasses.replace(foam, face="top"),))
    x, y = 4 - abs(dx) * 1e3, 3 - abs(dy) * 1e3
    if x <= 1e-6 or y <= 1e-6:
        plate(patch(10e-3, 5e-3), other)
        plate(patch(10e-3, 5e-3), supports=(foam,))
        return
    with pytest.raises(GeometryError, match=f"ceramics 1 and 2 overlap by {x:g} mm × {y:g} mm"):
        plate(patch(10e-3, 5e-3), other)
    with pytest.raises(GeometryError, match=f"ceramic 1 and support 1 overlap by {x:g} mm × "):
        plate(patch(10e-3, 5e-3), supports=(foam,))


def test_a_rim_of_foam_is_four_strips_that_do_not_overlap() -> None:
    strips = rim_supports(24e-3, 14e-3, 2e-3, 3e-3, 1e5, 4.0, "top")
    area = sum(one.length * one.width for one in strips)
    assert area == pytest.approx(24e-3 * 14e-3 - 20e-3 * 10e-3)
    for one in strips:
        assert one.x + one.length <= 24e-3 + 1e-12
        assert one.y + one.width <= 14e-3 + 1e-12
        assert min(one.x, one.y, 24e-3 - one.x - one.length, 14e-3 - one.y - one.width) < 1e-12
        assert (one.thickness, one.young_modulus, one.quality_factor) == (3e-3, 1e5, 4.0)
        assert (one.face, one.shear_modulus) == ("top", None)
    for i, a in enumerate(strips):
        for b in strips[:i]:
            apart = a.x + a.length <= b.x + 1e-12 or b.x + b.length <= a.x + 1e-12
            assert apart or a.y + a.width <= b.y + 1e-12 or b.y + b.width <= a.y + 1e-12
    # A third of Young's modulus in shear where no shear modulus is given.
    assert strips[0].stiffness_per_area == pytest.approx((1e5 / 9e-3, 1e5 / 9e-3, 1e5 / 3e-3))
    soft = dataclasses.replace(strips[0], shear_modulus=1.2e4)
    assert soft.stiffness_per_area == pytest.approx((4e6, 4e6, 1e5 / 3e-3))
