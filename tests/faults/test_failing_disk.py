"""A disk that fails at its n-th write, sync, rename or removal: it is refused, or goes on."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent


def _every(folder: Path, step: int, *jobs: str) -> None:
    compiler = next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)
    if compiler is None or sys.platform != "linux":
        pytest.skip("needs Linux and a C compiler (looked for cc, gcc, clang) for the failing disk")
    shim = folder / "failing_disk.so"
    build = [
        compiler,
        "-shared",
        "-fPIC",
        "-O1",
        "-o",
        str(shim),
        str(HERE / "failing_disk.c"),
        "-ldl",
    ]
    subprocess.run(build, check=True, capture_output=True)
    root = str(HERE.parent.parent)
    paths = os.pathsep.join([root, *sys.path])
    done = subprocess.run(
        [sys.executable, str(HERE / "failing_child.py"), str(folder), str(step), *jobs],
        env={**os.environ, "LD_PRELOAD": str(shim), "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    found = [json.loads(line) for line in done.stdout.splitlines()]
    print()
    for one in found:
        print(
            "{job:10} {kind:6} {calls:4} calls, {tried:4} failures, {refused:4} refused".format(
                **one
            )
        )
    tried = {(one["job"], one["kind"]): one for one in found}
    # The shim is met at all, by SQLite too, and a failure that nobody hears of is an exception.
    for job in jobs:
        assert tried[job, "write"]["refused"] > 0
        assert tried[job, "sync"]["refused"] > 0


@pytest.mark.slow
def test_a_disk_that_fails_at_some_of_its_calls(tmp_path: Path) -> None:
    _every(tmp_path, 41, "Answering", "Sitting", "Recording")


@pytest.mark.nightly
@pytest.mark.parametrize(
    "job", ["Creating", "Answering", "Giving", "Deleting", "Sitting", "Recording"]
)
def test_a_disk_that_fails_at_any_of_its_calls(tmp_path: Path, job: str) -> None:
    _every(tmp_path, 1, job)
