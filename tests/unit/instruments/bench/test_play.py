"""What playing refuses before anything is computed or played."""

from __future__ import annotations

from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.bench.play import TRACE_NAME, play_texture


def test_a_record_that_is_there_is_refused_before_anything_is_computed(tmp_path: Path) -> None:
    (tmp_path / TRACE_NAME).write_bytes(b"a day's work")
    steps: list[str] = []
    with pytest.raises(InputError, match="never written over: give another folder"):
        play_texture("biet2008-plate", "biet2008-square-4mm", out=tmp_path, progress=steps.append)
    assert steps == []
    assert (tmp_path / TRACE_NAME).read_bytes() == b"a day's work"
