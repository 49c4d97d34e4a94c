"""Files that crash their reader, or would take all memory or for ever: each is told, no other is
lost, and the process that asked goes on."""

from __future__ import annotations

import dataclasses
import io
import json
import os
import pickle
import random
import re
import signal
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from tests.pictures import picture_bytes

from squeezefilm.core import isolated_reading
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.isolated_reading import IsolatedReader, Read, _received, _serve
from squeezefilm.measure.recordings.files.scipy_files import read_matlab
from squeezefilm.measure.recordings.read import check_folder
from squeezefilm.physics.texture_files.image_file import picture_from

DESCRIPTION = """\
kind = "frequency response"
voltage = { amplitude = "0.3 V", given_as = "zero-to-peak" }
[columns]
frequency = { column = "f", unit = "Hz" }
displacement = { column = "h", unit = "nm/V" }
displacement_imaginary = { column = "h", unit = "nm/V" }
"""
F = np.linspace(29e3, 31e3, 41)


def doubled(data: bytes, factor: float) -> Read:
    """In the child: facts and an array."""
    return {"pid": os.getpid(), "size": len(data)}, [factor * np.arange(3.0), np.ones((2, 2))]


def crashing(_: bytes) -> Read:
    """In the child: what C code does on a damaged file."""
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def endless(_: bytes) -> Read:
    """In the child: a reader that goes in a circle."""
    while True:
        pass


def waiting(_: bytes) -> Read:
    """In the child: a reader that waits for what does not come."""
    signal.pause()
    raise AssertionError


def unpacking(_: bytes, size: int) -> Read:
    """In the child: a file that unpacks to so many bytes."""
    return None, [np.ones(size // 8)]


def refusing(_: bytes) -> Read:
    """In the child: a file whose fault is known."""
    raise ConfigError("holds no numbers", line=3, column=2)


def talking(_: bytes) -> Read:
    """In the child: a library that prints."""
    os.write(1, b"not an answer\n")
    print("nor this")
    return None, []


def saved(**variables: Any) -> bytes:
    stream = io.BytesIO()
    savemat(stream, variables)
    return stream.getvalue()


@pytest.mark.slow
def test_one_child_reads_many_files() -> None:
    reader = IsolatedReader()
    facts, (line, square) = reader.read(doubled, 2.0, data=b"abc", file="a")
    assert facts["size"] == 3
    assert facts["pid"] != os.getpid()
    assert line.tolist() == [0.0, 2.0, 4.0]
    assert square.shape == (2, 2)
    assert reader.read(doubled, 1.0, file="b")[0]["pid"] == facts["pid"]
    assert reader.read(talking, file="c") == (None, [])
    reader.end()


def overfull(_: bytes) -> Read:
    """In the child: more than there is memory for."""
    raise MemoryError


def unfit(_: bytes) -> Read:
    """In the child: what a table refuses."""
    raise InputError("two columns are alike")


@pytest.mark.parametrize(
    ("function", "refused"),
    [
        (refusing, {"message": "holds no numbers", "line": 3, "column": 2}),
        (unfit, {"message": "two columns are alike"}),
    ],
)
def test_a_child_answers_one_request_after_another(
    monkeypatch: pytest.MonkeyPatch, function: Any, refused: dict[str, Any]
) -> None:
    limits: list[float] = []
    monkeypatch.setattr(isolated_reading, "_limit_processor_time", limits.append)
    asked = ((doubled, (b"abc", 2.0), 7.0), (function, (b"",), 5.0), (doubled, (b"", 3.0), 6.0))
    answers = io.BytesIO()
    _serve(io.BytesIO(b"".join(pickle.dumps(request) for request in asked)), answers)
    assert limits == [7.0, 5.0, 6.0]
    answers.seek(0)
    facts, (line, square), no = _received(answers)
    assert (facts["size"], no) == (3, None)
    np.testing.assert_array_equal(line, [0.0, 2.0, 4.0])
    np.testing.assert_array_equal(square, np.ones((2, 2)))
    assert _received(answers) == (None, [], refused)
    assert _received(answers)[1][0][-1] == 6.0
    assert not answers.read()


def test_more_than_memory_holds_is_refused_in_words() -> None:
    facts, arrays, refused = isolated_reading._answer(overfull, (b"",))
    assert (facts, arrays) == (None, [])
    assert refused is not None
    assert refused["message"].startswith("cannot be read: reading it takes more than ")


@pytest.mark.parametrize("shape", [[-1], [2**40]])
def test_what_a_child_sends_must_be_an_answer(shape: list[int]) -> None:
    head = {"facts": None, "shapes": [shape], "refused": None}
    with pytest.raises(ValueError, match="an array of"):
        _received(io.BytesIO(json.dumps(head).encode() + b"\n"))


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize(
    ("code", "late", "reason"),
    [
        (-signal.SIGKILL, True, r"takes more than 2 s"),
        (-signal.SIGXCPU, False, r"takes more than 2 s"),
        (-signal.SIGSEGV, False, r"crashed \(SIGSEGV\)"),
        (3, False, r"crashed \(code 3\)"),
    ],
)
def test_why_a_child_ended(
    code: int, late: bool, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    allowed = dataclasses.replace(isolated_reading.READING_TIME, most=2.0)
    monkeypatch.setattr(isolated_reading, "READING_TIME", allowed)
    child: Any = SimpleNamespace(returncode=code)
    assert re.search(reason, IsolatedReader()._why(child, late))


@pytest.mark.skipif(os.name == "nt", reason="limits of POSIX")
def test_a_limit_of_time_is_that_much_more_than_was_used(monkeypatch: pytest.MonkeyPatch) -> None:
    import resource

    limits: list[Any] = []
    monkeypatch.setattr(resource, "setrlimit", lambda *limit: limits.append(limit))
    monkeypatch.setattr(resource, "getrlimit", lambda _: (1, 999))
    monkeypatch.setattr(isolated_reading.time, "process_time", lambda: 40.5)
    isolated_reading._limit_processor_time(20.0)
    isolated_reading._limit_memory(10**9)
    assert limits == [
        (resource.RLIMIT_CPU, (61, 999)),
        (resource.RLIMIT_CORE, (0, 0)),
        (resource.RLIMIT_AS, (10**9, 999)),
    ]


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_a_crash_is_told_with_the_file_and_the_next_is_read() -> None:
    reader = IsolatedReader()
    with pytest.raises(ConfigError, match=r"a\.mat: cannot be read: .*crashed \(SIGSEGV\)"):
        reader.read(crashing, file="a.mat")
    with pytest.raises(ConfigError) as caught:
        reader.read(refusing, file="b.mat")
    assert str(caught.value) == "b.mat, line 3, column 2: holds no numbers"
    assert reader.read(doubled, 1.0, file="c.mat")[0]["size"] == 0
    reader.end()


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="limits of POSIX")
def test_time_and_memory_end(monkeypatch: pytest.MonkeyPatch) -> None:
    # The time that the child takes to load this module counts.
    for name, most in (("READING_MEMORY", 5e8), ("READING_TIME", 2.0)):
        allowed = dataclasses.replace(getattr(isolated_reading, name), most=most)
        monkeypatch.setattr(isolated_reading, name, allowed)
    reader = IsolatedReader()
    with pytest.raises(ConfigError, match="a: cannot be read: reading it takes more than 2 s"):
        reader.read(endless, file="a")
    with pytest.raises(ConfigError, match=r"b: .* takes more than .* GB"):
        reader.read(unpacking, 10**9, file="b")
    with monkeypatch.context() as hurried:
        hurried.setattr(isolated_reading, "_PATIENCE", 0.5)
        with pytest.raises(ConfigError, match="takes more than"):
            IsolatedReader().read(waiting, file="c")
    assert reader.read(doubled, 1.0, file="d")[0]["size"] == 0
    reader.end()


@pytest.mark.slow
def test_a_changed_byte_loses_no_other_recording(tmp_path: Path) -> None:
    whole = saved(f=F, h=F)
    damaged = bytearray(whole)
    damaged[145] = 14  # the type of the name: loadmat reads from address 0
    for name, data in (("a", whole), ("b", bytes(damaged)), ("c", whole)):
        (tmp_path / f"{name}.mat").write_bytes(data)
        (tmp_path / f"{name}.toml").write_text(DESCRIPTION, encoding="utf-8")
    found = check_folder(tmp_path)
    assert [check.file.name for check in found.checks] == ["a.mat", "c.mat"]
    (refused,) = found.refused
    assert "b.mat: cannot be read" in refused.why


def _mutations(seed: int, count: int, tmp_path: Path) -> int:
    """Reads so many changed MATLAB files and pictures; how many were read all the same."""
    chance = random.Random(seed)
    whole = {"mat": saved(f=F, h=F * 1j, text="words"), "png": picture_bytes(np.ones((4, 5)))}
    read = 0
    for number in range(count):
        kind = chance.choice(("mat", "png"))
        data = bytearray(whole[kind])
        for _ in range(chance.choice((1, 1, 2, 8))):
            data[chance.randrange(len(data))] = chance.randrange(256)
        path = tmp_path / f"{number}.mat"
        try:
            if kind == "mat":
                path.write_bytes(data)
                read_matlab(path)
            else:
                picture_from(bytes(data))
            read += 1
        except InputError:
            continue
    return read


def test_a_few_changed_files_are_read_or_refused(tmp_path: Path) -> None:
    assert _mutations(41, 30, tmp_path) > 3


@pytest.mark.nightly
def test_many_changed_files_are_read_or_refused(tmp_path: Path) -> None:
    assert _mutations(random.randrange(10**6), 900, tmp_path) > 100


@pytest.mark.nightly
@pytest.mark.skipif(os.name == "nt", reason="limits of POSIX")
def test_a_small_file_that_unpacks_to_gigabytes_is_refused(tmp_path: Path) -> None:
    # 1.8 GB in less than two megabytes.
    zeros = np.zeros(200_000_000, np.uint8)
    path = tmp_path / "a.mat"
    savemat(path, {f"v{number}": zeros for number in range(9)}, do_compression=True)
    assert path.stat().st_size < 2e6
    with pytest.raises(ConfigError, match="takes more than"):
        read_matlab(path)


class Harmful:
    """What runs a command where it is unpickled."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os.system, ("touch harmed",)


def taken_over(data: bytes) -> Read:
    """A child that a file has taken over sends what it likes."""
    answers = next(fd for fd in range(3, 20) if Path(f"/proc/self/fd/{fd}").exists())
    os.write(answers, pickle.dumps(Harmful()) + b"\n")
    os._exit(0)


@pytest.mark.skipif(sys.platform != "linux", reason="finds the child's pipe in /proc")
def test_what_a_child_sends_is_never_unpickled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    reader = IsolatedReader()
    with pytest.raises(ConfigError, match="crashed"):
        reader.read(taken_over, file="a.mat")
    reader.end()
    assert not list(tmp_path.iterdir())
