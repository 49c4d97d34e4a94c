"""Markers: what is told to the lab streaming layer, its moments, and what is said without it."""

from __future__ import annotations

import sys
import time
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.instruments.bench.markers import NAME, Markers, markers_if


class Layer:
    """pylsl, made up: its clock runs 1000 s ahead of the caller's."""

    IRREGULAR_RATE = 0.0

    def __init__(self) -> None:
        self.now = 50.0
        self.streams: list[tuple[Any, ...]] = []
        self.samples: list[tuple[list[str], float]] = []

    def StreamInfo(self, *what: Any) -> Any:
        """Keep what the stream is."""
        self.streams.append(what)
        return SimpleNamespace()

    def StreamOutlet(self, _: Any) -> Any:
        """Keep what is pushed."""
        return SimpleNamespace(
            push_sample=lambda sample, at: self.samples.append((sample, at)),
        )

    def local_clock(self) -> float:
        """Ahead."""
        return 1000.0 + self.now


@pytest.fixture
def layer(monkeypatch: pytest.MonkeyPatch) -> Layer:
    """In the place of pylsl."""
    made = Layer()
    monkeypatch.setitem(sys.modules, "pylsl", made)
    return made


def test_a_marker_has_the_moment_of_what_it_says_on_the_layers_clock(layer: Layer) -> None:
    markers = Markers("touch", clock=lambda: layer.now)
    markers.push("start", 49.25)
    layer.now = 60.0
    markers.push("now")
    assert layer.samples == [(["start"], 1049.25), (["now"], 1060.0)]
    assert layer.streams == [("touch", "Markers", 1, 0.0, "string", "touch-markers")]


def test_markers_are_only_where_they_are_asked_for(layer: Layer) -> None:
    assert markers_if(False) is None
    assert layer.streams == []
    assert markers_if(True) is not None
    assert markers_if("mine") is not None
    assert [one[0] for one in layer.streams] == [NAME, "mine"]


@pytest.mark.slow
def test_a_recorder_finds_the_stream_and_reads_the_moments() -> None:
    pylsl = pytest.importorskip("pylsl", reason="pylsl is not installed: the extra lsl has it")
    markers = Markers("squeezefilm-test")
    found = pylsl.resolve_byprop("name", "squeezefilm-test", timeout=10.0)
    assert found, "the stream is not seen on this computer"
    inlet = pylsl.StreamInlet(found[0])
    inlet.open_stream(timeout=10.0)
    wanted = time.monotonic() - 0.5
    markers.push("start 4 mm", wanted)
    text, at = inlet.pull_sample(timeout=10.0)
    assert text == ["start 4 mm"]
    # Both clocks are read at once, so that only what lies between the two readings is lost.
    here = pylsl.local_clock() - time.monotonic()
    assert at + inlet.time_correction() == pytest.approx(wanted + here, abs=0.05)
