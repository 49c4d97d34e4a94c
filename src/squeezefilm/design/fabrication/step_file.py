"""Bodies as files of solids: STEP (ISO 10303-21, AP214), in millimetres, with exact planes and
cylinders, a solid for each part, as CAD programs read them; and STL, closed triangles that look
outwards, with how far a circle is missed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.numbers import printable
from squeezefilm.physics.plate.parts import WHOLE_TURN, Part, Rectangle, Sector

CHORD_ERROR: si.Metre = 1e-6
"""Largest distance between the middle of a facet and the circle that it stands for, inside it."""
_MOST_FACETS = 4000
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@si.checked_numbers
def facets_round(radius: Annotated[si.Metre, si.Above(0.0)]) -> int:
    """Number of facets round a circle so that none is further than `CHORD_ERROR` inside of it; a
    multiple of 4, at most 4000."""
    ratio = min(CHORD_ERROR / radius, 1.0)
    count = math.ceil(math.pi / math.acos(1 - ratio) / 4) * 4
    return min(max(count, 16), _MOST_FACETS)


@si.checked_numbers
def volume_error(part: Part) -> si.Dimensionless:
    """The share of a part's volume that its facets leave out: 1 − sin φ/φ for facets of an angle φ;
    0 for a rectangle."""
    shape = part.footprint
    if isinstance(shape, Rectangle):
        return 0.0
    angle = (shape.end - shape.start) / _steps(shape)
    return 1 - math.sin(angle) / angle


def triangles_of(part: Part) -> si.FloatArray:
    """A part's surface as triangles, shape (triangles, corners 3, coordinates 3) (m), each going
    round anticlockwise as seen from outside."""
    loops, lid = _outline(part.footprint)
    faces = [_at(lid, part.top), _at(lid[:, ::-1], part.bottom)]
    for points in loops:
        low, high = (
            np.column_stack([points, np.full(len(points), z)]) for z in (part.bottom, part.top)
        )
        low_after, high_after = (np.roll(corners, -1, axis=0) for corners in (low, high))
        faces += [
            np.stack([low, low_after, high_after], axis=1),
            np.stack([low, high_after, high], axis=1),
        ]
    return np.concatenate(faces)


def _steps(shape: Sector) -> int:
    share = (shape.end - shape.start) / WHOLE_TURN
    return max(2, math.ceil(share * facets_round(shape.outer_radius) * (1 - 1e-12)))


def _outline(shape: Rectangle | Sector) -> tuple[list[si.FloatArray], si.FloatArray]:
    """Closed loops that go anticlockwise about the body, shape (points, 2) each, and the face
    within them seen from above, shape (triangles, 3, 2)."""
    if isinstance(shape, Rectangle):
        x, y = (shape.x, shape.x + shape.length), (shape.y, shape.y + shape.width)
        corners = np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])])
        return [corners], _fan(corners)
    count = _steps(shape)
    angles = shape.start + (shape.end - shape.start) * np.arange(count + 1) / count
    turn = np.column_stack([np.cos(angles), np.sin(angles)])
    if shape.is_whole:
        turn[-1] = turn[0]
    rim, hole = shape.outer_radius * turn, shape.inner_radius * turn
    if shape.inner_radius == 0:
        loop = rim[:-1] if shape.is_whole else np.concatenate([np.zeros((1, 2)), rim])
        return [loop], _fan(loop)
    facets = np.concatenate(
        [
            np.stack([hole[:-1], rim[:-1], rim[1:]], axis=1),
            np.stack([hole[:-1], rim[1:], hole[1:]], axis=1),
        ]
    )
    if shape.is_whole:
        return [rim[:-1], hole[:0:-1]], facets
    return [np.concatenate([rim, hole[::-1]])], facets


def _fan(corners: si.FloatArray) -> si.FloatArray:
    """Triangles from the first corner to all others."""
    first = np.broadcast_to(corners[0], corners[2:].shape)
    return np.stack([first, corners[1:-1], corners[2:]], axis=1)


def _at(flat: si.FloatArray, height: si.Metre) -> si.FloatArray:
    return np.concatenate([flat, np.full((len(flat), 3, 1), height)], axis=2)


@si.checked_numbers
def stl_bytes(triangles: si.MetreArray, title: str) -> bytes:
    """A binary STL of triangles (m), shape (triangles, 3, 3), each anticlockwise from outside.

    `title` stands in the header, 80 bytes of ASCII. Single precision: corners within 6e-8 of their
    size. Raises `InputError` for another shape.
    """
    if triangles.ndim != 3 or triangles.shape[1:] != (3, 3):
        raise InputError(
            f"triangles of the shape {triangles.shape} are none; give corners by coordinates, "
            "(triangles, 3, 3)",
            quantity="triangles",
        )
    scaled = 1e3 * np.asarray(triangles, dtype=float)
    normal = np.cross(scaled[:, 1] - scaled[:, 0], scaled[:, 2] - scaled[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    records = np.zeros(len(scaled), dtype=_RECORD)
    records["normal"] = normal / np.where(length > 0, length, 1.0)
    records["corners"] = scaled
    # A header that begins with "solid" would be taken for a file in words.
    head = f"millimetres; {title}".encode("ascii", "replace")[:80].ljust(80)
    return head + len(records).to_bytes(4, "little") + records.tobytes()


Point = tuple[float, float, float]
_UP: Point = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class _Edge:
    """One side of a footprint, in millimetres: straight, or an arc about the origin of a `radius`,
    anticlockwise where that is positive."""

    start: tuple[float, float]
    end: tuple[float, float]
    radius: float = 0.0

    @property
    def outward(self) -> Point:
        """Normal of a straight side that goes anticlockwise about the body; not normalised."""
        return self.end[1] - self.start[1], self.start[0] - self.end[0], 0.0


def step_text(parts: Iterable[Part], name: str, created: str) -> str:
    """Text of a STEP file of parts, each a solid named after its kind and number.

    `name` is that of the product, `created` the UTC time that the head states (ISO 8601).
    """
    file = _StepFile()
    solids = []
    for part in parts:
        file.begin_body()
        label = f"{part.kind} {part.number}" if part.number else part.kind
        solids.append(file.add(f"MANIFOLD_SOLID_BREP('{label}',#{_shell(file, part)})"))
    product = _text(name)
    context = file.add("APPLICATION_CONTEXT('automotive design')")
    file.add(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,"
        f"#{context})"
    )
    of_product = file.add(f"PRODUCT_CONTEXT('',#{context},'mechanical')")
    made = file.add(f"PRODUCT({product},{product},'',(#{of_product}))")
    file.add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{made}))")
    formation = file.add(f"PRODUCT_DEFINITION_FORMATION('','',#{made})")
    of_design = file.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',#{context},'design')")
    definition = file.add(f"PRODUCT_DEFINITION('design','',#{formation},#{of_design})")
    shape = file.add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
    length = file.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    angle = file.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid_angle = file.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    rounding = file.add(
        f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#{length},'distance','rounding')"
    )
    space = file.add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{rounding}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid_angle}))"
        "REPRESENTATION_CONTEXT('',''))"
    )
    origin = file.placed((0.0, 0.0, 0.0), _UP, (1.0, 0.0, 0.0))
    items = _list([origin, *solids])
    bodies = file.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION({product},{items},#{space})")
    file.add(f"SHAPE_DEFINITION_REPRESENTATION(#{shape},#{bodies})")
    return file.text(product, created)


class _StepFile:
    """Entities of the data section, referred to by their numbers, each written once in a body."""

    def __init__(self) -> None:
        self._entities: list[str] = []
        self._numbers: dict[str, int] = {}

    def begin_body(self) -> None:
        """Share nothing with the bodies before: they touch, and are not joined."""
        self._numbers.clear()

    def add(self, entity: str) -> int:
        """The number of an entity, which is added if it is new."""
        if entity not in self._numbers:
            self._entities.append(entity)
            self._numbers[entity] = len(self._entities)
        return self._numbers[entity]

    def point(self, place: Point) -> int:
        return self.add(f"CARTESIAN_POINT('',{_numbers(place)})")

    def direction(self, along: Point) -> int:
        size = math.hypot(*along)
        return self.add(f"DIRECTION('',{_numbers([part / size for part in along])})")

    def placed(self, place: Point, axis: Point, reference: Point) -> int:
        at, up, right = self.point(place), self.direction(axis), self.direction(reference)
        return self.add(f"AXIS2_PLACEMENT_3D('',#{at},#{up},#{right})")

    def line(self, start: Point, end: Point) -> int:
        along = tuple(b - a for a, b in zip(start, end, strict=True))
        vector = self.add(f"VECTOR('',#{self.direction(along)},1.)")  # type: ignore[arg-type] # a point
        return self._edge(start, end, self.add(f"LINE('',#{self.point(start)},#{vector})"), "T")

    def side(self, edge: _Edge, height: float) -> int:
        """The edge of a lid: a line, or an arc."""
        start, end = (*edge.start, height), (*edge.end, height)
        if not edge.radius:
            return self.line(start, end)
        around = self.placed((0.0, 0.0, height), _UP, (1.0, 0.0, 0.0))
        circle = self.add(f"CIRCLE('',#{around},{_number(abs(edge.radius))})")
        return self._edge(start, end, circle, "T" if edge.radius > 0 else "F")

    def _edge(self, start: Point, end: Point, curve: int, sense: str) -> int:
        ends = [self.add(f"VERTEX_POINT('',#{self.point(place)})") for place in (start, end)]
        return self.add(f"EDGE_CURVE('',#{ends[0]},#{ends[1]},#{curve},.{sense}.)")

    def face(self, loops: Sequence[Sequence[tuple[int, bool]]], surface: int, sense: str) -> int:
        """A face within loops of edges, of which the first is the outer one; an edge is passed from
        its start to its end where that is said."""
        bounds = []
        for number, loop in enumerate(loops):
            passed = [
                self.add(f"ORIENTED_EDGE('',*,*,#{edge},.{'T' if forward else 'F'}.)")
                for edge, forward in loop
            ]
            kind = "FACE_BOUND" if number else "FACE_OUTER_BOUND"
            closed = self.add(f"EDGE_LOOP('',{_list(passed)})")
            bounds.append(self.add(f"{kind}('',#{closed},.T.)"))
        return self.add(f"ADVANCED_FACE('',{_list(bounds)},#{surface},.{sense}.)")

    def text(self, product: str, created: str) -> str:
        lines = [f"#{number}={entity};" for number, entity in enumerate(self._entities, 1)]
        head = (
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
            f"FILE_NAME({product},'{created[:19]}',(''),(''),'','squeezefilm','');\n"
            "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
        )
        return head + "\n".join(lines) + "\nENDSEC;\nEND-ISO-10303-21;\n"


def _shell(file: _StepFile, part: Part) -> int:
    """The closed surface of a part: its footprint from one height to the other."""
    low, high = 1e3 * part.bottom, 1e3 * part.top
    loops = _loops(part.footprint)
    above = [[(file.side(edge, high), True) for edge in loop] for loop in loops]
    below = [[(file.side(edge, low), False) for edge in reversed(loop)] for loop in loops]
    right = (1.0, 0.0, 0.0)
    faces = [
        file.face(above, file.add(f"PLANE('',#{file.placed((0.0, 0.0, high), _UP, right)})"), "T"),
        file.face(below, file.add(f"PLANE('',#{file.placed((0.0, 0.0, low), _UP, right)})"), "F"),
    ]
    for edge in (edge for loop in loops for edge in loop):
        upright = [file.line((*place, low), (*place, high)) for place in (edge.start, edge.end)]
        around = [
            (file.side(edge, low), True), (upright[1], True),
            (file.side(edge, high), False), (upright[0], False),
        ]  # fmt: skip
        if edge.radius:
            axis = file.placed((0.0, 0.0, 0.0), _UP, right)
            surface = f"CYLINDRICAL_SURFACE('',#{axis},{_number(abs(edge.radius))})"
        else:
            surface = f"PLANE('',#{file.placed((*edge.start, low), edge.outward, _UP)})"
        faces.append(file.face([around], file.add(surface), "T" if edge.radius >= 0 else "F"))
    return file.add(f"CLOSED_SHELL('',{_list(faces)})")


def _loops(shape: Rectangle | Sector) -> list[list[_Edge]]:
    """The rim of a footprint anticlockwise, and that of its hole clockwise (mm)."""
    if isinstance(shape, Rectangle):
        x, y = 1e3 * shape.x, 1e3 * shape.y
        x_to, y_to = x + 1e3 * shape.length, y + 1e3 * shape.width
        corners = [(x, y), (x_to, y), (x_to, y_to), (x, y_to)]
        return [[_Edge(a, b) for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]]
    inner, outer = 1e3 * shape.inner_radius, 1e3 * shape.outer_radius
    if shape.is_whole:
        # Two halves: an edge that ends where it starts is one that programs disagree about.
        rims = [[_arc(outer, 0.0, math.pi), _arc(outer, math.pi, 2 * math.pi)]]
        if inner:
            rims.append([_arc(-inner, 2 * math.pi, math.pi), _arc(-inner, math.pi, 0.0)])
        return rims
    rim = _arc(outer, shape.start, shape.end)
    if not inner:
        return [[rim, _Edge(rim.end, (0.0, 0.0)), _Edge((0.0, 0.0), rim.start)]]
    hole = _arc(-inner, shape.end, shape.start)
    return [[rim, _Edge(rim.end, hole.start), hole, _Edge(hole.end, rim.start)]]


def _arc(radius: float, start: float, end: float) -> _Edge:
    ends = [
        (abs(radius) * math.cos(angle), abs(radius) * math.sin(angle)) for angle in (start, end)
    ]
    return _Edge(ends[0], ends[1], radius)


def _text(text: str) -> str:
    """A string of the file: printable ASCII, quotes doubled."""
    plain = printable(text).encode("ascii", "replace").decode()
    return "'" + plain.replace("\\", "/").replace("'", "''") + "'"


def _number(value: float) -> str:
    said = f"{round(value, 9) + 0.0:.15G}"
    mantissa, letter, exponent = said.partition("E")
    return (mantissa if "." in mantissa else f"{mantissa}.") + letter + exponent


def _numbers(values: Sequence[float]) -> str:
    return f"({','.join(map(_number, values))})"


def _list(numbers: Sequence[int]) -> str:
    return f"({','.join(f'#{number}' for number in numbers)})"
