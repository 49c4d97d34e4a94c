"""Reading of files by C code in a child process, so that a damaged file ends the child only.

MATLAB files, Universal Files and pictures are taken apart by libraries that a changed byte can
crash or make unpack to gigabytes. A child reads them, with limits of memory and of processor time
where the system has them (POSIX; macOS keeps none of memory) and of elapsed time everywhere. What
it read comes back as JSON and arrays of floats, never as pickled objects: a file that takes the
child over gets no further. One child reads many files, and another is started after a crash: a
start costs about half a second, once a process. It is no process of `multiprocessing`, which would
load the caller's program again.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.hard_limits import READING_MEMORY, READING_TIME

Read = tuple[Any, list[si.FloatArray]]
"""Result of a function in the child: facts (anything that JSON holds), and arrays."""

_PATIENCE: si.Second = 4 * READING_TIME.most
"""Longest wall-clock time for one file."""
_LEAVE: si.Second = 2.0
_FLOATS = np.dtype("<f8")
_LONGEST_HEAD = 16_000_000


class IsolatedReader:
    """A child process that reads files, started when the first is read."""

    def __init__(self) -> None:
        self._turn = threading.Lock()
        # By this process: a fork of it must not talk with the child of its parent.
        self._children: dict[int, subprocess.Popen[bytes]] = {}

    def read(
        self,
        function: Callable[..., Read],
        *arguments: str | float | None,
        data: bytes = b"",
        file: str | Path,
    ) -> Read:
        """The result of a function of a module for `data` and `arguments`, called in the child.

        `file` is what messages name. Raises `ConfigError`: what the function raises of this kind,
        and where the child crashed or reached a limit.
        """
        request = pickle.dumps((function, (data, *arguments), READING_TIME.most))
        with self._turn:
            child = self._started()
            assert child.stdin is not None
            assert child.stdout is not None
            overdue = threading.Event()
            watch = threading.Timer(_PATIENCE, _end_late, (child, overdue))
            watch.start()
            try:
                child.stdin.write(request)
                child.stdin.flush()
                facts, arrays, refused = _received(child.stdout)
            except (OSError, EOFError, ValueError, LookupError, RecursionError) as error:
                self.end()
                raise ConfigError(self._why(child, overdue.is_set()), file=file) from error
            finally:
                watch.cancel()
        if refused is not None:
            raise ConfigError(**{"file": str(file), **refused})
        return facts, arrays

    def end(self) -> None:
        """Let the child go; another is started for the next file."""
        child = self._children.pop(os.getpid(), None)
        if child is None:
            return
        assert child.stdin is not None
        assert child.stdout is not None
        with contextlib.suppress(OSError):
            child.stdin.close()
        try:
            child.wait(_LEAVE)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
        child.stdout.close()

    def _started(self) -> subprocess.Popen[bytes]:
        """The child of this process, alive."""
        child = self._children.get(os.getpid())
        if child is not None and child.poll() is None:
            return child
        self.end()
        # Where this process finds its modules, and never the folder it is in.
        paths = os.pathsep.join(path for path in sys.path if path)
        threads = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}
        child = subprocess.Popen(
            [sys.executable, "-P", "-m", __name__, str(int(READING_MEMORY.most))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, **threads, "PYTHONPATH": paths},
            # Ctrl-C is for the process that waits; this one ends with it.
            start_new_session=True,
        )
        self._children[os.getpid()] = child
        return child

    def _why(self, child: subprocess.Popen[bytes], is_late: bool) -> str:
        """The reason why a child ended without an answer, and what to do."""
        time_ran_out = is_late or -child.returncode == getattr(signal, "SIGXCPU", None)
        if time_ran_out:
            allowed = si.format_quantity(READING_TIME.most, si.Unit("s"))
            return (
                f"cannot be read: reading it takes more than {allowed} ({READING_TIME.name}: "
                f"{READING_TIME.reason}); export it again with less data"
            )
        code = -child.returncode
        name = signal.Signals(code).name if code in set(signal.Signals) else f"code {-code}"
        return (
            f"cannot be read: the process that read it crashed ({name}), as it does on damaged "
            "files; nothing else was lost. Export it again, or save its table as CSV"
        )


def _end_late(child: subprocess.Popen[bytes], overdue: threading.Event) -> None:
    overdue.set()
    child.kill()


def _received(answers: IO[bytes]) -> tuple[Any, list[si.FloatArray], dict[str, Any] | None]:
    """Facts, arrays and refusal that a child sent. Raises `ValueError` for what is no answer."""
    head = json.loads(answers.readline(_LONGEST_HEAD))
    arrays = []
    for shape in head["shapes"]:
        size = int(np.prod(shape)) * _FLOATS.itemsize
        if not 0 <= size <= READING_MEMORY.most:
            raise ValueError(f"an array of {size} bytes")
        content = answers.read(size)
        arrays.append(np.frombuffer(content, _FLOATS).astype(float).reshape(shape))
    return head["facts"], arrays, head["refused"]


_READER = IsolatedReader()
atexit.register(_READER.end)

read_isolated = _READER.read
"""`IsolatedReader.read` of the child that all of this process shares."""


def _serve(requests: IO[bytes], answers: IO[bytes]) -> None:
    """Answer requests until there are no more: what the child does."""
    with contextlib.suppress(EOFError):
        while True:
            function, arguments, seconds = pickle.load(requests)
            _limit_processor_time(seconds)
            facts, arrays, refused = _answer(function, arguments)
            shapes = [array.shape for array in arrays]
            head = {"facts": facts, "shapes": shapes, "refused": refused}
            answers.write(json.dumps(head).encode() + b"\n")
            answers.writelines(array.tobytes() for array in arrays)
            answers.flush()


def _answer(
    function: Callable[..., Read], arguments: tuple[Any, ...]
) -> tuple[Any, list[si.FloatArray], dict[str, Any] | None]:
    """The result of a function, or what a `ConfigError` says in its place."""
    try:
        facts, arrays = function(*arguments)
        return facts, [np.ascontiguousarray(array, _FLOATS) for array in arrays], None
    except ConfigError as error:
        said = {key: getattr(error, key) for key in ("message", "file", "line", "column", "key")}
        refused = {key: value for key, value in said.items() if value is not None}
    except InputError as error:
        refused = {"message": str(error)}
    except MemoryError:
        allowed = f"{READING_MEMORY.most / 1e9:g} GB ({READING_MEMORY.name}"
        refused = {
            "message": f"cannot be read: reading it takes more than {allowed}: "
            f"{READING_MEMORY.reason}); export it again with less data"
        }
    return None, [], refused


def _limit_processor_time(seconds: si.Second) -> None:
    """End this process where it works so much longer (POSIX)."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
        ends = int(time.process_time() + seconds) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (ends, hard))


def _limit_memory(most: int) -> None:
    """Give this process no more address space, and leave no picture of it where it crashes."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))


def _main() -> None:
    # What a library prints must not come between answers.
    answers = os.dup(1)
    os.dup2(2, 1)
    _limit_memory(int(sys.argv[1]))
    with os.fdopen(answers, "wb") as out, open(0, "rb", closefd=False) as requests:
        _serve(requests, out)


if __name__ == "__main__":
    _main()
