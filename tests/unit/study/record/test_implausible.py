"""Files with rows that cannot be what they say are refused, with the line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import ConfigError
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.record.foreign import read_answers
from squeezefilm.study.record.implausible import _require_one_scale, _require_pair

DESIGN = load_design("friction-jnd")
HEAD = "participant_id,stimulus,second_stimulus,choice,response_time_s"
Rows = list[list[str]]


def rows() -> Rows:
    """Two people's twenty answers each."""
    random = np.random.default_rng(3)
    return [
        [
            who,
            "30 %",
            f"{random.choice([18, 42])} %",
            str(random.choice(DESIGN.answers)),
            f"{t:.4f}",
        ]
        for who in ("a", "b")
        for t in 0.5 + random.exponential(1.0, 20)
    ]


def write(folder: Path, made: Rows, head: str = HEAD, delimiter: str = ",") -> Path:
    path = folder / "answers.csv"
    lines = [head.replace(",", delimiter), *(delimiter.join(row) for row in made)]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def changed(line: int, column: int, text: str) -> Rows:
    made = rows()
    made[line - 2][column] = text
    return made


def test_an_ordinary_file_is_read(tmp_path: Path) -> None:
    assert read_answers(write(tmp_path, rows()), DESIGN).trials == 40


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda: rows() * 2, "line 42.*'a' has 20 rows twice, this one in line 2"),
        (lambda: rows()[:12] + rows()[8:], "rows twice"),
        (lambda: rows() + [["c", *row[1:]] for row in rows()[:20]], "'c' has the same answers"),
        (lambda: changed(5, 4, "-0.7"), "line 5.*-0.7 s is no response time"),
        (lambda: changed(7, 1, "18 %"), "line 7.*no reference"),
        (lambda: changed(7, 2, ""), "line 7.*no reference"),
        (lambda: [[*r[:4], str(1000 * float(r[4]))] for r in rows()], "milliseconds"),
        (lambda: changed(9, 3, "left"), 'line 9.*values = "left=first"'),
        (lambda: changed(9, 1, "30"), "Did you mean '30 %'"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path: Path, made: Callable[[], Rows], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        read_answers(write(tmp_path, made()), DESIGN)


def test_a_file_without_times_pasted_twice_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [row[:4] for row in rows() * 2], HEAD.rpartition(",")[0])
    with pytest.raises(ConfigError, match="twice"):
        read_answers(path, DESIGN)


def test_other_words_units_and_commas_are_read_on_request(tmp_path: Path) -> None:
    plain = read_answers(write(tmp_path, rows()), DESIGN)
    words = {"first": "left", "second": "right"}
    theirs = [[*r[:3], words[r[3]], str(1000 * float(r[4])).replace(".", ",")] for r in rows()]
    path = write(tmp_path, theirs, HEAD.replace("time_s", "time_ms"), ";")
    with pytest.raises(ConfigError, match="decimal"):
        read_answers(path, DESIGN, values={"left": "first", "right": "second"})
    found = read_answers(
        path,
        DESIGN,
        None,
        {"left": "first", "right": "second"},
        decimal_comma=True,
    )
    assert found.choice.tolist() == plain.choice.tolist()
    assert found.response_time == pytest.approx(plain.response_time)


def estimates(values: list[float], stimulus: str = "a") -> Any:
    return [
        (line, {"stimulus": stimulus, "estimate": str(value)})
        for line, value in enumerate(values, 2)
    ]


def test_one_number_in_another_unit_is_refused_with_its_line() -> None:
    usual = [1.0, 2.0, 3.0] * 4
    for odd in (2.0 * 299, 2.0 / 299, 0.5):
        _require_one_scale("f", "p", estimates([*usual, odd]))
    for odd, said in ((2.0 * 301, "602|301"), (2.0 / 301, "0.00332")):
        with pytest.raises(ConfigError, match=f"'p' gave 'a' ({said}) times the usual") as found:
            _require_one_scale("f", "p", estimates([*usual, odd]))
        assert found.value.line == 14
    # Of few numbers, or two of a surface, nothing can be told.
    _require_one_scale("f", "p", estimates([1.0, 1.0, 1.0, 1000.0]))
    other = [(20, {"stimulus": "b", "estimate": "1e6"}), (21, {"stimulus": "b", "estimate": "1"})]
    _require_one_scale("f", "p", [*estimates(usual), *other])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, None),
        ({"stimulus": "other"}, None),
        ({"stimulus": "other", "second_stimulus": "third"}, "other / third has no reference"),
        ({"stimulus": ""}, "has no reference"),
        ({"adaptive_series": "up", "intensity": "0.1"}, None),
        ({"adaptive_series": "up", "intensity": "2.0"}, None),
        ({"adaptive_series": "up", "intensity": "0.0"}, None),
        ({"adaptive_series": "up", "intensity": "2.1"}, "2.1 is outside the series 'up'"),
        ({"adaptive_series": "up", "intensity": "0.04"}, "0.04 is outside the series"),
    ],
)
def test_a_pair_has_its_reference_and_a_series_its_range(
    changes: dict[str, str], said: str | None
) -> None:
    design: Any = SimpleNamespace(
        task="two-interval",
        reference="ref",
        described=SimpleNamespace(surfaces=2, ranks=()),
        series=lambda name: SimpleNamespace(
            name=name, lowest=0.1, highest=1.0, in_runs=name == "runs"
        ),
    )
    row = {"stimulus": "a", "second_stimulus": "ref", "adaptive_series": "", **changes}
    if said is None:
        _require_pair("f", 7, design, row)
        return
    with pytest.raises(ConfigError, match=said) as found:
        _require_pair("f", 7, design, row)
    assert found.value.line == 7


def test_of_the_same_twice_no_reference_is_asked() -> None:
    alike: Any = SimpleNamespace(
        task="same-different", reference="ref", described=SimpleNamespace(surfaces=2, ranks=())
    )
    row = {"stimulus": "a", "second_stimulus": "a", "adaptive_series": ""}
    _require_pair("f", 7, alike, row)
    with pytest.raises(ConfigError, match="has no reference"):
        _require_pair("f", 7, alike, row | {"second_stimulus": "b"})
