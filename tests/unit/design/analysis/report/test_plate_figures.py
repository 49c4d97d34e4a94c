"""The figures of the vibrating body: every shape and line where the description puts it."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.patches import Circle, Rectangle, Wedge
from tests.unit.drawn import labelled, words

from squeezefilm.core.kit.style import METAL, MINUS, ORANGE, PAPER, PLUS
from squeezefilm.design.analysis.report.layout_figures import layout
from squeezefilm.design.analysis.report.plate_figures import (
    frequency_response,
    half_power,
    mode_shape,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.laminate import plate_laminate
from squeezefilm.physics.plate.layout import (
    AnnularStator,
    CeramicPatch,
    DiscPlate,
    RectangularPlate,
)


def paper() -> RectangularPlate:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    return plate


def stator(waves: int = 9, **changes: Any) -> AnnularStator:
    ring = load_display("biet2008-stator").actuator
    assert isinstance(ring, AnnularStator)
    return dataclasses.replace(ring, mean_diameter=waves * ring.wavelength / math.pi, **changes)


def tpad(**changes: Any) -> DiscPlate:
    disc = load_display("winfield2007-tpad").actuator
    assert isinstance(disc, DiscPlate)
    return dataclasses.replace(disc, **changes)


def data(line: Any) -> tuple[np.ndarray, np.ndarray]:
    return np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)


def boxes(axes: Any, color: str) -> list[tuple[float, ...]]:
    """Left, bottom, width and height of the rectangles of a colour."""
    return [
        (*one.get_xy(), one.get_width(), one.get_height())
        for one in axes.patches
        if isinstance(one, Rectangle) and to_hex(one.get_facecolor()) == color
    ]


def signs(axes: Any) -> list[tuple[str, float, float]]:
    return [(one.get_text(), *one.get_position()) for one in axes.texts if len(one.get_text()) == 1]


def described(actuator: Any, contact: float = 10e-3) -> Any:
    return SimpleNamespace(
        display=SimpleNamespace(actuator=actuator, finger=SimpleNamespace(contact_length=contact)),
        prediction=SimpleNamespace(mode=SimpleNamespace(model="a-model")),
    )


def test_a_plate_is_drawn_to_scale_with_every_ceramic() -> None:
    plate = paper()
    figure = layout(described(plate))
    neutral = plate_laminate(plate).neutral_axis
    assert f"an axis {1e3 * neutral:.3g} mm below the touched face" in words(figure.get_suptitle())
    # Seven ceramics of 11 mm on 83 mm: 92.8 %.
    assert words(figure.get_suptitle()).startswith(
        "7 ceramics cover 93 % of the lower face; the plate bends about an axis "
    )
    plan, side, section = figure.axes
    assert boxes(plan, METAL) == [pytest.approx((0, 0, 83, 49))]
    ups = [pytest.approx((24 * n, 0, 11, 49)) for n in range(4)]
    downs = [pytest.approx((12 + 24 * n, 0, 11, 49)) for n in range(3)]
    assert boxes(plan, PLUS) == ups
    assert boxes(plan, MINUS) == downs
    assert signs(plan) == [
        ("+−"[n % 2], pytest.approx(12 * n + 5.5), pytest.approx(24.5)) for n in range(7)
    ]
    # From the side: 2 mm of plate below the touched face at 0, 1 mm of ceramic below that.
    assert boxes(side, METAL) == [pytest.approx((0, -2, 83, 2))]
    assert boxes(side, PLUS) == [pytest.approx((24 * n, -3, 11, 1)) for n in range(4)]
    assert boxes(side, MINUS) == [pytest.approx((12 + 24 * n, -3, 11, 1)) for n in range(3)]
    (axis,) = side.get_lines()
    assert data(axis)[1] == pytest.approx([-1e3 * neutral] * 2)
    for axes in (plan, side):
        low, high = axes.get_xlim()
        assert low < 0 < 83 < high
        assert low + high == pytest.approx(83)
        assert axes.get_xlabel() == "x along the plate (mm)"
        assert axes.get_aspect() == 1.0
    assert plan.get_ylabel() == "y (mm)"
    low, high = plan.get_ylim()
    assert low < 0
    assert low + high == pytest.approx(49)
    low, high = side.get_ylim()
    assert low < -3
    assert high > 0
    # The section: depth grows downwards; the touched face on top.
    assert boxes(section, METAL) == [pytest.approx((0, 0, 1, 2))]
    assert boxes(section, PLUS) == [pytest.approx((0, 2, 1, 1))]
    bottom, top = section.get_ylim()
    assert bottom > 3
    assert top < 0
    assert section.get_ylabel() == "depth below the touched face (mm)"
    assert data(labelled(section)["neutral axis"])[1] == pytest.approx([1e3 * neutral] * 2)
    names = {one.get_text(): one.get_position() for one in section.texts}
    assert set(names) == {"copper-beryllium\n2 mm", "P1-91\n1 mm"}


def test_ceramics_on_both_faces_are_drawn_on_both() -> None:
    """A bimorph bends about its middle, 1 mm below the touched face of a plate of 2 mm."""
    plate = paper()
    below = dataclasses.replace(plate.patches[3], x=30e-3)
    above = dataclasses.replace(below, face="top", polarity=-below.polarity)
    figure = layout(described(dataclasses.replace(plate, patches=(below, above))))
    assert words(figure.get_suptitle()) == (
        "1 ceramic covers 13 % of the lower face and 1 ceramic covers 13 % of the upper face; "
        "the plate bends about an axis 1 mm below the touched face"
    )
    lower, upper, side, section = figure.axes
    place = [pytest.approx((30, 0, 11, 49))]
    assert (boxes(lower, MINUS), boxes(lower, PLUS)) == (place, [])
    assert (boxes(upper, MINUS), boxes(upper, PLUS)) == ([], place)
    assert boxes(side, MINUS) == [pytest.approx((30, -3, 11, 1))]
    assert boxes(side, PLUS) == [pytest.approx((30, 0, 11, 1))]
    assert boxes(section, PLUS) == [pytest.approx((0, -1, 1, 1)), pytest.approx((0, 2, 1, 1))]
    assert data(labelled(section)["neutral axis"])[1] == pytest.approx([1, 1])


@pytest.mark.parametrize("thickness", [0.2e-3, 0.7e-3, 1e-3, 3e-3])
def test_the_names_of_the_layers_keep_off_the_neutral_axis(thickness: float) -> None:
    """Each is nearer to the edge of its layer that is further from the axis."""
    plate = paper()
    patches = tuple(dataclasses.replace(one, thickness=thickness) for one in plate.patches)
    section = layout(described(dataclasses.replace(plate, patches=patches))).axes[2]
    axis = float(data(labelled(section)["neutral axis"])[1][0])
    for text, top, height in zip(section.texts, (0, 2), (2, 1e3 * thickness), strict=True):
        x, y = text.get_position()
        assert x == 0.5
        assert top < y < top + height
        middle = top + height / 2
        assert (y < middle) == (axis > middle)
        assert abs(y - middle) > 0.15 * height


def test_a_single_small_ceramic_has_no_room_for_its_sign() -> None:
    tiny = CeramicPatch(10e-3, 5e-3, 1.6e-3, 30e-3, 1e-3)
    figure = layout(described(dataclasses.replace(paper(), patches=(tiny,))))
    assert words(figure.get_suptitle()).startswith("1 ceramic covers 1 % of the lower face")
    assert signs(figure.axes[0]) == []
    assert boxes(figure.axes[0], PLUS) == [pytest.approx((10, 5, 1.6, 30))]
    wider = dataclasses.replace(tiny, length=1.8e-3)
    figure = layout(described(dataclasses.replace(paper(), patches=(wider,))))
    assert signs(figure.axes[0]) == [("+", pytest.approx(10.9), pytest.approx(20.0))]


def test_a_disc_is_drawn_from_above_and_in_section() -> None:
    disc = tpad(ceramic_outer_diameter=20e-3)
    figure = layout(described(disc, contact=8e-3))
    # 20² of 25², and 8 of 25 mm.
    assert words(figure.get_suptitle()) == (
        "A ceramic below covers 64 % of the disc; a finger pad 8 mm wide touches 32 % of its "
        "diameter"
    )
    plan, side = figure.axes
    circles = [
        (one.get_radius(), to_hex(one.get_facecolor()))
        for one in plan.patches
        if isinstance(one, Circle)
    ]
    assert circles == [(pytest.approx(12.5), METAL), (pytest.approx(10.0), PLUS)]
    finger = labelled(plan)["finger contact, 8 mm × 8 mm"]
    assert (*finger.get_xy(), finger.get_width(), finger.get_height()) == (-4, -4, 8, 8)
    assert to_hex(finger.get_edgecolor()) == ORANGE
    assert boxes(side, METAL) == [pytest.approx((-12.5, -1.6, 25, 1.6))]
    assert boxes(side, PLUS) == [pytest.approx((-10, -2.6, 20, 1))]
    assert plan.get_xlim() == plan.get_ylim()
    assert -plan.get_xlim()[0] == plan.get_xlim()[1] > 12.5
    low, high = side.get_ylim()
    assert low < -2.6
    assert high > 0
    assert (side.get_xlabel(), plan.get_ylabel()) == ("x (mm)", "y (mm)")


def test_a_disc_with_a_hole_under_a_large_finger() -> None:
    disc = tpad(inner_diameter=5e-3, ceramic_inner_diameter=10e-3)
    figure = layout(described(disc, contact=30e-3))
    # (25² − 10²)/(25² − 5²)
    assert words(figure.get_suptitle()).startswith("A ceramic below covers 88 % of the disc")
    assert "touches 120 %" in words(figure.get_suptitle())
    plan, side = figure.axes
    circles = [
        (one.get_radius(), to_hex(one.get_facecolor()))
        for one in plan.patches
        if isinstance(one, Circle)
    ]
    assert circles == [
        (pytest.approx(12.5), METAL), (pytest.approx(12.5), PLUS), (pytest.approx(5.0), METAL),
        (pytest.approx(2.5), PAPER),
    ]  # fmt: skip
    assert boxes(side, PLUS) == [
        pytest.approx((-12.5, -2.6, 7.5, 1)), pytest.approx((5, -2.6, 7.5, 1)),
    ]  # fmt: skip
    assert plan.get_xlim()[1] > 15  # the finger is inside


def test_a_ring_has_a_lobe_up_and_a_lobe_down_for_every_wave() -> None:
    ring = stator()
    figure = layout(described(ring))
    # 10 mm of 9.35 mm half waves.
    assert words(figure.get_suptitle()) == (
        "9 waves of 18.7 mm stand on the ring; a finger pad covers 1.1 half waves"
    )
    assert "a-model, the ring taken as smooth" in words(figure.get_supxlabel())
    (axes,) = figure.axes
    radius = 9 * 18.7 / math.pi / 2
    wedges = [one for one in axes.patches if isinstance(one, Wedge)]
    assert len(wedges) == 18
    for number, one in enumerate(wedges):
        assert (one.r, one.width) == (pytest.approx(radius + 5), pytest.approx(10))
        # From the top on, clockwise, each of 20°.
        assert (one.theta1, one.theta2) == (
            pytest.approx(80 - 20 * number), pytest.approx(100 - 20 * number),
        )  # fmt: skip
        assert to_hex(one.get_facecolor()) == (MINUS if number % 2 else PLUS)
    # The finger hides the first one's sign.
    found = signs(axes)
    assert len(found) == 17
    for number, (sign, x, y) in enumerate(found, 1):
        assert sign == "+−"[number % 2]
        assert math.hypot(x, y) == pytest.approx(radius + 2.5)
        assert math.degrees(math.atan2(y, x)) % 360 == pytest.approx((90 - 20 * number) % 360)
    (mean,) = [one for one in axes.patches if isinstance(one, Circle)]
    assert mean.get_radius() == pytest.approx(radius)
    assert not mean.get_fill()
    finger = axes.patches[-1]
    assert (*finger.get_xy(), finger.get_width(), finger.get_height()) == pytest.approx(
        (-5, radius - 5, 10, 10)
    )
    assert "mean diameter\n53.57 mm" in [one.get_text() for one in axes.texts]
    arrow = next(one for one in axes.texts if getattr(one, "arrow_patch", None))
    assert (*arrow.xy, *arrow.xyann) == pytest.approx((-radius, 0, radius, 0))
    legend = [one.get_text() for one in axes.get_legend().get_texts()]
    assert legend == [
        "+  half wave going up", "−  half wave going down", "lines between: nodal lines",
        "finger contact, 10 mm × 10 mm",
    ]  # fmt: skip
    assert min(axes.get_xlim()[1], axes.get_ylim()[1], -axes.get_xlim()[0]) > radius + 5
    assert axes.get_ylim()[0] < -(radius + 5)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (mm)", "y (mm)")


def test_signs_are_left_out_where_lobes_are_too_small_for_them() -> None:
    assert len(signs(layout(described(stator(30))).axes[0])) == 59
    assert signs(layout(described(stator(31))).axes[0]) == []
    wide = layout(described(stator(1, radial_width=2e-3), contact=40e-3)).axes[0]
    radius = 18.7 / math.pi / 2
    assert min(wide.get_xlim()[1], wide.get_ylim()[1]) > radius + 20


X = np.linspace(0, 80e-3, 161)
SHAPE = np.cos(4 * np.pi * X / 80e-3) * np.where((X == 0) | (X == 80e-3), 1.5, 1.0)


def vibrating(actuator: Any, **changes: Any) -> Any:
    parts: dict[str, Any] = {
        "label": "(4,0)", "model": "a-model", "half_wavelength": 20e-3,
        "line": SimpleNamespace(
            position=X, deflection=SHAPE, nodal_positions=np.array([10e-3, 30e-3, 50e-3, 70e-3])
        ),
    }  # fmt: skip
    amplitude = changes.pop("amplitude", 2e-6)
    return SimpleNamespace(
        display=SimpleNamespace(actuator=actuator),
        prediction=SimpleNamespace(
            mode=SimpleNamespace(**{**parts, **changes}), vibration_amplitude=amplitude
        ),
    )


def small_plate(**changes: Any) -> RectangularPlate:
    patches = (
        CeramicPatch(5e-3, 0.0, 10e-3, 40e-3, 1e-3),
        CeramicPatch(25e-3, 0.0, 10e-3, 40e-3, 1e-3, polarity=-1),
        CeramicPatch(60e-3, 0.0, 1e-3, 40e-3, 1e-3),
    )
    return dataclasses.replace(paper(), length=80e-3, nodal_lines=4, patches=patches, **changes)


def test_a_mode_is_drawn_at_its_amplitude_between_its_nodal_lines() -> None:
    figure = mode_shape(vibrating(small_plate()))
    assert words(figure.get_suptitle()) == (
        "(4,0): 4 nodal lines, λ/2 = 20 mm; the free ends move 1.50 times as far as the lobes "
        "between"
    )
    (axes,) = figure.axes
    seen = labelled(axes)
    x, y = data(seen["one extreme of the vibration"])
    assert x == pytest.approx(1e3 * X)
    assert y == pytest.approx(2 * SHAPE)
    assert data(seen["half a period later"])[1] == pytest.approx(-2 * SHAPE)
    nodes = [data(one)[0][0] for one in axes.get_lines() if np.ptp(data(one)[0]) == 0]
    assert nodes == pytest.approx([10, 30, 50, 70])
    assert axes.get_xlabel() == "position across the nodal lines (mm)"
    assert axes.get_ylabel() == "deflection at 2 µm (µm)"
    low, high = axes.get_xlim()
    assert low < 0
    assert low + high == pytest.approx(80)
    # The largest is 3 µm: what lies beyond is no deflection and has no numbers.
    assert axes.get_ylim()[1] > 3.3
    assert np.max(np.abs(axes.get_yticks())) <= 3
    above = axes.child_axes[0]
    assert list(above.get_xticks()) == pytest.approx([10, 30, 50, 70])
    assert [one.get_text() for one in above.get_xticklabels()] == ["10.0", "30.0", "50.0", "70.0"]
    assert above.get_xlabel() == "nodal lines at (mm)"
    assert above.get_xticklabels()[0].get_rotation() == 0
    # The half wave in the middle is measured.
    arrow, text = (one for one in axes.texts if one.get_text()[:1] in ("", "λ"))
    assert (arrow.xy[0], arrow.xyann[0]) == pytest.approx((30, 50))
    assert arrow.xy[1] == arrow.xyann[1] > 3
    assert text.get_text().replace("\u00a0", " ") == "λ/2 = 20 mm in the mean"
    assert text.xy == pytest.approx((40, arrow.xy[1]))
    # The ceramics below it, in their places; the last is too narrow for a sign.
    assert [one[0::2] for one in boxes(axes, PLUS)] == [
        pytest.approx((5, 10)), pytest.approx((60, 1)),
    ]  # fmt: skip
    assert [one[0::2] for one in boxes(axes, MINUS)] == [pytest.approx((25, 10))]
    bottom, height = boxes(axes, PLUS)[0][1::2]
    assert axes.get_ylim()[0] < bottom < bottom + height < -3
    assert signs(axes) == [
        ("+", pytest.approx(10), pytest.approx(bottom + height / 2)),
        ("−", pytest.approx(30), pytest.approx(bottom + height / 2)),
    ]


def test_ceramics_are_only_under_a_mode_along_which_they_lie() -> None:
    axes = mode_shape(vibrating(small_plate(lines_across="width"))).axes[0]
    assert boxes(axes, PLUS) == []
    assert -4.5 < axes.get_ylim()[0] < -3


def test_a_mode_that_does_not_move_has_relative_deflections() -> None:
    (axes,) = mode_shape(vibrating(small_plate(), amplitude=0.9e-12)).axes
    assert axes.get_ylabel() == "relative deflection"
    assert data(labelled(axes)["one extreme of the vibration"])[1] == pytest.approx(SHAPE)
    (axes,) = mode_shape(vibrating(small_plate(), amplitude=1.1e-12)).axes
    assert axes.get_ylabel() == "deflection at 1.1 pm (µm)"


@pytest.mark.parametrize(
    ("nodes", "marked", "label", "turned"),
    [
        (3, 3, "nodal lines at (mm)", 0),
        (14, 14, "nodal lines at (mm)", 0),
        (15, 15, "nodal lines at (mm)", 90),
        (26, 26, "nodal lines at (mm)", 90),
        (27, 14, "nodal lines at (mm), one in 2", 0),
        (60, 20, "nodal lines at (mm), one in 3", 90),
    ],
)
def test_nodal_lines_are_named_as_far_as_there_is_room(
    nodes: int, marked: int, label: str, turned: int
) -> None:
    places = np.linspace(10e-3, 70e-3, nodes)
    line = SimpleNamespace(position=X, deflection=SHAPE, nodal_positions=places)
    axes = mode_shape(vibrating(small_plate(), line=line)).axes[0]
    above = axes.child_axes[0]
    names = above.get_xticklabels()
    assert len(names) == marked
    assert above.get_xlabel() == label
    assert {one.get_rotation() for one in names} == {turned}
    every = -(-nodes // 26)
    assert [one.get_text() for one in names] == [f"{1e3 * one:.1f}" for one in places[::every]]
    # Fewer than four leave no half wave that is not at an end.
    assert any("λ/2" in one.get_text() for one in axes.texts) == (nodes >= 4)


def test_a_ring_s_mode_is_three_of_its_waves() -> None:
    half = 9.35e-3
    found = vibrating(stator(), line=None, half_wavelength=half, label="B(0,9)")
    figure = mode_shape(found)
    assert words(figure.get_suptitle()) == (
        "3 of the 9 waves around the ring: a nodal line every 9.35 mm, where the surface stands "
        "still"
    )
    (axes,) = figure.axes
    x, y = data(labelled(axes)["one extreme of the vibration"])
    assert (x[0], x[-1]) == (0, pytest.approx(3 * 18.7))
    assert y == pytest.approx(2 * np.sin(2 * np.pi * x / 18.7), abs=1e-9)
    nodes = [data(one)[0][0] for one in axes.get_lines() if np.ptp(data(one)[0]) == 0]
    assert nodes == pytest.approx(9.35 * np.arange(7))
    assert axes.get_xlabel() == "position along the mean circumference (mm), 3 of 9 waves"
    assert boxes(axes, PLUS) == []
    two = mode_shape(vibrating(stator(2), line=None, half_wavelength=half))
    assert words(two.get_suptitle()).startswith("2 of the 2 waves")


FREQUENCY = np.linspace(29.5e3, 30.5e3, 401)


def driven(**changes: Any) -> Any:
    """A resonance of Q = 100 at 30 kHz with 100 nm/V at its top, driven on it by 20 V."""
    peak = changes.pop("peak", 1e-7)
    r = FREQUENCY / 30e3
    own = changes.pop("own", peak)
    solid = changes.pop("solid", None)
    free = changes.pop("free", 2e-6)
    parts: dict[str, Any] = {
        "voltage": 20.0, "vibration_amplitude": free, "frequency": 30e3,
        "touch": SimpleNamespace(free_amplitude=free),
        "mode": SimpleNamespace(
            solid=solid, amplitude_per_volt=own, resonance_frequency=30e3, quality_factor=100.0
        ),
    }  # fmt: skip
    return SimpleNamespace(
        response=SimpleNamespace(
            frequency=FREQUENCY, model="a-model",
            amplitude_per_volt=peak / 100 / np.abs(1 - r**2 + 0.01j * r),
        ),
        prediction=SimpleNamespace(**{**parts, **changes}),
    )  # fmt: skip


def test_a_response_has_its_resonance_band_and_drive() -> None:
    figure = frequency_response(driven())
    assert words(figure.get_suptitle()) == (
        "The resonance at 30 kHz is 300 Hz wide: the drive must stay on it"
    )
    (axes,) = figure.axes
    seen = {words(name): one for name, one in labelled(axes).items()}
    assert list(seen) == [
        "half-power band, 29.85 to 30.15 kHz (above 71 % of the peak)",
        "amplitude per volt, quality factor Q = 100", "resonance, 30 kHz",
        "drive: 20 V at 30 kHz, 2 µm free",
    ]  # fmt: skip
    band, curve, line, drive = seen.values()
    ends = axes.transData.inverted().transform(band.get_extents())[:, 0]
    assert ends == pytest.approx([29.85, 30.15], abs=2e-3)
    f, w = data(curve)
    assert f == pytest.approx(FREQUENCY / 1e3)
    assert np.max(w) == pytest.approx(100)
    assert data(line)[0] == pytest.approx([30, 30])
    # 2 µm at 20 V are 100 nm/V.
    assert data(drive) == (pytest.approx([30]), pytest.approx([100]))
    assert axes.get_xlim() == pytest.approx((29.5, 30.5))
    low, high = axes.get_ylim()
    assert low == 0
    assert 100 < high < 120
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        "frequency (kHz)", "amplitude per volt, free (nm/V)",
    )  # fmt: skip
    (right,) = axes.child_axes
    assert right.get_ylabel() == "amplitude at 20 V (µm)"
    FigureCanvasAgg(figure).draw()
    assert right.get_ylim() == pytest.approx(0.02 * np.array(axes.get_ylim()))


@pytest.mark.parametrize(("share", "said"), [(0.985, " 98 % of the motion"), (0.995, None)])
def test_a_drive_beside_the_resonance_is_said(share: float, said: str | None) -> None:
    # What a finger damps is no matter of where the drive is.
    found = driven(frequency=30.02e3, free=share * 2e-6, vibration_amplitude=0.5e-6)
    title = words(frequency_response(found).get_suptitle())
    assert title.startswith("The resonance at 30 kHz is 300 Hz wide: the drive must stay on it")
    assert ("but at 30.02 kHz it gets" in title) == (said is not None)
    if said:
        assert title.endswith(said)
    name = [*labelled(frequency_response(found).axes[0])][-1]
    assert words(name).endswith(" µm free, 0.5 µm with the finger on")


def test_a_drive_outside_the_sweep_or_none_is_not_drawn() -> None:
    def names(**changes: Any) -> list[str]:
        return [words(name) for name in labelled(frequency_response(driven(**changes)).axes[0])]

    ends = (29.5e3, 30.5e3)
    assert all("drive: 20 V" in names(frequency=at)[-1] for at in ends)
    assert all("resonance" in names(frequency=at)[-1] for at in (29.4e3, 30.6e3))
    given = frequency_response(driven(voltage=None))
    assert list(labelled(given.axes[0]))[-1].startswith("resonance")
    assert given.axes[0].child_axes == []
    # Nothing moves at 0 V; the drive still stands at the peak per volt.
    still = frequency_response(driven(voltage=0.0, free=0.0)).axes[0]
    assert words(list(labelled(still))[-1]).startswith("drive: 0 V at 30 kHz")
    assert data(list(labelled(still).values())[-1])[1] == pytest.approx([100])
    assert still.child_axes == []


def test_ceramics_that_cancel_out_have_no_band() -> None:
    """What is left of the drive is a rounding error of the others' peak."""
    for changes in ({"own": 1e-18}, {"solid": SimpleNamespace(alone_per_volt=1e-18)}):
        figure = frequency_response(driven(**changes))
        assert words(figure.get_suptitle()) == (
            "The ceramics cancel out: they do not drive the mode at 30 kHz"
        )
        assert not any("half-power" in name for name in labelled(figure.axes[0]))
    figure = frequency_response(driven(peak=0.0))
    assert figure.axes[0].get_ylim() == (0, 1)


def test_half_power_lies_on_the_line_between_two_points() -> None:
    # A triangle of height 1 falls to 1/√2 at 1 − 1/√2 of its base to either side.
    frequency = np.array([0.0, 10.0, 20.0, 40.0])
    edge = 10 * (1 - 1 / math.sqrt(2))
    found = half_power(frequency, np.array([0.0, 0.0, 1.0, 0.0]))
    assert found == pytest.approx((20 - edge, 20 + 2 * edge))
    assert half_power(frequency, np.array([1.0, 0.5, 0.2, 0.1])) is None
    assert half_power(frequency, np.array([0.1, 0.5, 0.8, 1.0])) is None
    # What falls to exactly that value has not fallen below it.
    assert half_power(frequency, np.array([0.8, 0.9, 1.0, 0.8])) is None


def test_every_figure_fits_a_page() -> None:
    """Wider than tall, and not so flat that nothing can be read."""
    for figure in (
        layout(described(stator())), layout(described(tpad())), layout(described(paper())),
        mode_shape(vibrating(small_plate())), frequency_response(driven()),
    ):  # fmt: skip
        assert 0.35 < figure.get_figheight() / figure.get_figwidth() < 0.9
