"""What a record takes, and what an export makes of it."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from tests.unit.core.formats.read_parquet import table_in_parquet
from typer.testing import CliRunner

from squeezefilm.cli import app
from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import table_from_csv
from squeezefilm.core.results import stamp
from squeezefilm.instruments.session.record import trace_file
from squeezefilm.instruments.session.record.trace import export_trace, read_trace
from squeezefilm.instruments.session.record.trace_file import TraceWriter

COLUMNS = ("time_s", "x_m")


def recorded(path: Path) -> np.ndarray:
    rows = np.random.default_rng(1).normal(size=(500, 2))
    rows[3, 1] = np.nan
    with TraceWriter(path, COLUMNS, {**stamp({"display": "one"}, 4), "texture": "sine"}) as writer:
        writer.append(rows[:200])
        writer.event("fault", {"name": "watchdog", "time_s": float("nan")})
        writer.append(rows[200:])
    return rows


def test_rows_longer_than_a_block_are_cut_into_several(tmp_path: Path) -> None:
    rows = np.random.default_rng(1).normal(size=(200_000, 2))
    with TraceWriter(tmp_path / "long.sqft", COLUMNS, {}) as writer:
        assert writer.append(rows) == 200_000
        assert writer.append(np.empty((0, 2))) == 200_000
    np.testing.assert_array_equal(read_trace(tmp_path / "long.sqft").rows, rows)


def test_what_is_on_the_disk_is_known(tmp_path: Path) -> None:
    writer = TraceWriter(tmp_path / "one.sqft", COLUMNS, {})
    writer.append(np.zeros((5, 2)))
    assert (writer.acknowledged, writer.synced) == (5, 0)
    writer.sync()
    assert writer.synced == 5
    writer.close()
    writer.close()
    with pytest.raises(InputError, match="closed"):
        writer.append(np.zeros((5, 2)))


@pytest.mark.parametrize("rows", [np.zeros(2), np.zeros((3, 3)), np.zeros((1, 1, 2))])
def test_rows_of_another_shape_are_refused(tmp_path: Path, rows: np.ndarray) -> None:
    with TraceWriter(tmp_path / "one.sqft", COLUMNS, {}) as writer:
        with pytest.raises(InputError, match="rows of shape"):
            writer.append(rows)
        assert writer.acknowledged == 0


def test_what_has_no_json_form_is_refused_before_it_is_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="JSON"):
        TraceWriter(tmp_path / "one.sqft", COLUMNS, {"what": object()})
    assert not (tmp_path / "one.sqft").exists()
    with pytest.raises(InputError, match="no table"):
        TraceWriter(tmp_path / "one.sqft", ("x_m", "x_m"), {})
    writer = TraceWriter(tmp_path / "one.sqft", COLUMNS, {})
    with pytest.raises(InputError, match="one block holds"):
        writer.event("large", {"text": "x" * 2_000_000})
    writer.close()


def test_an_error_inside_keeps_the_record_and_is_what_is_seen(tmp_path: Path) -> None:
    def fail() -> None:
        with TraceWriter(tmp_path / "one.sqft", COLUMNS, {}) as writer:
            writer.append(np.zeros((5, 2)))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert read_trace(tmp_path / "one.sqft").damage.whole


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_an_export_reads_back_as_the_trace(tmp_path: Path, ending: str) -> None:
    rows = recorded(tmp_path / "one.sqft")
    done = export_trace(tmp_path / "one.sqft", tmp_path / f"one.{ending}")
    assert (done.rows, done.events, done.not_finite, done.closed) == (500, 1, 1, True)
    file = tmp_path / f"one.{ending}"
    table = table_from_csv(file) if ending == "csv" else table_in_parquet(file.read_bytes())
    assert tuple(table.columns) == COLUMNS
    np.testing.assert_array_equal(np.column_stack(list(table.columns.values())), rows)
    assert table.metadata["seed"] == 4
    assert table.metadata["events"][0] == {
        "kind": "fault",
        "row": 200,
        "fields": {"name": "watchdog", "time_s": None},
    }


def test_infinities_are_counted_where_no_table_keeps_them(tmp_path: Path) -> None:
    with TraceWriter(tmp_path / "one.sqft", COLUMNS, {}) as writer:
        writer.append(np.array([[0.0, np.inf], [1.0, 2.0]]))
    export_trace(tmp_path / "one.sqft", tmp_path / "one.csv")
    table = table_from_csv(tmp_path / "one.csv")
    assert table.metadata["infinities"] == 1
    assert np.isnan(table.column("x_m")[0])


def test_an_export_refuses_what_it_cannot_do(tmp_path: Path) -> None:
    recorded(tmp_path / "one.sqft")
    with pytest.raises(InputError, match=r"neither \.csv nor \.parquet"):
        export_trace(tmp_path / "one.sqft", tmp_path / "one.xlsx")
    (tmp_path / "none.csv").write_text("nothing")
    with pytest.raises(InputError, match="no block of the trace is whole"):
        export_trace(tmp_path / "none.csv", tmp_path / "two.csv")
    with pytest.raises(InputError, match="is the trace itself"):
        export_trace(tmp_path / "none.csv", tmp_path / "none.csv")


def test_the_verb_says_what_was_lost(tmp_path: Path) -> None:
    recorded(tmp_path / "one.sqft")
    data = (tmp_path / "one.sqft").read_bytes()
    (tmp_path / "cut.sqft").write_bytes(data[:-200])
    done = CliRunner().invoke(
        app, ["export", str(tmp_path / "cut.sqft"), "--to", str(tmp_path / "cut.csv")]
    )
    assert done.exit_code == 0, done.output
    assert "was not closed" in done.output


def test_rows_come_onto_the_disk_by_themselves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import time

    monkeypatch.setattr(trace_file, "SYNC_PERIOD", 1e-6)
    writer = TraceWriter(tmp_path / "one.sqft", COLUMNS, {})
    writer.append(np.zeros((5, 2)))
    end = time.monotonic() + 60.0
    while writer.synced < 5 and time.monotonic() < end:
        time.sleep(1e-3)
    assert writer.synced == 5
    writer.close()


def test_what_the_disk_refuses_later_is_told_at_the_next_call(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from squeezefilm.core.errors import RecordError
    from squeezefilm.instruments.session.record import trace as record

    writer = TraceWriter(tmp_path / "one.sqft", COLUMNS, {})

    def refuse(_: int) -> None:
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(record.os, "fsync", refuse)
    writer.append(np.zeros((5, 2)))
    with pytest.raises(RecordError, match="Input/output error"):
        writer.sync()
    assert (writer.acknowledged, writer.synced) == (5, 0)
    monkeypatch.undo()
    writer.close()
    assert read_trace(tmp_path / "one.sqft").damage.whole


def test_what_a_sync_failed_on_no_later_one_answers_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from squeezefilm.core.errors import RecordError
    from squeezefilm.instruments.session.record import trace as record

    def refuse(_: int) -> None:
        raise OSError(5, "Input/output error")

    with TraceWriter(tmp_path / "one.sqft", COLUMNS, {}) as writer:
        writer.append(np.zeros((5, 2)))
        writer.sync()
        writer.append(np.zeros((5, 2)))
        with monkeypatch.context() as patched:
            patched.setattr(record.os, "fsync", refuse)
            with pytest.raises(RecordError, match="Input/output error"):
                writer.sync()
        # The system forgets pages that it could not write: a sync that works says nothing of them.
        writer.append(np.zeros((5, 2)))
        writer.sync()
        assert (writer.acknowledged, writer.synced) == (15, 5)


def test_a_record_that_could_not_begin_leaves_its_name_free(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from squeezefilm.core.errors import RecordError
    from squeezefilm.instruments.session.record import trace as record

    def refuse(_: int) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(record.os, "fsync", refuse)
        with pytest.raises(RecordError, match="No space left"):
            TraceWriter(tmp_path / "one.sqft", COLUMNS, {})
    assert list(tmp_path.iterdir()) == []
    TraceWriter(tmp_path / "one.sqft", COLUMNS, {}).close()


def test_a_block_without_rows_names_no_columns(tmp_path: Path) -> None:
    """Four billion columns of which there is no row, and no metadata that name them."""
    path = tmp_path / "one.sqft"
    block = trace_file.block_bytes(trace_file.BlockKind.ROWS, 0, b"\xff\xff\xff\xff")
    path.write_bytes(trace_file.file_header() + block)
    found = read_trace(path)
    assert found.columns == ()
    assert "1 blocks are whole but say nothing" in " ".join(found.damage.sentences)


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("there are no pipes in folders here")
    os.mkfifo(tmp_path / "pipe.sqft")
    with pytest.raises(InputError, match="no regular file"):
        read_trace(tmp_path / "pipe.sqft")


@pytest.mark.slow
def test_an_export_of_a_sparse_file_says_how_far_it_is(tmp_path: Path) -> None:
    """A hole of 300 MB between two blocks, as a copy leaves one, is read through with a word."""
    rows = recorded(tmp_path / "one.sqft")
    whole = (tmp_path / "one.sqft").read_bytes()
    with (tmp_path / "one.sqft").open("rb+") as trace:
        trace.seek(300_000_000)
        trace.write(whole)
    said: list[str] = []
    done = export_trace(tmp_path / "one.sqft", tmp_path / "one.csv", said.append)
    assert done.rows >= len(rows)
    assert done.damage
    shares = [int(text.split("(")[1].split(" %")[0]) for text in said if " %" in text]
    assert len(shares) >= 2
    assert shares == sorted(set(shares))
    assert all("reading the trace, 0.3 GB" in text for text in said[:-1])
    assert said[-1] == f"writing {done.rows} rows"


def test_a_record_that_cannot_be_written_names_its_place(tmp_path: Path) -> None:
    from squeezefilm.core.errors import RecordError

    (tmp_path / "file").write_text("precious")
    with pytest.raises(RecordError, match=r"cannot write .*one\.sqft: .*; choose another folder"):
        TraceWriter(tmp_path / "file" / "one.sqft", COLUMNS, {})
    assert (tmp_path / "file").read_text() == "precious"


def test_a_name_that_the_disk_did_not_confirm_is_a_record_that_did_not_begin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from squeezefilm.core.errors import RecordError
    from squeezefilm.instruments.session.record import trace_file

    def refuse(_: Path) -> None:
        raise OSError(5, "Input/output error")

    with monkeypatch.context() as patched:
        patched.setattr(trace_file, "sync_folder", refuse)
        with pytest.raises(RecordError, match="Input/output error"):
            TraceWriter(tmp_path / "one.sqft", COLUMNS, {})
    assert list(tmp_path.iterdir()) == []
