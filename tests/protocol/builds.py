"""The firmware in C, built for this computer: as a library, and as a program under sanitizers."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from pathlib import Path
from typing import NoReturn

import pytest

from .recording import Recording

SOURCES = Path(__file__).parents[2] / "firmware"
LOOPS_IN_TICK = (SOURCES / "squeezefilm_held.c", SOURCES / "squeezefilm_loops.c")
FIRMWARE = (SOURCES / "squeezefilm_fw.c", SOURCES / "host_harness.c", *LOOPS_IN_TICK)
LOOPS = (SOURCES / "squeezefilm_loops.c", SOURCES / "loops_main.c")
STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror")


def missing(what: str) -> NoReturn:
    """Skip, with the reason; but fail where CI=true."""
    if os.environ.get("CI") == "true":
        pytest.fail(f"CI=true must not skip this: {what}")
    pytest.skip(what)


def tool(*names: str) -> str:
    """The path of the first of these programs that is installed."""
    path = next((path for name in names if (path := shutil.which(name))), None)
    return path or missing(f"no {' or '.join(names)} found, to build the firmware; install one")


def build(compiler: str, flags: tuple[str, ...], sources: tuple[Path, ...], built: Path) -> Path:
    """Compile and link; what the compiler says is the failure."""
    command = [compiler, *flags, *map(str, sources), "-o", str(built)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return built


class Library:
    """The firmware as a library of this process."""

    def __init__(self, folder: Path) -> None:
        flags = (*STRICT, "-O2", "-shared", "-fPIC")
        built = build(tool("cc", "gcc", "clang"), flags, FIRMWARE, folder / "firmware.so")
        self.functions = ctypes.CDLL(str(built))
        self.functions.sf_crc32.restype = ctypes.c_uint32
        self.functions.sf_cobs_encode.restype = ctypes.c_size_t
        self.functions.host_run.restype = ctypes.c_size_t

    def record(self, recording: Recording) -> bytes:
        """What it did."""
        room = ctypes.create_string_buffer(len(recording.record) + 1)
        script = bytes(recording.script)
        size = ctypes.c_size_t
        count = self.functions.host_run(script, size(len(script)), room, size(len(room)))
        assert count <= len(room), (count, len(recording.record))
        return room.raw[:count]


class Sanitized:
    """The firmware as a program that ends at the first thing that C leaves undefined."""

    def __init__(self, folder: Path) -> None:
        flags = (
            *STRICT,
            "-g",
            "-O1",
            "-fsanitize=address,undefined",
            "-fno-sanitize-recover=all",
            "-fno-omit-frame-pointer",
        )
        sources = (*FIRMWARE, SOURCES / "script_main.c")
        self._program = build(tool("cc", "gcc", "clang"), flags, sources, folder / "sanitized")

    def record(self, recording: Recording) -> bytes:
        """What it did; a sanitizer's words are the failure."""
        # It allocates nothing, and looking for leaks needs rights that a container may not give.
        environment = os.environ | {"ASAN_OPTIONS": "detect_leaks=0"}
        done = subprocess.run(
            [self._program],
            input=bytes(recording.script),
            capture_output=True,
            check=False,
            env=environment,
        )
        assert done.returncode == 0, done.stderr.decode(errors="replace")
        return done.stdout
