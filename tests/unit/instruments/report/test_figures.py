"""Figures of a session: the pass in the middle, commands at their time, lateness as counted."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import labelled, words

from squeezefilm.core.kit.style import BLUE, GREEN, ORANGE
from squeezefilm.instruments.bench.played_session import PlayedWay
from squeezefilm.instruments.report.page import amplitude, friction, lateness
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.shared import CLASSES, Lateness, lateness_class

pytestmark = pytest.mark.usefixtures("figures_as_described")

TIME = np.linspace(0, 0.9, 901)
# To and fro over 30 mm: there, back, and there again, 0.3 s each.
ZIGZAG = 0.1 * np.interp(TIME, [0, 0.3, 0.6, 0.9], [0, 0.3, 0, 0.3])
LARGEST = 2e-6


def way(x: np.ndarray = ZIGZAG, time: np.ndarray = TIME, source: str = "the twin") -> PlayedWay:
    # Friction tells the moment, so that what is drawn tells which pass it is of.
    return PlayedWay(
        time, x, np.ones(x.size), 1e-6 + 1e-6 * time, 0.5 + 0.1 * time, 0.6 + 0.1 * time, source
    )


def report(contrast: list[float], lag: float) -> Any:
    return SimpleNamespace(contrast_kept=np.array(contrast), lag=lag)


def session(**changes: Any) -> Any:
    rows = np.full((901, 14), np.nan)
    rows[:, column.TIME], rows[:, column.X] = TIME, ZIGZAG
    # In inverted phase every other tick: an amplitude all the same.
    rows[:, column.VOLTAGE] = 8 * TIME * np.where(np.arange(901) % 2, -1, 1)
    rows[100:, column.LAG] = np.linspace(0, 0.6e-3, 801)
    loop = SimpleNamespace(
        amplitude_per_volt=0.2e-6,
        envelope=SimpleNamespace(rise_time_constant=1.5e-3, amplitude_limit=LARGEST),
        output_delay=6e-3, compensation="inverse",
    )  # fmt: skip
    judged = SimpleNamespace(way=way(), fidelity=report([np.nan, 0.8, 0.3], 0.25e-3))
    seen = SimpleNamespace(way=way(time=TIME + 0.0005, source="the record"), fidelity=None)
    parts: dict[str, Any] = {
        "setup": SimpleNamespace(name="grating", plan=SimpleNamespace(loop=loop, mode="stream")),
        "trace": SimpleNamespace(rows=rows), "by_truth": judged, "by_record": seen,
        "loop": lambda: {},
    }  # fmt: skip
    known = {**parts, **changes}
    return SimpleNamespace(**known, last=lambda kind: known[kind]())


def test_friction_is_drawn_over_the_pass_in_the_middle() -> None:
    figure = friction(session())
    axes = figure.axes[0]
    lines = labelled(axes)
    assert list(lines) == [
        "wanted where the finger was", "rendered", "by the record (sensor and pickup)",
    ]  # fmt: skip
    wanted, rendered, seen = lines.values()
    # The way back begins at 30 mm after 0.3 s; it is drawn from the left.
    x = np.linspace(0, 30, 301)
    time = 0.6 - x / 100
    for line, offset in ((wanted, 0.5), (rendered, 0.6)):
        assert line.get_xdata() == pytest.approx(x, abs=1e-9)
        assert line.get_ydata() == pytest.approx(offset + 0.1 * time)
    # Of the record what was seen from the pass's first to its last moment.
    assert seen.get_xdata().size == 300
    assert seen.get_xdata()[[0, -1]] == pytest.approx([30, 0.1])
    assert seen.get_ydata()[0] == pytest.approx(0.6 + 0.1 * 0.3005)
    assert [to_hex(one.get_color()) for one in lines.values()] == [ORANGE, BLUE, GREEN]
    assert axes.get_ylim() == (0, 1.05)
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        "place of the finger (mm)", "relative friction µ′/µ",
    )  # fmt: skip
    assert words(figure.get_suptitle()) == "grating: 80 % of the contrast is kept, 0.25 mm late"
    assert figure.get_supxlabel() == "Model: the twin; friction by the display's law"


@pytest.mark.parametrize(
    ("knots", "first", "last"),
    [
        ([0, 0.9], 0, 900),
        ([0, 0.6, 0.9], 0, 600),
        ([0, 0.3, 0.9], 300, 900),
    ],
    ids=["one pass", "in the first of two", "in the last of two"],
)
def test_the_pass_reaches_from_turn_to_turn(knots: list[float], first: int, last: int) -> None:
    up_down = [0.03 * (number % 2) for number in range(len(knots))]
    x = np.interp(TIME, knots, up_down)
    # A jitter of less than a millimetre turns nobody round.
    shaken = x + 0.3e-3 * (-1) ** np.arange(901)
    for place, slack in ((x, 0), (shaken, 2)):
        judged = SimpleNamespace(way=way(place), fidelity=None)
        axes = friction(session(by_truth=None, by_record=judged)).axes[0]
        rendered = np.sort(labelled(axes)["rendered"].get_ydata())
        moments = 1e3 * (rendered - 0.6) / 0.1
        assert moments[[0, -1]] == pytest.approx([first, last], abs=slack + 1e-6)
        assert len(axes.get_lines()) == 2


@pytest.mark.parametrize(
    ("judged", "said"),
    [
        (None, "grating: it cannot be judged"),
        (report([np.nan], -0.125e-3), "grating: played, 0.12 mm early"),
        (report([0.5], math.nan), "grating: 50 % of the contrast is kept"),
        (report([0.5], 0.0), "grating: 50 % of the contrast is kept, 0.00 mm late"),
    ],
)
def test_the_title_says_what_is_known(judged: Any, said: str) -> None:
    found = session(by_truth=None, by_record=SimpleNamespace(way=way(), fidelity=judged))
    assert words(friction(found).get_suptitle()) == said


@pytest.mark.parametrize(("samples", "drawn"), [(7, False), (8, True)])
def test_a_finger_that_was_hardly_seen_is_a_message(samples: int, drawn: bool) -> None:
    short = way(ZIGZAG[:samples], TIME[:samples])
    found = session(by_truth=None, by_record=SimpleNamespace(way=short, fidelity=None))
    assert (friction(found).get_suptitle() != "The finger was not seen") == drawn
    rows = session().trace.rows[:samples]
    played = amplitude(session(trace=SimpleNamespace(rows=rows)))
    assert (played.get_suptitle() != "Nothing was played") == drawn


def test_the_amplitude_is_drawn_over_a_quarter_of_a_second_in_the_middle() -> None:
    figure = amplitude(session())
    above, below = figure.axes
    lines = labelled(above)
    assert list(lines) == ["commanded, at its time", "true", "in the record"]
    commanded, true, seen = lines.values()
    t = commanded.get_xdata() - 0.006
    assert t[[0, -1]] == pytest.approx([0.325, 0.575], abs=1.1e-3)
    # 5 V make 1 µm: the amplitude is that of the voltage's size.
    assert commanded.get_ydata() == pytest.approx(8 * t / 5)
    assert commanded.get_drawstyle() == "steps-post"
    for line in (true, seen):
        assert line.get_xdata()[[0, -1]] == pytest.approx([0.325, 0.575], abs=1.1e-3)
        assert line.get_ydata()[[0, -1]] == pytest.approx([1.325, 1.575], abs=1.1e-3)
    assert seen.get_xdata()[0] % 1e-3 == pytest.approx(0.5e-3)
    (place,) = below.get_lines()
    assert place.get_xdata() == pytest.approx(t)
    assert place.get_ydata() == pytest.approx(100 * (0.6 - t))
    assert above.get_ylim() == pytest.approx((0, 2.24))
    assert below.get_xlim() == pytest.approx((t[0], t[-1]))
    assert above.get_ylabel() == "amplitude (µm)"
    assert (below.get_xlabel(), below.get_ylabel()) == ("time (s)", "place (mm)")
    assert words(figure.get_suptitle()) == (
        "The display reaches 2 µm; the plate follows its commands with τ = 1.5 ms"
    )
    assert words(figure.get_supxlabel()) == (
        "Model: mode stream, compensation inverse, commands 6 ms ahead"
    )
    alone = amplitude(session(by_truth=None)).axes[0]
    assert list(labelled(alone)) == ["commanded, at its time", "in the record"]


def late(lost: int, classes: dict[float, int], rate: float = 1e3) -> Any:
    counts = np.zeros(CLASSES, dtype=np.int64)
    for seconds, count in classes.items():
        counts[lateness_class(1e9 * seconds)] += count
    found = Lateness(rate, int(counts.sum()), lost, 1.0, counts)
    return lambda: {"lateness": found.to_json()}


def test_lateness_is_drawn_as_it_was_counted() -> None:
    figure = lateness(session(loop=late(10, {1.05e-5: 600, 1.05e-4: 390})))
    left, right = figure.axes
    (stairs,) = left.patches
    values, edges, _ = stairs.get_data()
    for micro, count in ((10.5, 600), (105.0, 390)):
        (number,) = np.flatnonzero(values == count)
        assert edges[number] <= micro < edges[number + 1]
    assert values.sum() == 990
    # Twenty classes a decade; the first is as wide as the next.
    assert np.diff(np.log10(edges)) == pytest.approx(0.05)
    assert edges[1] == pytest.approx(0.1)
    (period,) = left.get_lines()
    assert period.get_xdata() == pytest.approx([1000, 1000])
    low, high = left.get_xlim()
    # Two classes below the first that was counted, up to two periods.
    assert low == pytest.approx(10 * 10**-0.1)
    assert high == pytest.approx(2000)
    assert left.get_ylim()[0] == 0.7
    assert (left.get_xscale(), left.get_yscale()) == ("log", "log")
    assert (left.get_xlabel(), left.get_ylabel()) == ("lateness (µs)", "ticks")
    assert left.xaxis.get_major_formatter()(10) == "10"
    assert left.yaxis.get_major_formatter()(100) == "100"
    assert [one.get_text() for one in left.get_legend().get_texts()] == ["a period"]
    assert words(figure.get_suptitle()) == (
        "1 % of 1000 ticks were lost; half are made within 11 µs, 99.9 % within 0.11 ms"
    )
    assert words(figure.get_supxlabel()) == (
        "Model: loop at 1 kHz; a tick is lost when the next is due before it began"
    )
    bars = right.containers[0].datavalues
    # 801 ways from 0 to 0.6 mm; the hundred unknown ones are in no bar.
    assert (len(bars), bars.sum()) == (60, 801)
    edges = [one.get_x() for one in right.patches]
    assert (edges[0], edges[-1]) == pytest.approx((0, 0.59), abs=1e-12)
    assert (right.get_xlabel(), right.get_ylabel()) == (
        "way from sample to its command (mm)", "ticks",
    )  # fmt: skip


def test_no_tick_lost_and_no_lag_known() -> None:
    rows = np.full((9, 14), np.nan)
    found = session(loop=late(0, {5e-8: 3, 4e-3: 1}), trace=SimpleNamespace(rows=rows))
    figure = lateness(found)
    left, right = figure.axes
    assert words(figure.get_suptitle()).startswith("None of 4 ticks was lost; half are made within")
    # What is later than two periods stays in sight, with half as much again.
    end = 10 ** (math.ceil(20 * math.log10(4000)) / 20)
    assert left.get_xlim() == pytest.approx((0.1 * 10**-0.05, 1.5 * end))
    assert not right.containers


@pytest.mark.parametrize("said", [dict, late(7, {})])
def test_a_loop_without_a_tick_is_a_message(said: Any) -> None:
    figure = lateness(session(loop=said))
    assert figure.get_suptitle() == "The loop could not say how late it was"
    assert [one.get_text() for one in figure.axes[0].texts] == ["It made no tick."]
