"""What the terminal shows of a session: numbers where there are some, a dash where not."""

from __future__ import annotations

import io
import math

import pytest

from squeezefilm.bench.check import CheckResult, DeviceCheck
from squeezefilm.device.wire.states import Fault, State
from squeezefilm.report.played.terminal import bar, live_view, show_check, view_line, view_table
from squeezefilm.session.play.plan import PlayView

VIEW = PlayView(
    time=1.25, x=12.34e-3, speed=0.06, wanted=1e-6, amplitude=0.9e-6, friction=0.7, level=8.0,
    lag=0.4e-3, lateness=12e-6, state=State.PLAYING, fault=Fault.NONE, readings=5, rows=7,
    flags=("ticks were lost just before this one",),
)  # fmt: skip
UNKNOWN = PlayView(
    time=0.0, x=math.nan, speed=math.nan, wanted=math.nan, amplitude=math.nan,
    friction=math.nan, level=math.nan, lag=math.nan, lateness=math.nan, state=State.FAULT,
    fault=Fault.WATCHDOG, readings=0, rows=0, flags=(),
)  # fmt: skip


def test_a_line_says_all_of_a_moment() -> None:
    assert view_line(VIEW) == (
        "   1.25 s, playing, x   12.34 mm, µ′/µ 0.700, amplitude 0.90 µm, lag 0.400 mm, "
        "late 12 µs, ticks were lost just before this one"
    )
    assert "fault (watchdog), x       – mm" in view_line(UNKNOWN)


@pytest.mark.parametrize("width", [60, 100])
@pytest.mark.parametrize("view", [VIEW, UNKNOWN])
def test_the_table_fits_a_terminal(view: PlayView, width: int) -> None:
    from rich.console import Console

    stream = io.StringIO()
    Console(file=stream, width=width).print(view_table(view))
    lines = stream.getvalue().splitlines()
    assert len(lines) == 9
    assert all(len(line) <= width for line in lines)
    assert lines[0].startswith("time")
    assert "friction µ′/µ" in stream.getvalue()
    assert ("fault: watchdog" if view is UNKNOWN else "fault: none") in stream.getvalue()


@pytest.mark.parametrize(("share", "full"), [(0.0, 0), (0.5, 14), (1.0, 28), (7.0, 28), (-1.0, 0)])
def test_a_bar_is_as_long_as_its_share(share: float, full: int) -> None:
    assert bar(share).count("█") == full
    assert len(bar(share)) == 28
    assert bar(math.nan) == ""


def test_off_a_terminal_the_live_view_is_a_line_a_second(
    capsys: pytest.CaptureFixture[str],
) -> None:
    from dataclasses import replace

    with live_view(True) as show:
        assert show is not None
        for tenth in range(25):
            show(replace(VIEW, time=0.1 * tenth))
    assert len(capsys.readouterr().err.splitlines()) == 3
    with live_view(False) as show:
        assert show is None


def test_a_check_shows_what_failed_and_what_to_do(capsys: pytest.CaptureFixture[str]) -> None:
    check = DeviceCheck(
        "twin",
        (
            CheckResult("link", True, "0 lost", "0"),
            CheckResult("watchdog", False, "never", "60 ms", "do not play on this device"),
        ),
    )
    show_check(check)
    said = capsys.readouterr().out
    assert "! watchdog: do not play on this device" in said
    assert "1 of 2 checks passed" in said
