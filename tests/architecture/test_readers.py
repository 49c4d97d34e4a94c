"""Files are read by `regular_file` and not otherwise, but for what stands here with its reason."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import squeezefilm

SOURCE = Path(squeezefilm.__file__).parent

OPENING = {
    "open", "read_text", "read_bytes", "connect", "loadmat", "loadtxt", "genfromtxt", "fromfile",
    "memmap", "mmap", "UFF", "ZipFile", "file_digest", "load", "loads",
}  # fmt: skip
"""Functions and methods that open a file or take apart what was in one, by their last name."""

LOADING = {"json", "pickle", "np", "numpy", "tomllib", "marshal", "plistlib"}
"""Modules whose `load` and `loads` read; other objects have methods of these names."""

PACKAGE = "a file of this package"
ROW = "a cell of a study's database, whose rows `require_whole` has looked at"
TOML = "TOML text, after `require_quick_toml` or of this package"
WRITES = "opened to write"
CHILD = "in the child process of `isolated_reading`"

ALLOWED: Mapping[str, Mapping[str, str]] = {
    "core/regular_file.py": {"os.open": "the reader itself", "json.loads": "the reader itself"},
    "core/isolated_reading.py": {
        "open": "the pipe of its parent",
        "json.loads": "answers of a child that may be taken over",
        "pickle.load": "requests of the process that started it, by a pipe of its own",
    },
    "core/kept/store.py": {"json.loads": "what `read_regular` read; any error counts as not there"},
    "physics/contact/sharing/gas_table.py": {"np.load": PACKAGE},
    "core/kept/computed_by.py": {"open": "the package's source"},
    "measure/recordings/files/scipy_files.py": {"loadmat": CHILD},
    "measure/recordings/files/universal.py": {"pyuff.UFF": CHILD},
    "measure/recordings/files/raw_table.py": {"read_text": PACKAGE, "tomllib.loads": TOML},
    "measure/recordings/description.py": {"tomllib.loads": TOML},
    "physics/texture_files/image_file.py": {"Pillow.open": CHILD},
    "design/plate/report/page.py": {"read_bytes": "a draft in a folder of its own"},
    "study/report/terminal.py": {"path.open": WRITES},
    "instruments/session/record/trace.py": {"mmap.mmap": "over the descriptor that `opened` gave"},
    "instruments/session/record/trace_file.py": {"os.open": WRITES},
    "instruments/session/loop/process.py": {"mmap.mmap": "memory shared with its own child"},
    "instruments/session/loop/worker.py": {
        "mmap.mmap": "memory shared with its parent",
        "pickle.load": "orders of its parent, by a pipe",
    },
    "design/sweep/points.py": {"place.open": WRITES, "open": WRITES},
    "design/sweep/answers.py": {"read_text": PACKAGE, "tomllib.loads": TOML},
    "instruments/twin/plant.py": {"file.open": WRITES},
    "instruments/twin/pty_server.py": {"os.open": "a terminal of its own"},
    "core/results.py": {"os.open": WRITES},
    "lab/files.py": {"os.open": WRITES, "zipfile.ZipFile": "written, in memory"},
    "lab/designing/form.py": {"read_text": PACKAGE, "tomllib.loads": TOML},
    "lab/search_process.py": {"tomllib.loads": TOML},
    "lab/wire.py": {"json.loads": "a message of a page, of limited length"},
    "lab/serve.py": {"webbrowser.open": "no file"},
    "core/presets/materials.py": {"read_text": PACKAGE, "tomllib.loads": TOML},
    "physics/display.py": {"read_text": PACKAGE},
    "physics/plausibility/checks.py": {"read_text": PACKAGE, "tomllib.loads": TOML},
    "instruments/bench/timing_checks.py": {"read_text": "/proc, of the kernel"},
    "core/config/load.py": {"tomllib.loads": TOML},
    "actuators/described.py": {"tomllib.loads": TOML},
    "cli/__init__.py": {"os.open": "/dev/null, to write"},
    "study/design/trials.py": {"json.loads": ROW},
    "study/record/tables.py": {"json.loads": ROW},
    "study/record/merge.py": {"json.loads": ROW},
    "study/record/deletion.py": {"json.loads": ROW},
    "study/record/schema.py": {"json.loads": ROW, "sqlite3.connect": "in memory"},
    "study/record/store.py": {"json.loads": ROW},
    "study/record/erasure.py": {"os.open": "plain files only, of one name and no link"},
    "study/record/sittings.py": {"os.open": "a folder, to lock or sync it"},
    "study/record/database.py": {
        "os.open": "made anew, and refused where something is",
        "sqlite3.connect": "after `require_regular`: another opening would drop SQLite's locks",
    },
}
"""By module: each call that opens a file in its own way, and why it may."""

_CALLED = re.compile(rf"\b(?:{'|'.join(sorted(OPENING))})\s*\(")
"""A file without one of these has no such call, and need not be parsed."""

OTHER_OBJECTS = {"StudyStore.open", "host.open", "self.open", "lab.open"}
"""Methods of these names that open no file themselves."""


def openings(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Calls that may read a file: their name as it is written, short, and their line."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        called = node.func
        last = getattr(called, "attr", getattr(called, "id", ""))
        if last not in OPENING or (name := ast.unparse(called)) in OTHER_OBJECTS:
            continue
        if last in ("load", "loads") and name.rpartition(".")[0] not in LOADING:
            continue
        if last == "connect" and not name.startswith("sqlite3"):
            continue
        yield name, node.lineno


def test_nothing_else_opens_files_for_reading() -> None:
    unknown, used = [], set()
    for path in sorted(SOURCE.rglob("*.py")):
        place = path.relative_to(SOURCE).as_posix()
        allowed = ALLOWED.get(place, {})
        source = path.read_text(encoding="utf-8")
        for name, line in openings(ast.parse(source)) if _CALLED.search(source) else ():
            short = name.rpartition(".")[2]
            key = name if name in allowed else short
            if key in allowed:
                used.add((place, key))
            else:
                unknown.append(f"{place}:{line}: {name}")
    assert unknown == [], "read files with squeezefilm.core.regular_file, or give the reason here"
    stale = {(place, key) for place, keys in ALLOWED.items() for key in keys} - used
    assert stale == set(), "nothing there opens a file in this way any more"


def test_an_opening_is_found_however_it_is_written() -> None:
    code = "open(p)\np.open()\nPath(p).read_text()\nnp.load(p)\njson.load(f)\nsqlite3.connect(p)"
    assert [line for _, line in openings(ast.parse(code))] == [1, 2, 3, 4, 5, 6]


def test_files_are_written_whole_by_one_function() -> None:
    """`write_whole` leaves nothing cut behind; these write to a folder or a record of their own."""
    own = {"instruments/bench/play.py"}
    writers = set()
    for path in SOURCE.rglob("*.py"):
        source = path.read_text(encoding="utf-8")
        if "write_text" not in source and "write_bytes" not in source:
            continue
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.Attribute) and node.attr in ("write_text", "write_bytes"):
                writers.add(path.relative_to(SOURCE).as_posix())
    assert writers == own
