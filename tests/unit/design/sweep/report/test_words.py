"""A sweep as table, figure and files."""

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import parquet_of_columns
from squeezefilm.design.sweep.axes import Axis
from squeezefilm.design.sweep.followed import FollowedMode
from squeezefilm.design.sweep.report.figures import sweep_figure
from squeezefilm.design.sweep.report.page import require_kind, sweep_csv, write_sweep
from squeezefilm.design.sweep.report.terminal import (
    in_lines,
    name_of,
    scaled,
    show_answers,
    show_sweep,
    sweep_columns,
)
from squeezefilm.design.sweep.swept import NOT_YET, Sweep, SweptColumn

pytestmark = pytest.mark.usefixtures("figures_as_described")

ONE, M, V, HZ = (si.Unit(symbol) for symbol in ("1", "m", "V", "Hz"))


def axis(name: str, values: list[Any], unit: si.Unit | None, log: bool = False) -> Axis:
    return Axis((name,), (unit,), tuple((value,) for value in values), log)


THICK = axis("actuator.thickness", [1e-3, 2e-3, 3e-3], M)


def made(axes: tuple[Axis, ...], *columns: SweptColumn, **changes: Any) -> Sweep:
    points = int(np.prod([len(one) for one in axes]))
    values: dict[str, Any] = {
        "title": "plate", "verbs": ("predict",), "axes": axes, "columns": columns,
        "reasons": ("",) * points, "warnings": (), "computed": points, "kept": 0,
        "provenance": {"seed": None, "finger": "person 3's"},
    }  # fmt: skip
    return Sweep(**{**values, **changes})


FRICTION = SweptColumn("relative_friction", ONE, np.array([0.3, np.nan, 0.5]))
AMPLITUDE = SweptColumn("vibration_amplitude_m", M, np.array([2e-6, np.nan, 1e-6]))
LINE = made((THICK,), FRICTION, AMPLITUDE, reasons=("", "=too thick, at 2 mm", ""))


def test_the_table_has_units_in_its_head_and_a_reason_that_is_no_formula() -> None:
    rows = list(csv.reader(io.StringIO(sweep_csv(LINE))))
    assert rows == [
        ["actuator.thickness_m", "relative_friction", "vibration_amplitude_m", "reason"],
        ["0.001", "0.3", "2e-06", ""],
        ["0.002", "", "", "'=too thick, at 2 mm"],
        ["0.003", "0.5", "1e-06", ""],
    ]


def test_people_read_units_once_and_a_dash_for_nothing() -> None:
    assert sweep_columns(LINE) == [
        ("actuator.thickness", ["1 mm", "2 mm", "3 mm"]),
        ("relative friction", ["0.3", "–", "0.5"]),
        ("vibration amplitude (µm)", ["2", "–", "1"]),
    ]
    assert scaled(np.array([np.nan, 33.5e3]), HZ) == (pytest.approx(1e-3), "kHz")
    assert scaled(np.array([0.0]), HZ) == (1.0, "Hz")
    assert scaled(np.array([2.0]), None) == (1.0, "")
    followed = SweptColumn("followed.(8,0).amplitude_per_volt_m_per_V", si.Unit("m/V"), np.zeros(1))
    assert name_of(followed) == "(8,0) amplitude per volt"


def said(capsys: pytest.CaptureFixture[str], found: Sweep) -> str:
    show_sweep(found)
    return " ".join(capsys.readouterr().out.split())


def test_the_terminal_says_what_failed_what_was_warned_of_and_what_is_missing(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = said(capsys, LINE)
    assert "plate: 3 points" in text
    assert "1 of 3 points have no answer: =too thick, at 2 mm" in text
    assert "3 answers computed, 0 taken from before" in text
    stopped = made((THICK,), FRICTION, reasons=("", NOT_YET, NOT_YET),
                   warnings=tuple((f"careful {word}", 2) for word in "abcd"))  # fmt: skip
    text = said(capsys, stopped)
    assert "2 of 3 points were not computed yet" in text
    assert "careful a (at 2 of 3 points" in text
    assert "1 more warnings stand in sweep.json" in text
    assert "careful d" not in text


def test_many_points_are_cut_and_many_numbers_turned(capsys: pytest.CaptureFixture[str]) -> None:
    volts = axis("voltage", [float(k) for k in range(100)], V)
    text = said(capsys, made((volts,), SweptColumn("relative_friction", ONE, np.arange(100.0))))
    assert "…" in text
    assert "19 V" in text
    assert "20 V" not in text
    few = axis("voltage", [float(k) for k in range(40)], V)
    assert "…" not in said(
        capsys, made((few,), SweptColumn("relative_friction", ONE, np.arange(40.0)))
    )

    def table(points: int, numbers: int) -> str:
        steps = axis("voltage", [float(k) for k in range(points)], V)
        columns = [
            SweptColumn(f"number{k}", ONE, np.arange(float(points)) + 10 * k)
            for k in range(numbers)
        ]
        return said(capsys, made((steps,), *columns))

    assert "number8 80 81 82 83 84 85 86" in table(7, 9)
    assert "number5 50 51" not in table(7, 6)
    assert "more columns" not in table(8, 6)
    assert "3 more columns stand in the files" in table(8, 9)
    assert "number6" not in table(8, 9)


def test_modes_that_were_followed_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    modes = (
        FollowedMode("(8,0)", (0, 0, 0), np.array([1, 0.9, 0.8]), True),
        FollowedMode("(0,5)", (1, None, None), np.array([1, 0.2, np.nan]), False),
    )
    columns = [
        SweptColumn(f"followed.{one.label}.frequency_Hz", HZ, 1e3 * np.array([30.0, 31, 32]))
        for one in modes
    ]
    found = made((THICK,), *columns, follows=modes, verbs=("followed",))
    text = said(capsys, found)
    assert "2 modes followed by their shapes, 1 of them lost on the way" in text
    assert "least likeness from one point to the next 0.80" in text
    (axes,) = sweep_figure(found).axes
    legend = axes.get_legend()
    assert legend is not None
    assert [one.get_text() for one in legend.get_texts()] == ["(8,0)", "not driven"]
    assert axes.get_ylabel() == "frequency of 2 modes (kHz)"


def test_lines_over_one_axis_with_crosses_where_nothing_is() -> None:
    figure = sweep_figure(LINE)
    left, right = figure.axes
    line, crosses = left.get_lines()
    assert np.asarray(line.get_xdata()) == pytest.approx([1, 2, 3])
    assert np.asarray(line.get_ydata())[[0, 2]] == pytest.approx([0.3, 0.5])
    assert np.asarray(crosses.get_xdata()).tolist() == pytest.approx([2])
    assert (left.get_xlabel(), right.get_ylabel()) == (
        "actuator.thickness (mm)", "vibration amplitude (µm)",
    )  # fmt: skip
    assert "crosses: 1 of 3 points without an answer" in " ".join(figure.get_supxlabel().split())


def test_a_second_axis_is_lines_or_a_map_by_its_steps() -> None:
    volts = axis("voltage", [1.0, 10.0, 100.0], V, log=True)
    values = np.arange(9.0)
    values[4] = np.nan
    few = sweep_figure(made((THICK, volts), SweptColumn("relative_friction", ONE, values)))
    legend = few.axes[0].get_legend()
    assert legend is not None
    assert [one.get_text() for one in legend.get_texts()] == ["1 V", "10 V", "100 V"]
    steps = axis("voltage", [float(10**k) for k in range(9)], V, log=True)
    grid = np.arange(27.0)
    grid[5] = np.nan
    drawn = sweep_figure(made((THICK, steps), SweptColumn("relative_friction", ONE, grid)))
    face = drawn.axes[0]
    assert (face.get_xlabel(), face.get_ylabel(), face.get_yscale()) == (
        "actuator.thickness (mm)", "voltage (MV)", "log",
    )  # fmt: skip
    (mesh,) = (
        one
        for one in face.collections
        if one.get_array() is not None and one.get_array().size == 27
    )  # type: ignore[union-attr]
    assert np.ma.getmaskarray(mesh.get_array()).sum() == 1
    words = axis("surface", ["bare", "adhesive"], None)
    named = sweep_figure(
        made((words, THICK), SweptColumn("relative_friction", ONE, np.arange(6.0)))
    )
    assert named.axes[0].get_xlabel() == "actuator.thickness (mm)"


@pytest.mark.parametrize(
    ("axes", "values", "message"),
    [
        ((THICK,), [np.nan] * 3, "No point has an answer"),
        ((axis("voltage", [1.0], V),), [1.0], "one point alone"),
        ((THICK, THICK, THICK), [1.0] * 27, "too many for one picture"),
    ],
)
def test_what_cannot_be_drawn_says_why(
    axes: tuple[Axis, ...], values: list[float], message: str
) -> None:
    figure = sweep_figure(made(axes, SweptColumn("relative_friction", ONE, np.array(values))))
    texts = [one.get_text() for one in (*figure.texts, *(t for a in figure.axes for t in a.texts))]
    assert message in " ".join(" ".join(texts).split())


@pytest.mark.usefixtures("undrawn")
def test_files_are_written_whole_in_either_kind(tmp_path: Path) -> None:
    assert write_sweep(LINE, tmp_path / "a") == tmp_path / "a" / "index.html"
    names = {one.name for one in (tmp_path / "a").iterdir()}
    assert names == {"index.html", "effects.png", "tradeoffs.png"} | {
        "sweep.csv", "sweep.json", "sweep.png",
    }  # fmt: skip
    rows = json.loads((tmp_path / "a" / "sweep.json").read_text())["rows"]
    assert [row["relative_friction"] for row in rows] == [0.3, None, 0.5]
    write_sweep(LINE, tmp_path / "b", table="parquet")
    assert (tmp_path / "b" / "sweep.parquet").exists()
    with pytest.raises(InputError, match="may be csv or parquet"):
        require_kind("xlsx")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is a file, not a folder"):
        write_sweep(LINE, tmp_path / "file")


def test_parquet_has_numbers_texts_and_nothing() -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    data = parquet_of_columns({"a": [1.0, None], "b": ["x", "y"]}, {"seed": 3})
    held = parquet.read_table(io.BytesIO(data))
    assert held.to_pydict() == {"a": [1.0, None], "b": ["x", "y"]}


def test_all_that_can_be_asked_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    show_answers()
    text = capsys.readouterr().out
    assert "  relative_friction\n" in text
    assert "  modes.N.frequency\n" in text


def test_a_head_breaks_between_its_words() -> None:
    assert in_lines("resonance_frequency (kHz)") == "resonance\n_frequency\n(kHz)"
    assert in_lines("actuator.thickness (mm)") == "actuator.\nthickness\n(mm)"
    assert in_lines("power (W)") == "power (W)"
