"""What is asked of a track, in texts, and modes that are followed by how they move."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from squeezefilm.analysis.parameters import value_at
from squeezefilm.analysis.plate import tracking
from squeezefilm.analysis.plate.tracking import (
    PARAMETERS,
    ModeTracks,
    TrackRequest,
    check_track,
    likeness,
    parse_track,
    track_modes,
)
from squeezefilm.display import load_display
from squeezefilm.errors import InputError
from squeezefilm.plate.layout import GlueLayer, RectangularPlate

OWN = 8250.0  # kg/m³ of the paper's plate; density is what these plates are varied by


def test_ends_have_the_unit_of_the_parameter() -> None:
    found = parse_track("thickness", "0.5 mm", "1.5 mm", 5)
    assert found == TrackRequest("thickness", 0.5e-3, 1.5e-3, 5)
    assert parse_track("young_modulus", "60 GPa", "70 GPa", 2).stop == 70e9
    assert parse_track("poisson_ratio", "0.2", "0.4", 3) == TrackRequest(
        "poisson_ratio", 0.2, 0.4, 3
    )


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_parameter_can_be_asked_for_in_its_unit(name: str) -> None:
    unit = PARAMETERS[name][0].label
    assert parse_track(name, f"0.1 {unit}".strip(), f"0.3 {unit}".strip(), 2).stop == 0.3
    if unit:
        with pytest.raises(InputError):
            parse_track(name, "0.1", "0.3", 2)


def test_one_end_is_not_enough() -> None:
    for ends in ((None, "1 mm"), ("1 mm", None)):
        with pytest.raises(InputError, match="--from and --to"):
            parse_track("thickness", *ends, 3)


def test_a_track_needs_two_different_ends() -> None:
    with pytest.raises(InputError, match="--from must be smaller than --to"):
        TrackRequest("thickness", 1e-3, 1e-3)
    assert TrackRequest("thickness", 1e-3, 2e-3).values == 9


@dataclasses.dataclass(frozen=True)
class Motion:
    """A mode as it is made up here: orthogonal motions, each as much as `parts` says."""

    frequency: float
    parts: tuple[float, ...]
    label: tuple[int, int] | None = (8, 0)
    force: float = 1.0


@dataclasses.dataclass(frozen=True)
class Solved:
    """What a track asks of solved modes."""

    plate: RectangularPlate
    modes: tuple[Motion, ...]

    @property
    def count(self) -> int:
        return len(self.modes)

    @property
    def frequencies(self) -> np.ndarray:
        return np.array([one.frequency for one in self.modes])

    @property
    def labels(self) -> tuple[tuple[int, int] | None, ...]:
        return tuple(one.label for one in self.modes)

    @property
    def drive_forces(self) -> np.ndarray:
        return np.array([one.force for one in self.modes])

    def index(self, label: tuple[int, int]) -> int:
        return self.labels.index(label)

    def field(self, mode: int, x: np.ndarray, y: np.ndarray, z: float) -> np.ndarray:
        """The plate as a whole along x, y or z; or the two faces against each other (the last)."""
        assert (x[0], x[-1]) == (0.0, self.plate.length)
        assert (y[0], y[-1]) == (0.0, self.plate.width)
        assert z in (0.0, self.plate.thickness)
        parts = (*self.modes[mode].parts, 0.0, 0.0, 0.0)[:4]
        side = 1.0 if z else -1.0
        moved = np.array([parts[0], parts[1], parts[2] + side * parts[3]])
        return np.broadcast_to(moved, (x.size, y.size, 3))


@pytest.fixture
def paper() -> RectangularPlate:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    assert plate.substrate.density == OWN
    return plate


class Bench:
    """A plate whose modes at a density are what `motions` says; it keeps what was solved."""

    def __init__(self, paper: RectangularPlate, monkeypatch: pytest.MonkeyPatch) -> None:
        self.paper = paper
        self.asked: list[tuple[float, Any]] = []
        self.told: list[str] = []
        self.motions: Callable[[float], tuple[Motion, ...]] = lambda _: ()
        monkeypatch.setattr(tracking, "solve_modes", self.solve)

    def solve(
        self, plate: RectangularPlate, *, mode: Any = None, band: tuple[float, float] | None = None
    ) -> Solved:
        density = plate.substrate.density
        self.asked.append((density, mode if band is None else band))
        every = sorted(self.motions(density), key=lambda one: one.frequency)
        if band is not None:
            every = [one for one in every if band[0] <= one.frequency <= band[1]]
        return Solved(plate, tuple(every))

    def track(
        self, *ends: float, values: int, motions: Callable[[float], tuple[Motion, ...]], **more: Any
    ) -> ModeTracks:
        self.motions = motions
        request = TrackRequest("density", *ends, values)
        return track_modes(self.paper, request, progress=self.told.append, **more)


@pytest.fixture
def bench(paper: RectangularPlate, monkeypatch: pytest.MonkeyPatch) -> Bench:
    return Bench(paper, monkeypatch)


def turned(degrees: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Two orthogonal motions that turn into each other: (cos)² is how alike they stay."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return (float(c), float(s)), (-float(s), float(c))


def test_lines_follow_the_motion_through_a_crossing(bench: Bench) -> None:
    def motions(density: float) -> tuple[Motion, ...]:
        away = (density - OWN) / 100
        return (
            Motion(30e3 + 40 * away, (1.0,), (8, 0), force=-2.0),
            Motion(30.05e3 - 40 * away, (0.0, 1.0), (0, 5), force=1.9e-6),
            Motion(31e3, (0.0, 0.0, 1.0), None, force=2.1e-6),
            # Too far from the working mode to be followed.
            Motion(32.5e3, (0.0, 0.0, 0.0, 1.0), (3, 2)),
        )

    found = bench.track(OWN - 200, OWN + 200, values=5, motions=motions)
    assert found.values == pytest.approx(OWN + np.array([-200, -100, 0, 100, 200]))
    assert (found.parameter, found.unit, found.own, found.begun) == ("density", "kg/m3", OWN, OWN)
    assert [one.label for one in found.tracks] == ["(8,0)", "(0,5)", "in plane"]
    # The line of the driven mode rises through the other's, whatever the order of frequencies.
    assert found.tracks[0].frequency == pytest.approx(30e3 + 40 * np.arange(-2, 3))
    assert found.tracks[1].frequency == pytest.approx(30.05e3 - 40 * np.arange(-2, 3))
    assert found.tracks[2].frequency == pytest.approx(np.full(5, 31e3))
    # Driven is what has more than a millionth of the largest force, of either sign.
    assert [one.driven for one in found.tracks] == [True, False, True]
    for one in found.tracks:
        assert one.likeness == pytest.approx(np.ones(5))
    assert found.least_likeness == pytest.approx(1.0)
    # From its own value upwards, then from there downwards; each said before it is solved.
    order = [8250, 8350, 8450, 8150, 8050]
    assert bench.told == [f"density = {one} kg/m3" for one in order]
    assert bench.asked[0] == (OWN, (8, 0))
    assert bench.asked[1] == (OWN, pytest.approx((0.92 * 30e3, 1.08 * 30e3)))
    assert [density for density, _ in bench.asked[2:]] == pytest.approx(order[1:])


def test_a_mode_asked_for_is_the_one_that_others_are_near(bench: Bench) -> None:
    def motions(_: float) -> tuple[Motion, ...]:
        return (
            Motion(20e3, (1.0,), (6, 0)),
            Motion(21e3, (0.0, 0.0, 1.0), (1, 4)),
            Motion(30e3, (0.0, 1.0), (8, 0)),
        )

    found = bench.track(8000, 8500, values=2, motions=motions, label=(6, 0))
    assert [one.label for one in found.tracks] == ["(6,0)", "(1,4)"]


@pytest.mark.parametrize(
    ("ends", "begun"),
    [((8300, 8500), 8300), ((8000, 8200), 8000), ((8000, OWN), OWN), ((OWN, 8500), OWN)],
)
def test_labels_are_read_at_the_plates_own_value_or_else_at_the_first(
    bench: Bench, ends: tuple[float, float], begun: float
) -> None:
    found = bench.track(*ends, values=3, motions=lambda _: (Motion(30e3, (1.0,)),))
    assert (found.begun, found.own) == (begun, OWN)
    assert found.values == pytest.approx(np.linspace(*ends, 3))
    assert [density for density, _ in bench.asked[:2]] == [begun, begun]


def test_an_own_value_between_the_others_is_one_more(bench: Bench) -> None:
    found = bench.track(8200, 8400, values=2, motions=lambda _: (Motion(30e3, (1.0,)),))
    assert list(found.values) == [8200, OWN, 8400]


def test_a_mode_may_move_by_five_per_cent_from_one_value_to_the_next(bench: Bench) -> None:
    def motions(density: float) -> tuple[Motion, ...]:
        share = 1.05 ** ((density - 8000) / 100)
        return Motion(30e3 * share, (1.0,)), Motion(31e3 * share, (0.0, 1.0), (0, 5))

    for start, stop in ((8000, 8200), (8050, OWN)):
        found = bench.track(start, stop, values=3, motions=motions)
        assert np.all(np.isfinite([one.frequency for one in found.tracks]))


def test_the_step_is_halved_where_a_mode_changes_its_motion(bench: Bench) -> None:
    """Turned by 60° a mode is 0.25 alike, by 30° 0.75: one value more in between is enough."""

    def motions(density: float) -> tuple[Motion, ...]:
        one, _ = turned(60 * (density - 8300) / 100)
        return (Motion(30e3, one),)

    found = bench.track(8300, 8400, values=2, motions=motions)
    assert found.values == pytest.approx([8300, 8350, 8400])
    assert found.tracks[0].likeness == pytest.approx([1.0, 0.75, 0.75])
    assert found.least_likeness == pytest.approx(0.75)
    assert bench.told[1:] == [f"density = {one} kg/m3" for one in (8400, 8350, 8400)]


def test_likeness_of_six_tenths_is_enough_and_less_is_not(bench: Bench) -> None:
    for share, count in ((0.62, 2), (0.58, 3)):
        angle = float(np.degrees(np.arccos(np.sqrt(share))))
        found = bench.track(
            8300, 8400, values=2,
            motions=lambda density, angle=angle: (  # type: ignore[misc]
                Motion(30e3, turned(angle * (density - 8300) / 100)[0]),
            ),
        )  # fmt: skip
        assert found.values.size == count


@pytest.mark.parametrize(
    ("jump", "values"),
    [
        # The step with the jump in it is halved twice, the rest is solved once more at the most.
        (8310, [8300, 8325, 8350, 8400]),
        (8390, [8300, 8350, 8375, 8400]),
    ],
)
@pytest.mark.parametrize(("share", "kept"), [(0.45, True), (0.35, False)])
def test_after_two_halvings_a_mode_is_kept_or_given_up(
    bench: Bench, jump: float, values: list[float], share: float, kept: bool
) -> None:
    """A mode that jumps is not to be had by any step: alike by 0.4 it stays, by less it is lost."""
    angle = float(np.degrees(np.arccos(np.sqrt(share))))

    def motions(density: float) -> tuple[Motion, ...]:
        # Into a direction that no mode had, so that only this one is unlike itself.
        one, _ = turned(angle if density > jump else 0.0)
        return Motion(30e3, (*one, 0.0)), Motion(31e3, (0.0, 0.0, 1.0), (0, 5))

    found = bench.track(8300, 8500, values=3, motions=motions)
    assert found.values == pytest.approx([*values, 8500])
    after = found.values > jump
    assert found.tracks[0].frequency[~after] == pytest.approx(np.full(np.sum(~after), 30e3))
    assert found.tracks[1].frequency == pytest.approx(np.full(5, 31e3))
    if kept:
        assert found.tracks[0].frequency == pytest.approx(np.full(5, 30e3))
        first = int(np.argmax(after))
        assert found.tracks[0].likeness[first] == pytest.approx(share)
        assert found.least_likeness == pytest.approx(share)
    else:
        assert np.all(np.isnan(found.tracks[0].frequency[after]))
        assert np.all(np.isnan(found.tracks[0].likeness[after]))
        assert found.least_likeness == pytest.approx(1.0)


def test_a_mode_that_is_no_longer_there_ends_and_the_others_go_on(bench: Bench) -> None:
    def motions(density: float) -> tuple[Motion, ...]:
        every = (
            Motion(30e3, (1.0,), (8, 0)),
            Motion(31e3, (0.0, 1.0), (0, 5)),
            Motion(31.5e3, (0.0, 0.0, 1.0), (3, 3)),
        )
        return every if density < 8390 else (every[0], every[2])

    found = bench.track(8300, 8600, values=4, motions=motions)
    assert found.tracks[0].frequency == pytest.approx(np.full(found.values.size, 30e3))
    assert found.tracks[2].frequency == pytest.approx(np.full(found.values.size, 31.5e3))
    gone = np.isnan(found.tracks[1].frequency)
    assert list(found.values[gone]) == [8400, 8500, 8600]


def test_what_a_mode_was_at_the_beginning_counts_twice(bench: Bench) -> None:
    """Two modes turn into each other. To the value before each is alike by c = cos² of the step,
    to the beginning by C = cos² of the whole angle: a line stays with the motion that it has while
    c + 2 C > (1 − c) + 2 (1 − C)."""
    # At 54° after steps of 18° the left is 1.60, the right 1.40; at 62° 1.42 and 1.58.
    angles = {8300: 0.0, 8400: 18.0, 8500: 36.0, 8600: 54.0, 8700: 62.0}

    def motions(density: float) -> tuple[Motion, ...]:
        one, other = turned(angles[round(density)])
        return Motion(30e3, one, (8, 0)), Motion(31e3, other, (0, 5))

    found = bench.track(8300, 8700, values=5, motions=motions)
    assert found.tracks[0].frequency == pytest.approx([30e3, 30e3, 30e3, 30e3, 31e3])
    assert found.tracks[1].frequency == pytest.approx([31e3, 31e3, 31e3, 31e3, 30e3])
    # The larger of the two: to the value before while they stay, then to the beginning.
    c = np.cos(np.radians(18)) ** 2
    assert found.tracks[0].likeness == pytest.approx([1.0, c, c, c, np.sin(np.radians(62)) ** 2])


def test_likeness_is_the_share_of_the_motion_of_both_faces(paper: RectangularPlate) -> None:
    before = Solved(paper, (Motion(1.0, (3.0,)), Motion(2.0, (0.0, 0.0, 2.0))))
    after = Solved(
        dataclasses.replace(paper, thickness=1.5e-3),
        (
            Motion(1.0, (-1.0, np.sqrt(3.0))),  # turned by 60° and of another size
            Motion(2.0, (0.0, 0.0, 0.0, 1.0)),  # the same on the upper face, not on the lower
            Motion(3.0, (0.0, 0.0, 1.0, 1.0)),  # the upper face alone
        ),
    )
    assert likeness(before, after) == pytest.approx(np.array([[0.25, 0, 0], [0, 0, 0.5]]))


@pytest.mark.parametrize("name", PARAMETERS)
def test_what_is_varied_is_that_and_nothing_else(paper: RectangularPlate, name: str) -> None:
    glued = dataclasses.replace(paper, glue=GlueLayer(20e-6, 2e9))
    paths = {other: path for other, (_, path) in PARAMETERS.items()}
    before = {other: value_at(glued, path)[0] for other, path in paths.items()}
    wanted = 0.9 * before[name]
    request = TrackRequest(name, 0.5 * wanted, wanted)
    changed = request.changed(glued, wanted)
    after = {other: value_at(changed, path)[0] for other, path in paths.items()}
    assert after == pytest.approx({**before, name: wanted})
    # Back again it is the plate that it was.
    assert request.changed(changed, before[name]) == glued
    if name.startswith("glue"):
        with pytest.raises(InputError, match=rf"{name}: the plate has no glue"):
            check_track(paper, request)
        check_track(glued, request)


def test_an_end_that_the_plate_cannot_have_is_refused_before_anything_is_solved(
    bench: Bench,
) -> None:
    for ends in ((-1.0, 8000.0), (8000.0, 1e12)):
        with pytest.raises(InputError, match="density"):
            bench.track(*ends, values=2, motions=lambda _: ())
    assert bench.asked == []


def test_a_value_without_a_unit_is_told_as_a_number(bench: Bench) -> None:
    bench.motions = lambda _: (Motion(30e3, (1.0,)),)
    request = TrackRequest("poisson_ratio", 0.3, 0.35, 2)
    track_modes(bench.paper, request, progress=bench.told.append)
    assert bench.told == ["poisson_ratio = 0.3", "poisson_ratio = 0.35"]


def test_where_every_mode_is_lost_the_track_goes_on_without_any(bench: Bench) -> None:
    def motions(density: float) -> tuple[Motion, ...]:
        return (Motion(30e3, (1.0, 0.0) if density < 8390 else (0.0, 1.0)),)

    found = bench.track(8300, 8700, values=5, motions=motions)
    assert {8400.0, 8500.0, 8600.0, 8700.0} <= set(found.values)
    assert np.all(np.isnan(found.tracks[0].frequency) == (found.values >= 8390))
