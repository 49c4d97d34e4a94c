"""Files are regular and of a limited size, or refused at once: no pipe is waited for."""

import os
import tracemalloc
from pathlib import Path

import pytest

from squeezefilm.core.config.load import load
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import text_of_file
from squeezefilm.core.hard_limits import HardLimit
from squeezefilm.core.regular_file import read_regular, read_regular_text
from squeezefilm.instruments.session.record.trace import read_trace
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.texture_files.image_file import read_picture

TEN = HardLimit("bytes of a test", 0, 10, "ten are enough")
READERS = [lambda path: load(Display, path), text_of_file, read_picture, read_trace]


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on this system")
def test_no_reader_waits_for_a_pipe_or_reads_a_device(reader, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for path in (pipe, Path("/dev/zero")):
        with pytest.raises(InputError, match="no regular file"):
            reader(path)


@pytest.mark.parametrize("reader", READERS)
def test_names_that_no_file_can_have(reader, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    for name in ("a" * 300, "a\0b", "\ud800", "none", "."):
        with pytest.raises(InputError):
            reader(tmp_path / name)


def test_a_preset_of_a_name_too_long_is_unknown() -> None:
    with pytest.raises(ConfigError, match="neither a file nor a preset"):
        load_display("a" * 300)


def test_size_and_text(tmp_path: Path) -> None:
    file = tmp_path / "f"
    file.write_bytes(b"\xef\xbb\xbfa\r\nb")
    assert read_regular_text(file, TEN, "a test") == "a\nb"
    file.write_bytes(b"01234567890")
    with pytest.raises(ConfigError, match="larger than 10 bytes"):
        read_regular(file, TEN, "a test")
    file.write_bytes(b"\xff")
    with pytest.raises(ConfigError, match="not UTF-8"):
        read_regular_text(file, TEN, "a test")


def test_a_small_file_takes_no_more_memory_than_it_has(tmp_path: Path) -> None:
    """Though the limit is of gigabytes: the lab's workers may have two."""
    file = tmp_path / "small.csv"
    file.write_text("x\n1\n")
    tracemalloc.start()
    try:
        assert read_regular(file, HardLimit("bytes of a table", 0, 2e9, "memory"), "a table")
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()
