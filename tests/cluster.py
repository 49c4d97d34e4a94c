"""A Dask scheduler and workers as processes of their own on this machine, to be killed by tests."""

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_PATIENCE = 60.0


def _started(folder: Path, name: str, *arguments: str) -> subprocess.Popen[bytes]:
    """A `dask` command in a session of its own, its words in a file."""
    path = os.pathsep.join([str(ROOT / "src"), str(ROOT)])
    with (folder / name).open("wb") as said:
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *arguments],
            stdout=said, stderr=subprocess.STDOUT, cwd=folder, start_new_session=True,
            env=os.environ | {"PYTHONPATH": path},
        )  # fmt: skip


def _said(file: Path, pattern: str) -> str:
    """What a process says in its file once it is ready."""
    ends = time.monotonic() + _PATIENCE
    while time.monotonic() < ends:
        if found := re.search(pattern, file.read_text(errors="replace")):
            return found[1]
        time.sleep(0.05)
    raise AssertionError(f"{file.name} said only: {file.read_text(errors='replace')}")


def killed(process: subprocess.Popen[bytes]) -> None:
    """SIGKILL to a process and all that it began."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@dataclass
class LocalCluster:
    """Its processes, in a folder of theirs."""

    folder: Path
    scheduler: subprocess.Popen[bytes] | None = None
    address: str = ""
    workers: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def start_scheduler(self, *options: str) -> None:
        """A scheduler at a free port, or at the port of the one before."""
        port = self.address.rpartition(":")[2] or "0"
        self.scheduler = _started(
            self.folder, "scheduler", "scheduler", "--host", "127.0.0.1", "--port", port,
            "--no-dashboard", "--no-show", *options,
        )  # fmt: skip
        self.address = _said(self.folder / "scheduler", r"Scheduler at:\s+(tcp://[\d.:]+)")

    def start_workers(self, count: int, threads: int = 1, nanny: bool = False) -> None:
        """So many workers, each a process of its own; a nanny starts one that died again."""
        begun = range(len(self.workers), len(self.workers) + count)
        options = ("--nanny" if nanny else "--no-nanny", "--nthreads", str(threads))
        places = ("--host", "127.0.0.1", "--local-directory", str(self.folder), "--no-dashboard")
        for number in begun:
            name = f"worker-{number}"
            process = _started(self.folder, name, "worker", self.address, *options, *places)
            self.workers.append(process)
        for number in begun:
            _said(self.folder / f"worker-{number}", r"(Registered to):")

    def kill_scheduler(self) -> None:
        """SIGKILL to the scheduler; its workers end by themselves."""
        assert self.scheduler is not None
        killed(self.scheduler)


@contextmanager
def local_cluster(workers: int = 2) -> Iterator[LocalCluster]:
    """A scheduler with workers, for the block."""
    with tempfile.TemporaryDirectory() as folder:
        cluster = LocalCluster(Path(folder))
        try:
            cluster.start_scheduler()
            cluster.start_workers(workers)
            yield cluster
        finally:
            for process in (*cluster.workers, cluster.scheduler):
                if process is not None:
                    killed(process)
