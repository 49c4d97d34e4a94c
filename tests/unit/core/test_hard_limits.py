"""What is too large is refused in words before anything is computed."""

import dataclasses
import re
from collections.abc import Callable
from typing import Annotated

import numpy as np
import pytest

from squeezefilm.core import hard_limits as hard
from squeezefilm.core.config.load import load_text
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.hard_limits import HardLimit, require_motion, require_within
from squeezefilm.core.presets import path as preset_path
from squeezefilm.core.quantities import Unit, checked_numbers
from squeezefilm.design.film import FilmRequest
from squeezefilm.design.plate.command import parse_mode
from squeezefilm.design.sweep.axes import axis_of
from squeezefilm.physics.chain.played_texture import FingerMotion
from squeezefilm.physics.display import Display, Surface, load_display
from squeezefilm.physics.plate.beam_modes import free_beam_mode
from squeezefilm.physics.plate.laminate import plate_laminate
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.modes import check_band
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.render.motion.stroke import MinimumJerkStroke, Stroke
from squeezefilm.physics.render.texture.image import Noise
from squeezefilm.physics.render.texture.shapes import Bump, SquareWave
from squeezefilm.study.design.plan import plan_study
from squeezefilm.study.design.study_design import load_design

ALL = {name: one for name, one in vars(hard).items() if isinstance(one, HardLimit)}
DISPLAY = load_display("biet2008-plate")
PLATE = DISPLAY.actuator
assert isinstance(PLATE, RectangularPlate)


def test_every_limit_is_one_and_says_what_was_asked_what_is_allowed_and_why() -> None:
    for name, limit in ALL.items():
        require_within(limit, limit.least)
        require_within(limit, limit.most)
        beyond = max(2 * limit.most, limit.most + 1)
        for wrong in (beyond, np.array([limit.least, beyond]), float("nan"), float("inf")):
            with pytest.raises(InputError, match="cannot be used: it must be at least") as caught:
                require_within(limit, wrong, name, enough="half would do")
            said = str(caught.value)
            assert said.startswith(f"{name} = ")
            assert limit.range in said
            assert limit.reason in said
            assert said.endswith("half would do")
            assert caught.value.quantity == name


def test_fields_are_checked_by_name_and_none_is_left_alone() -> None:
    @checked_numbers
    @dataclasses.dataclass
    class Described:
        length: Annotated[float, hard.SIDE]
        width: Annotated[float, hard.SIDE] | None = None

    assert Described(0.1).width is None
    with pytest.raises(InputError, match="width = 20 m"):
        Described(0.1, 20.0)


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        (
            "nodal_lines",
            "1000000",
            "1 000 000 cannot be used: it must be at least 2 and at most 300",
        ),
        (
            "contact_length",
            '"1000000 cm"',
            "10 km cannot be used: it must be at least 1 µm and at most 1 m",
        ),
        ("contact_length", '"99 cm"', "ridges under a contact = 2 828"),
        ("thickness", '"1e308 m"', "must be at least 10 nm and at most 1 m"),
        ("thickness", '"1e-12 mm"', "must be at least 10 nm and at most 1 m"),
        ("viscosity", '"1e300 Pa*s"', "must be at least"),
        ("young_modulus", '"1e-30 Pa"', "must be at least"),
    ],
)
def test_a_display_out_of_all_proportion_is_refused_with_its_line(
    key: str, value: str, says: str
) -> None:
    text = preset_path("biet2008-plate").read_text(encoding="utf-8")
    with pytest.raises(ConfigError, match=re.escape(says)) as caught:
        load_text(Display, re.sub(rf"(?m)^{key} = .*$", f"{key} = {value}", text, count=1))
    assert caught.value.line is not None


def test_small_and_large_honest_displays_are_not() -> None:
    patch = PLATE.patches[0]
    tiny = dataclasses.replace(patch, x=0.0, length=100e-6, width=100e-6, thickness=0.5e-6)
    dataclasses.replace(
        PLATE, length=100e-6, width=100e-6, thickness=2e-6, patches=(tiny,), glue=None
    )
    dataclasses.replace(PLATE, length=1.0, width=0.6, thickness=5e-3, nodal_lines=57)


def test_a_long_beam_has_its_mode_of_sixty_lines_and_not_another() -> None:
    section = plate_laminate(PLATE, "plane_strain")
    for lines in (47, 60, 150):
        mode = free_beam_mode(section, 5.0, lines)
        assert mode.nodal_positions.size == lines


@pytest.mark.parametrize(
    "motion", [Stroke(1e-9, 0.04), Stroke(1e-6, 10.0, 1000), MinimumJerkStroke(0.04, 1e9, 10**6)]
)
def test_a_motion_without_an_end_says_how_long_it_may_be(motion: Stroke) -> None:
    with pytest.raises(InputError, match=r"steps of a rendered stroke = .* from 104.2 µs to") as e:
        FingerMotion.of(motion, 19.2e3)
    assert "make it shorter or faster" in str(e.value)


def test_a_motion_too_short_is_told_to_be_longer() -> None:
    with pytest.raises(InputError, match="make it longer or slower"):
        require_motion(hard.RENDER_STEPS, 0.5, 1e-5, 5e4)


def test_a_solve_that_fits_no_memory_is_refused_before_it_begins() -> None:
    wide = dataclasses.replace(PLATE, length=1.0, width=1.0, patches=(PLATE.patches[0],))
    with pytest.raises(InputError, match="bytes of a three-dimensional solve") as caught:
        plate_model(wide, 500e3)
    assert "slices of" in str(caught.value)


@pytest.mark.parametrize("frequency", [4.4e37, 1e300])
def test_elements_are_not_counted_for_a_frequency_beyond_all_limits(frequency: float) -> None:
    with pytest.raises(InputError, match=r"near = .* at most 1 GHz"):
        solve_modes(PLATE, near=frequency)
    with pytest.raises(InputError, match=r"frequency = .* at most 2 GHz"):
        plate_model(PLATE, frequency)


def test_other_sizes_of_work() -> None:
    for refused in (
        lambda: check_band((0.0, 1e12)),
        lambda: parse_mode("99999,0"),
        lambda: axis_of("actuator.thickness", "1 mm..2 mm:1000000", DISPLAY),
        lambda: FilmRequest("rectangle", 1e300),
    ):
        with pytest.raises(InputError, match="it must be at least"):
            refused()
    design = load_design("period-jnd")
    with pytest.raises(InputError, match="trials of one participant = "):
        dataclasses.replace(design, practice=1000, familiarisation=20, blocks=100,
                            repetitions=1000, adaptive=())  # fmt: skip
    assert design.most_trials >= len(plan_study(design).schedules[0])
    with pytest.raises(InputError, match="participants are planned at once"):
        plan_study(dataclasses.replace(design, adaptive=(
            dataclasses.replace(design.adaptive[0], count=10_000),)), 1000)  # fmt: skip


def test_every_preset_design_has_no_more_trials_than_it_says() -> None:
    for name in ("biet2008-gratings", "friction-jnd", "period-same-different"):
        design = load_design(name)
        assert design.most_trials >= len(plan_study(design).schedules[0])


def test_limits_are_shown_with_units_and_counts_in_full() -> None:
    limit = HardLimit("a size", 1e-6, 2.0, "a reason", Unit("m"))
    assert limit.range == "at least 1 µm and at most 2 m"
    assert hard.RENDER_STEPS.range == "at least 2 and at most 3 000 000"


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: SquareWave(2.0), 'spatial_period = 2 m .* did you mean "2 mm"'),
        (lambda: SquareWave("2.5 m"), 'spatial_period = 2.5 m .* did you mean "2.5 mm"'),
        (lambda: Bump(0.0, 3.0), 'width = 3 m .* did you mean "3 mm"'),
        (lambda: Noise(0.7, 1), 'finest_period = 700 mm .* did you mean "700 um"'),
        (lambda: Surface("rough", 0.6e-3, 0.5), 'roughness = 600 µm .* did you mean "600 nm"'),
    ],
)
def test_a_length_of_another_prefix_is_refused_with_the_one_that_was_probably_meant(
    make: Callable[[], object], says: str
) -> None:
    with pytest.raises(InputError, match=says):
        make()
