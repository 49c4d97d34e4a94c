"""The friction over a display's face: against the law at an antinode, pads summed one by one, the
solved shape, and finer grids."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import pytest
from tests.verification.random_plates import random_glass

from squeezefilm.core.errors import GeometryError, InputError, OutOfRangeError, QuantityError
from squeezefilm.physics.chain import area_map
from squeezefilm.physics.chain.active_area import CRITERIA, ActiveArea, percent
from squeezefilm.physics.chain.area_map import active_area
from squeezefilm.physics.chain.pad_place import (
    PadPlace,
    met_by_pads,
    pad_place,
    place_words,
    read_place,
)
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.chain.touch import touch, touched_amplitudes
from squeezefilm.physics.chain.wanted_voltage import voltage_for_friction
from squeezefilm.physics.contact.sharing.pad import pad_points
from squeezefilm.physics.display import ActiveRegion, Display, load_display
from squeezefilm.physics.plate.surface_shape import surface_shape

PLATE, STATOR = load_display("biet2008-plate"), load_display("biet2008-stator")
DISC = load_display("winfield2007-tpad")


@functools.cache
def predicted(name: str) -> Prediction:
    display = {"plate": PLATE, "stator": STATOR, "disc": DISC}[name]
    return predict(display, theory="timoshenko" if name == "plate" else None)


def area_of(display: Display, p: Prediction) -> ActiveArea:
    found = active_area(display, p.mode, p.law, p.drive)
    assert found is not None
    return found


@functools.cache
def beams_area() -> ActiveArea:
    return area_of(PLATE, predicted("plate"))


def made(friction: np.ndarray) -> ActiveArea:
    """An area with frictions by hand, on a square of a metre."""
    n, m = friction.shape
    ones = np.ones((n, m))
    return ActiveArea(
        x=np.linspace(0, 1, n), y=np.linspace(0, 1, m), amplitude=1e-6 * ones,
        lobe_amplitude=1e-6 * ones, amplitude_under_pad=1e-6 * ones, relative_friction=friction,
        contact_side=1e-2, rule="by hand", shape_model="by hand", shape_words="by hand",
    )  # fmt: skip


# A wave whose antinodes are all alike: what the law has always computed.


@pytest.mark.parametrize("position", [0.0, 2e-3, 4.675e-3])
def test_over_equal_antinodes_a_place_has_the_friction_of_the_law(position: float) -> None:
    p = predicted("stator")
    shape = surface_shape(STATOR.actuator, p.mode)
    # The third antinode, all of the track's width under the pad.
    wide = dataclasses.replace(shape, bounds=(0.0, shape.bounds[1], -0.1, 0.1))
    at = PadPlace(wide, 2 * p.mode.half_wavelength + position, 0.0)
    here = dataclasses.replace(p.law, place=at)
    even = dataclasses.replace(p.law.on_even_wave, position=position)
    amplitude = np.array([0.0, 0.3e-6, 1e-6, 2e-6])
    # Few nodes stand for all ridges at a place.
    assert here.curve(amplitude) == pytest.approx(even.curve(amplitude), abs=1e-7)
    tied = here.friction_in("one-gap", amplitude)
    assert tied == pytest.approx(even.friction_in("one-gap", amplitude), abs=1e-7)
    # Over the ridges, which leave a part of a period free at the ends; over the whole contact.
    assert here.mean_square == pytest.approx(even.mean_square, rel=0.025)


def test_one_ridge_is_the_pad_of_one_ridge() -> None:
    p = predicted("stator")
    amplitude = np.linspace(0, 2e-6, 5)
    points = pad_points(p.law.finger)
    wave = np.abs(np.cos(np.pi * points.along / p.mode.half_wavelength))
    each = p.law.ridge_friction(np.outer(amplitude, wave).ravel()).reshape(5, -1)
    assert each @ points.shares == pytest.approx(p.law.on_even_wave.curve(amplitude), abs=1e-9)


# The map.


@pytest.mark.slow
@pytest.mark.parametrize("name", ["plate", "stator", "disc"])
def test_the_map_is_the_sum_over_the_pads_ridges_place_by_place(name: str) -> None:
    p, display = predicted(name), {"plate": PLATE, "stator": STATOR, "disc": DISC}[name]
    area = area_of(display, p)
    assert area.relative_friction is not None
    known = np.argwhere(np.isfinite(area.relative_friction))
    theory = "timoshenko" if name == "plate" else None
    for i, j in np.random.default_rng(4).choice(known, 5):
        there = predict(display, theory=theory, place=(float(area.x[i]), float(area.y[j])))
        assert area.relative_friction[i, j] == pytest.approx(there.relative_friction, abs=5e-5)
        assert area.lobe_amplitude[i, j] == pytest.approx(there.vibration_amplitude, rel=1e-4)
        assert area.amplitude[i, j] == pytest.approx(there.amplitude_at_place, rel=1e-4)


def test_the_amplitude_of_the_map_is_the_shape_to_rounding() -> None:
    area, p = beams_area(), predicted("plate")
    shape = surface_shape(PLATE.actuator, p.mode)
    here = area.lobe_amplitude * shape.grid(area.x, area.y)
    assert area.amplitude == pytest.approx(here, rel=1e-12)


def test_the_finger_takes_less_beside_the_antinodes() -> None:
    p, area = predicted("plate"), beams_area()
    at_lobe = np.argmin(np.abs(area.x - p.mode.lobe[0]))
    assert np.argmin(area.lobe_amplitude[:, 0]) == pytest.approx(at_lobe, abs=1)
    assert np.all(area.lobe_amplitude < p.touch.free_amplitude)
    # As much of the mode as an antinode has: what `touch` says. None of it: nothing.
    free = p.touch.free_amplitude
    left = touched_amplitudes(p.mode, p.law, free, np.array([0.0, p.law.mean_square]))
    assert left == pytest.approx([free, touch(p.mode, p.law, free).amplitude], rel=1e-9)


def test_the_best_antinode_is_among_the_places() -> None:
    p, area = predicted("plate"), beams_area()
    assert np.min(np.abs(area.x - p.mode.lobe[0])) == pytest.approx(0.0, abs=1e-9)
    assert area.best_place is not None
    assert area.best_place[0] == pytest.approx(p.mode.lobe[0], abs=1e-3)


@pytest.mark.slow
def test_shares_converge_with_the_places(monkeypatch: pytest.MonkeyPatch) -> None:
    p = predicted("plate")
    level = beams_area().median
    assert level is not None
    shares = [beams_area().share_below(level)]
    for finer in (2, 4):
        area_map._active_area.cache_clear()
        monkeypatch.setattr(area_map, "_TO_A_HALF_WAVE", 12 * finer)
        monkeypatch.setattr(area_map, "_MOST_PLACES", 96 * finer)
        shares.append(area_of(PLATE, p).share_below(level))
    area_map._active_area.cache_clear()
    # A beam is alike all across, so that a share comes in columns of places: 83 of them at first.
    assert shares[0] == pytest.approx(shares[2], abs=2.5 / 83)
    assert shares[1] == pytest.approx(shares[2], abs=0.5 / 83)


def test_a_given_amplitude_is_the_one_where_the_finger_is_and_elsewhere_the_drive_stays() -> None:
    p = predict(PLATE, theory="timoshenko", vibration_amplitude=1e-6)
    area = area_of(PLATE, p)
    assert np.min(area.lobe_amplitude) == pytest.approx(1e-6, rel=1e-3)
    volts = p.touch.free_amplitude / p.mode.amplitude_per_volt
    driven = area_of(PLATE, predict(PLATE, theory="timoshenko", voltage=volts))
    assert area.lobe_amplitude == pytest.approx(driven.lobe_amplitude, rel=1e-9)


def test_a_still_plate_reduces_nothing_anywhere() -> None:
    area = area_of(PLATE, predict(PLATE, theory="timoshenko", voltage=0.0))
    assert (area.best, area.worst, area.uniformity) == (1.0, 1.0, None)


# Its results, of frictions by hand.


def test_shares_median_and_uniformity_of_a_plane_are_those_of_a_plane() -> None:
    rise = np.linspace(0.2, 0.8, 25)
    area = made(np.repeat(rise[:, None], 7, axis=1))
    assert area.share_below(0.5) == pytest.approx(0.5, abs=1e-9)
    assert area.share_below(0.35) == pytest.approx(0.25, abs=0.01)
    assert (area.share_below(0.1), area.share_below(0.9)) == (0.0, 1.0)
    assert area.median == pytest.approx(0.5, abs=1e-9)
    assert area.uniformity == pytest.approx((1 - 0.8) / (1 - 0.2))
    assert (area.best_place, area.worst_place) == ((0.0, 0.0), (1.0, 0.0))
    summary = area.summary()
    assert summary["share_below"].keys() == {"0.70", "0.80"}
    assert summary["relative_friction"]["worst"] == 0.8
    assert "µ′/µ is 0.20 at the best place (x 0 mm, y 0 mm)" in area.sentence


def test_places_nearer_to_each_other_count_for_less() -> None:
    rise = np.linspace(0.2, 0.8, 25)
    area = made(np.repeat(rise[:, None], 2, axis=1))
    x = np.append(area.x, 0.01)
    order = np.argsort(x)
    more = np.append(rise, 0.2 + 0.6 * 0.01)[order]
    crowded = dataclasses.replace(
        area, x=x[order], relative_friction=np.repeat(more[:, None], 2, axis=1)
    )
    assert crowded.share_below(0.5) == pytest.approx(0.5, abs=1e-9)


def test_places_that_are_not_there_do_not_count() -> None:
    friction = np.full((9, 9), 0.4)
    friction[:4] = np.nan
    area = made(friction)
    assert (area.share_below(0.5), area.median, area.uniformity) == (1.0, 0.4, 1.0)


@pytest.mark.parametrize(
    ("share", "text"),
    [(0.0, "0 %"), (1.0, "100 %"), (0.613, "61 %"), (0.001, "less than 1 %"),
     (0.9991, "more than 99 %"), (None, "an unknown share")],
)  # fmt: skip
def test_a_share_is_said_in_whole_percent(share: float | None, text: str) -> None:
    assert percent(share) == text


# What is asked for.


def test_a_display_may_have_its_own_area() -> None:
    mine = dataclasses.replace(PLATE, active_area=ActiveRegion(20e-3, 40e-3, 10e-3, 30e-3))
    area = area_of(mine, predicted("plate"))
    assert (area.x[0], area.x[-1]) == pytest.approx((20e-3, 40e-3))
    assert (area.y[0], area.y[-1]) == pytest.approx((10e-3, 30e-3))
    assert "description" in area.rule
    beyond = dataclasses.replace(PLATE, active_area=ActiveRegion(20e-3, 90e-3, 10e-3, 30e-3))
    with pytest.raises(GeometryError, match="keep to the face"):
        area_of(beyond, predicted("plate"))
    with pytest.raises(InputError, match="x_to"):
        ActiveRegion(40e-3, 20e-3, 0.0, 1e-3)


def test_by_default_the_contact_stays_on_the_face() -> None:
    area, side = beams_area(), predicted("plate").law.contact_side
    assert (area.x[0], area.x[-1]) == pytest.approx((side / 2, 83e-3 - side / 2))
    assert (area.y[0], area.y[-1]) == pytest.approx((side / 2, 49e-3 - side / 2))


def test_of_a_pad_that_overhangs_the_rest_carries() -> None:
    p = predicted("plate")
    shape = surface_shape(PLATE.actuator, p.mode)
    side = p.law.contact_side
    points, swings, shares = PadPlace(shape, 1e-3, 0.0245).ridges(p.law.finger, side)
    assert points.size == swings.size < pad_points(p.law.finger, side, 8).along.size
    # The middle of a ridge that the edge cuts may lie beyond it.
    assert np.min(points) >= -1e-3 - p.law.finger.ridge_period / 2
    assert np.sum(shares) == pytest.approx(1.0)
    # What reaches from the edge to the far end carries, each length of it alike.
    assert shares @ points == pytest.approx((side / 2 - 1e-3) / 2, abs=2e-5)


def test_a_model_without_ridges_of_their_own_has_amplitudes_only_and_says_why() -> None:
    for model in ("paper2008", "paper2008-printed"):
        p = predict(PLATE, theory="timoshenko", model=model)
        area = area_of(PLATE, p)
        assert area.relative_friction is None
        assert model in area.why_not
        assert (area.best, area.worst, area.median, area.uniformity) == (None,) * 4
        assert all(area.share_below(one) is None for one in CRITERIA)
        assert "not known" in area.sentence
        assert area.summary()["relative_friction"] is None


# A place.


@pytest.mark.parametrize("text", ["30 mm, 20 mm", "x 30 mm, y 20 mm", " 3 cm ,2 cm"])
def test_a_place_is_read_from_text(text: str) -> None:
    assert read_place(text) == pytest.approx((30e-3, 20e-3))
    assert place_words(read_place(text)) == "x 30 mm, y 20 mm"


@pytest.mark.parametrize("text", ["30 mm", "30, 20", "30 mm, 20 V", "a, b", "1 mm, 2 mm, 3 mm"])
def test_what_is_no_place_is_refused(text: str) -> None:
    with pytest.raises(QuantityError, match="place"):
        read_place(text)


def test_a_place_beside_the_face_is_refused_with_where_the_face_is() -> None:
    with pytest.raises(GeometryError, match=r"x 90 mm, y 20 mm is not on the face.*83 mm"):
        predict(PLATE, theory="timoshenko", place=(90e-3, 20e-3))
    with pytest.raises(GeometryError, match="round"):
        predict(DISC, place=(20e-3, 0.0))


def test_a_place_names_itself_and_its_amplitude() -> None:
    p = predict(PLATE, theory="timoshenko", place="30 mm, 20 mm")
    assert p.place == pytest.approx((30e-3, 20e-3))
    assert "x 30 mm, y 20 mm" in p.place_said
    assert p.amplitude_at_place < p.vibration_amplitude
    where = p.place_summary()
    assert (where["is_best_of_area"], where["is_on_even_wave"]) == (False, False)
    best = predicted("plate")
    assert best.place == best.mode.lobe
    assert best.place_said.startswith("at the antinode, ")
    assert best.amplitude_at_place == best.vibration_amplitude
    beside = predict(PLATE, theory="timoshenko", position=2e-3)
    assert beside.place_said.startswith("2 mm along the wave")


def test_the_voltage_for_a_friction_at_a_place_gives_it_there() -> None:
    place = (30e-3, 20e-3)
    volts, amplitude = voltage_for_friction(PLATE, 0.6, theory="timoshenko", place=place)
    p = predict(PLATE, theory="timoshenko", voltage=volts, place=place)
    assert p.relative_friction == pytest.approx(0.6, abs=1e-5)
    assert p.vibration_amplitude == pytest.approx(amplitude, rel=1e-4)


def test_a_place_goes_with_partial_levitation_and_without_a_position() -> None:
    with pytest.raises(InputError, match="antinode only"):
        predict(PLATE, theory="timoshenko", place=(30e-3, 20e-3), model="paper2008")
    with pytest.raises(InputError, match="not both"):
        predict(PLATE, theory="timoshenko", place=(30e-3, 20e-3), position=1e-3)
    mode = predicted("plate").mode
    assert pad_place(PLATE.actuator, mode, 30e3, None) is None
    handmade = dataclasses.replace(mode, beam=None)
    with pytest.raises(OutOfRangeError, match="no shape"):
        pad_place(PLATE.actuator, handmade, 30e3, (1e-2, 1e-2))
    p = predicted("plate")
    assert active_area(PLATE, handmade, p.law, p.drive) is None


def test_pads_turn_with_the_wave() -> None:
    p = predicted("plate")
    shape = surface_shape(PLATE.actuator, p.mode)
    points = pad_points(p.law.finger)
    across = dataclasses.replace(shape, along="y")
    at = np.array([30e-3]), np.array([20e-3])
    swings, shares = met_by_pads(shape, *at, points)
    other, _ = met_by_pads(across, *at, points)
    assert shares[0] == pytest.approx(points.shares)
    assert swings.shape == (1, points.along.size)
    # The beam's line is that of y then: only the points are compared.
    assert other.shape == swings.shape


def test_the_active_area_of_a_disc_is_said_to_be_a_disc() -> None:
    display = load_display("winfield2007-tpad")
    area = area_of(display, predict(display))
    across = 1e3 * (area.x[-1] - area.x[0])
    assert area.sentence.startswith(f"Over the active area, a disc of {across:.3g} mm (the face ")
    # A region that the display states is a rectangle, on a disc too.
    region = ActiveRegion(-3e-3, 3e-3, -2e-3, 2e-3)
    of_its_own = dataclasses.replace(display, active_area=region)
    stated = area_of(of_its_own, predict(of_its_own))
    assert stated.sentence.startswith("Over the active area of 6 mm × 4 mm (as the display's ")


def test_what_no_ridge_can_meet_is_refused_before_films_are_tabulated() -> None:
    p = predicted("plate")
    shape = surface_shape(PLATE.actuator, p.mode)
    law = dataclasses.replace(p.law, place=PadPlace(shape, 41.5e-3, 24.5e-3))
    for one in (law, law.on_even_wave):
        most = one.largest_amplitude
        with pytest.raises(OutOfRangeError, match="friction is known up to 50 µm"):
            one.curve(np.array([1e-6, 1.01 * most / min(1.0, np.max(one.ridge_swings[0]))]))
        with pytest.raises(OutOfRangeError, match="a ridge would meet"):
            one.felt_stiffness(99e-6)


@pytest.mark.slow
def test_amplitudes_between_knots_are_those_of_the_finger_there() -> None:
    """A finger that takes most of the amplitude where it lies on the mode whole."""
    display = dataclasses.replace(PLATE, actuator=random_glass(20))
    p = predict(display)
    even, free = dataclasses.replace(p.law, place=None, position=0.0), p.touch.free_amplitude
    squares = np.linspace(0.02, 0.9, 23)
    left = touched_amplitudes(p.mode, even, free, squares)
    assert left[-1] < 0.25 * free
    for square, amplitude in zip(squares[1:-1], left[1:-1], strict=True):
        few = touched_amplitudes(p.mode, even, free, np.array([square]))
        assert amplitude == pytest.approx(few[0], rel=1e-4)
