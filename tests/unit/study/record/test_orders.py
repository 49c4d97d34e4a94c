"""Order files for other programs hold the plan, row for row."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.design.plan import plan_study
from squeezefilm.study.record.exports import ORDER_COLUMNS, write_orders


@pytest.mark.parametrize("name", ["biet2008-gratings", "period-jnd", "coarseness-magnitude"])
def test_every_trial_is_a_row(name: str, tmp_path: Path) -> None:
    plan = plan_study(name, 2, 5)
    files = write_orders(plan, tmp_path / "orders")
    assert len(files) == 4
    for number, schedule in enumerate(plan.schedules):
        with (tmp_path / "orders" / f"order-{number:03d}.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        assert list(rows[0]) == [
            column.name
            for column in ORDER_COLUMNS
            if not column.name.startswith(("fourth_", "fifth_"))
        ]
        assert [int(row["trial"]) for row in rows] == [one.number for one in schedule]
        for row, trial in zip(rows, schedule, strict=True):
            assert row["answer"] == trial.answer
            named = tuple(x for x in (row["stimulus"], row["second_stimulus"]) if x)
            assert named == trial.stimuli
        data = json.loads((tmp_path / "orders" / f"order-{number:03d}.json").read_text())
        assert len(data) == len(schedule)


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("")
    with pytest.raises(InputError, match="is a file"):
        write_orders(plan_study("period-jnd"), tmp_path / "a")
