"""Files with rows that cannot be what they say are refused, with the line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import ConfigError, InputError
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
        (lambda: rows() + [["c", *row[1:]] for row in rows()[5:20]], "'c' has the same answers"),
        (lambda: [*rows(), *rows()[:15], *rows()[20:35]], "rows twice"),
        (lambda: [["a", *row[1:]] for row in rows()[20:35]] + rows(), "'b' has the same answers"),
        (lambda: changed(25, 0, "B "), "'B' and 'b' are written alike|'b' and 'B' are written"),
        (lambda: changed(25, 0, "b\u200b"), "written alike"),
        (lambda: [[f"{k % 2}1", *row[1:]] for k, row in enumerate(rows())], None),
        (lambda: [["01" if k % 2 else "1", *r[1:]] for k, r in enumerate(rows())], "alike"),
        (lambda: [["1.0" if k % 2 else "1", *r[1:]] for k, r in enumerate(rows())], "alike"),
        (lambda: changed(9, 0, ""), "line 9.*participant_id.*nobody"),
        (lambda: changed(9, 4, "1250"), "line 9.*response_time_s.*1250 s here"),
        (lambda: changed(9, 4, "1_250"), "line 9.*'1_250' is no number"),
        (lambda: [[*row, "x"] for row in rows()], "line 2.*has 6 cells where the header has 5"),
        (lambda: [[*row, ""] for row in rows()], None),
        (lambda: [[*r[:4], f"{3 * k + 1}"] for k, r in enumerate(rows()[:20])], "moments"),
        (lambda: changed(9, 3, "left"), 'line 9.*values = "left=first"'),
        (lambda: changed(9, 1, "30"), "Did you mean '30 %'"),
    ],
)
def test_what_cannot_be_is_refused(
    tmp_path: Path, made: Callable[[], Rows], said: str | None
) -> None:
    """And what can, with nothing said, is read."""
    if said is None:
        assert read_answers(write(tmp_path, made()), DESIGN).trials == 40
        return
    with pytest.raises(ConfigError, match=said):
        read_answers(write(tmp_path, made()), DESIGN)


@pytest.mark.parametrize(
    ("column", "cells", "said"),
    [
        ("answer", ["foo"] * 40, "line 2.*'foo' is none of: first, second"),
        ("answer", ["first"] * 40, "'first' is not right here, where 'second' is"),
        ("count", ["inf"] * 40, "line 2.*'inf' is no count"),
        ("choice", ["first"] * 40, "has 2 columns 'choice'"),
        ("set_aside", ["False", "0", "no", ""] * 10, None),
        ("trial", [str(k % 20) for k in range(40)], None),
    ],
)
def test_another_column_is_true_or_refused(
    tmp_path: Path, column: str, cells: list[str], said: str | None
) -> None:
    made = [[*row, cell] for row, cell in zip(rows(), cells, strict=True)]
    path = write(tmp_path, made, f"{HEAD},{column}")
    if said is None:
        assert read_answers(path, DESIGN).trials == 40
        return
    with pytest.raises(InputError, match=said):
        read_answers(path, DESIGN)


def test_rows_are_in_the_order_of_their_trials(tmp_path: Path) -> None:
    made = [[*row, str(k % 20 + 1)] for k, row in enumerate(rows())]
    inner = read_answers(write(tmp_path, made, f"{HEAD},trial"), DESIGN)
    turned = read_answers(write(tmp_path, made[::-1], f"{HEAD},trial"), DESIGN)
    for who in ("a", "b"):
        times = [
            answers.response_time[answers.participant == answers.people.index(who)].tolist()
            for answers in (inner, turned)
        ]
        assert times[0] == times[1]


def test_an_answer_to_nothing_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [["Total", "", "432", "1"]], "participant_id,stimulus,estimate,trial")
    with pytest.raises(ConfigError, match=r"line 2.*stimulus: is empty"):
        read_answers(path, load_design("coarseness-magnitude"))


def test_no_key_pressed_is_no_answer(tmp_path: Path) -> None:
    assert read_answers(write(tmp_path, changed(9, 3, "None")), DESIGN).trials == 39


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


MAGNITUDES = load_design("coarseness-magnitude")
NAMES = [stimulus.name for stimulus in MAGNITUDES.stimuli]


def estimates(values: list[float], stimulus: str = NAMES[0], first: int = 2) -> Any:
    return [
        (line, {"stimulus": stimulus, "estimate": str(value)})
        for line, value in enumerate(values, first)
    ]


def test_one_number_in_another_unit_is_refused_with_its_line() -> None:
    usual = [1.0, 2.0, 3.0] * 4
    for odd in (2.0 * 29, 2.0 / 29, 0.5):
        _require_one_scale("f", MAGNITUDES, "p", estimates([*usual, odd]))
    for odd, said in ((2.0 * 31, "31"), (2.0 / 31, "0.0323")):
        with pytest.raises(ConfigError, match=f"gave '{NAMES[0]}' {said} times the us") as found:
            _require_one_scale("f", MAGNITUDES, "p", estimates([*usual, odd]))
        assert found.value.line == 14
    # Of few numbers, or two of a surface, nothing can be told.
    _require_one_scale("f", MAGNITUDES, "p", estimates([1.0, 1.0, 1.0, 1000.0]))
    other = estimates([1e6, 1.0], NAMES[1], 20)
    _require_one_scale("f", MAGNITUDES, "p", [*estimates(usual), *other])


@pytest.mark.parametrize("factor", [1e3, 1e-3, 100.0])
@pytest.mark.parametrize("which", [0, 2, len(NAMES) - 1])
def test_a_surface_whose_numbers_are_of_another_unit_is_named(factor: float, which: int) -> None:
    """Beside the power law of the others, by a person whose numbers scatter by a factor of 1.5."""
    random = np.random.default_rng(4)
    mine = []
    for k, stimulus in enumerate(MAGNITUDES.stimuli):
        values = 1e4 * stimulus.period**1.2 * np.exp(0.4 * random.standard_normal(4))
        mine += estimates(values.tolist(), stimulus.name, 2 + 4 * k)
    _require_one_scale("f", MAGNITUDES, "p", mine)
    spoilt = [
        (line, {**row, "estimate": str(factor * float(row["estimate"]))})
        if row["stimulus"] == NAMES[which]
        else (line, row)
        for line, row in mine
    ]
    with pytest.raises(ConfigError, match=f"gave '{NAMES[which]}'.*what the other") as found:
        _require_one_scale("f", MAGNITUDES, "p", spoilt)
    assert found.value.line == 2 + 4 * which


def test_rows_of_a_loop_for_practice_are_practice(tmp_path: Path) -> None:
    made = [
        [*row, str(k) if k < 6 else "", "" if k < 6 else str(k)] for k, row in enumerate(rows())
    ]
    path = write(tmp_path, made, f"{HEAD},practice_trials.thisN,trials.thisN")
    phases = read_answers(path, DESIGN).phase
    assert (phases == "practice").sum() == 6
    assert (phases == "main").sum() == 34


def test_times_in_two_units_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [[*row, "700"] for row in rows()], f"{HEAD},response_time_ms")
    with pytest.raises(InputError, match="keep one of the two columns"):
        read_answers(path, DESIGN)


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
