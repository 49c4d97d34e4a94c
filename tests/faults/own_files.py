"""Every kind of file that this program writes and reads again: how one is made, and used."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tests.unit.design.search.made_up import formula, requirements
from tests.unit.study.scripted import gratings, run_through

from squeezefilm.core import presets
from squeezefilm.core.formats.traces import Table, csv_text, table_from_csv
from squeezefilm.core.kept.store import CACHE_VARIABLE, Kept
from squeezefilm.design.search.evolution import Proposals
from squeezefilm.design.search.store import FILE as DESIGNS
from squeezefilm.design.search.store import DesignStore
from squeezefilm.design.sweep.points import FILE as ANSWERS
from squeezefilm.design.sweep.points import Answer, KeptAnswers, Point
from squeezefilm.design.sweep.report.terminal import compared_rows
from squeezefilm.instruments.session.record.trace import export_trace
from squeezefilm.instruments.session.record.trace_file import TraceWriter
from squeezefilm.lab.guard import Keys
from squeezefilm.lab.lan import certificate
from squeezefilm.measure.calibration.blind import (
    BlindPrediction,
    Predicted,
    load_prediction,
    sealed,
)
from squeezefilm.measure.recordings.read import check_folder
from squeezefilm.physics.display import load_display
from squeezefilm.physics.texture_files.texture_file import load_texture
from squeezefilm.study.record.deletion import delete_participant
from squeezefilm.study.record.exports import LIST, export_study
from squeezefilm.study.record.merge import merge
from squeezefilm.study.record.sittings import FILE as SITTINGS
from squeezefilm.study.record.sittings import Sittings
from squeezefilm.study.record.store import StudyStore


@dataclass(frozen=True)
class OwnFile:
    """A kind of file: its name in a folder, who makes the folder, and what reads the file."""

    name: str
    file: str
    make: Callable[[Path], object]
    use: Callable[[Path], object]


def _answers(folder: Path) -> None:
    kept = KeptAnswers(folder)
    number = len(kept)
    point = Point(load_display("biet2008-stator"), {"voltage": 20.0}, "predict")
    for place in range(number, number + 3):
        kept.add(f"address {place}", point, Answer({"a_m": 0.5}, modes={"modes": []}))


def _designs(folder: Path) -> None:
    wanted = requirements()
    proposals = Proposals(wanted, 0, "screened", 1)
    store = DesignStore(wanted, folder)
    designs = [design for _, design in proposals.ask(6, 0)]
    store.add(formula(wanted, one, "screened") for one in designs if not store.get(one, "screened"))
    assert all(store.get(one, "screened") for one in designs)


def _trace(folder: Path) -> None:
    with TraceWriter(folder / "a.sqft", ("time_s", "x_m"), {"seed": 1}) as writer:
        for begin in range(0, 90, 30):
            writer.append(np.arange(begin, begin + 60.0).reshape(30, 2))
            writer.event("break", {"after": begin})


def _tables(folder: Path) -> None:
    table = Table({"time_s": np.arange(5.0), "x_m": np.ones(5)}, {"seed": 1})
    (folder / "a.csv").write_text(csv_text(table), encoding="utf-8")


RECORDING = """\
kind = "impedance"
[columns]
frequency = { column = 1, unit = "Hz" }
magnitude = { column = 2, unit = "ohm" }
phase = { column = 3, unit = "deg" }
"""


def _recordings(folder: Path) -> None:
    for name in ("a", "b"):
        rows = "".join(f"{29e3 + 10 * k},{1e3 + k},-80\n" for k in range(40))
        (folder / f"{name}.csv").write_text("f,z,p\n" + rows, encoding="utf-8")
        (folder / f"{name}.toml").write_text(RECORDING, encoding="utf-8")


def _prediction(folder: Path) -> None:
    row = Predicted("mode_frequency", {"voltage": 1.0}, 3e4, (2.9e4, 3.1e4), 500.0)
    made = BlindPrediction("a", "drawn", (row,), {"seed": 1}, "")
    (folder / "a.json").write_text(sealed(made), encoding="utf-8")


def _sittings(folder: Path) -> None:
    fields = {"study": "s", "device": "none", "consent_text": "c"}
    made = Sittings(folder / SITTINGS).new(participant="0123456789abcdef", **fields)
    Sittings(folder / SITTINGS).change(made.id, ended=True)


def _study(folder: Path) -> None:
    run_through(folder / "a.sqlite", gratings(), 1).close()
    with StudyStore.open(folder / "a.sqlite") as store:
        export_study(store, "csv")


def _used_study(folder: Path) -> None:
    with StudyStore.open(folder / "a.sqlite") as store:
        export_study(store, "csv")
        store.enrol()


def _killed_study(folder: Path) -> None:
    """With all that was written in the log still: what a program leaves that was killed."""
    with run_through(folder.with_name("alive") / "a.sqlite", gratings(), 1) as alive:
        shutil.copytree(alive.path.parent, folder, dirs_exist_ok=True)


def _deleted(folder: Path) -> None:
    with StudyStore.open(folder / "a.sqlite") as store:
        export_study(store, "csv")
        delete_participant(store, store.enrol())


def _stations(folder: Path) -> None:
    for name in ("a", "b"):
        run_through(folder / f"{name}.sqlite", gratings(), 1).close()


def _merged(folder: Path) -> None:
    with StudyStore.open(folder / "a.sqlite") as store:
        merge(store, folder / "b.sqlite")


def _cache(folder: Path) -> None:
    before = os.environ.get(CACHE_VARIABLE)
    os.environ[CACHE_VARIABLE] = str(folder)
    try:
        kept = Kept[np.ndarray]("lines", np.ndarray)
        if (there := kept.get("a")) is not None:
            assert there.tolist() == [0, 1, 2, 3]
        kept.put("a", np.arange(4.0))
    finally:
        if before is None:
            del os.environ[CACHE_VARIABLE]
        else:
            os.environ[CACHE_VARIABLE] = before


def _keys(folder: Path) -> None:
    keys = Keys(folder / ".lab-1.keys")
    keys.use_link(keys.new_link())


SWEEP = "voltage,relative_friction\n10 V,0.8\n20 V,0.6\n"
OWN_FILES = [
    OwnFile("answers of a sweep", ANSWERS, _answers, _answers),
    OwnFile("designs of a search", DESIGNS, _designs, _designs),
    OwnFile("study", "a.sqlite", _study, _used_study),
    OwnFile("log of a study", "a.sqlite-wal", _killed_study, _used_study),
    OwnFile("list of exports", f"a.exports/{LIST}", _study, _deleted),
    OwnFile("export", "a.exports/csv/small_trials.csv", _study, _deleted),
    OwnFile("mark of an export", "a.exports/csv/.squeezefilm-export.json", _study, _deleted),
    OwnFile("sittings", SITTINGS, _sittings, _sittings),
    OwnFile("another station's study", "b.sqlite", _stations, _merged),
    OwnFile("kept result", "lines/*", _cache, _cache),
    OwnFile(
        "trace", "a.sqft", _trace,
        lambda folder: export_trace(folder / "a.sqft", folder / "out.csv"),
    ),
    OwnFile("table", "a.csv", _tables, lambda folder: table_from_csv(folder / "a.csv")),
    OwnFile("recording", "a.csv", _recordings, check_folder),
    OwnFile("description", "a.toml", _recordings, check_folder),
    OwnFile(
        "sealed prediction", "a.json", _prediction,
        lambda folder: load_prediction(folder / "a.json"),
    ),
    OwnFile("keys of the lab", ".lab-1.keys", _keys, _keys),
    OwnFile(
        "certificate of the lab", "a.pem",
        lambda folder: certificate("192.168.1.2", folder / "a.pem"),
        lambda folder: certificate("192.168.1.2", folder / "a.pem"),
    ),
    OwnFile(
        "table of a sweep", "sweep.csv",
        lambda folder: (folder / "sweep.csv").write_text(SWEEP, encoding="utf-8"),
        lambda folder: compared_rows(folder, "1,2"),
    ),
    OwnFile(
        "display", "a.toml",
        lambda folder: (folder / "a.toml").write_bytes(
            presets.path("biet2008-stator").read_bytes()
        ),
        lambda folder: load_display(folder / "a.toml"),
    ),
    OwnFile(
        "texture", "a.toml",
        lambda folder: (folder / "a.toml").write_bytes(
            presets.resolve("sine-3mm", "texture").read_bytes()
        ),
        lambda folder: load_texture(folder / "a.toml"),
    ),
]  # fmt: skip
"""Every kind; the file's name may be a pattern."""
