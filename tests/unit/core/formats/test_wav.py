"""WAV with a scale: another program reads what is written, and what no file holds is refused."""

import struct
from typing import Any

import numpy as np
import pytest
from tests.unit.core.formats.read_sound import read_sound

from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import Encoding, Waveform, wav_bytes


def envelope(n: int = 1001) -> Waveform:
    t = np.arange(n) / 19_200
    return Waveform(2e-6 * np.sin(300 * t), 19_200.0, "m", 2e-6, {"seed": 3})


@pytest.mark.parametrize(
    ("encoding", "error"),
    [("float32", 6e-8), ("int16", 0.5 / 32767), ("int24", 0.5 / 8388607)],
)
def test_what_is_written_is_read_within_half_a_step(encoding: Encoding, error: float) -> None:
    written = envelope()
    read = read_sound(wav_bytes(written, encoding))
    assert read.rate == 19_200
    assert read.note == {"seed": 3, "unit": "m", "full_scale": 2e-6, "encoding": encoding}
    assert np.max(np.abs(read.samples - written.samples)) <= error * 1.0001 * 2e-6
    assert np.max(np.abs(read.samples - written.samples)) > 0


@pytest.mark.parametrize("value", [1.0, -1.0])
@pytest.mark.parametrize("encoding", ["float32", "int16", "int24"])
def test_full_scale_is_exact(encoding: Encoding, value: float) -> None:
    wave = Waveform(np.array([value, 0.0]) * 15.0, 192_000.0, "V", 15.0)
    assert read_sound(wav_bytes(wave, encoding)).samples.tolist() == [15.0 * value, 0.0]


@pytest.mark.parametrize("count", [100, 101])
def test_an_odd_number_of_bytes_is_padded(count: int) -> None:
    read = read_sound(wav_bytes(envelope(count), "int16"))
    assert read.samples == pytest.approx(envelope(count).samples, abs=1e-10)


def test_nothing_is_clipped() -> None:
    with pytest.raises(InputError, match=r"samples = 2\.1 µm"):
        Waveform(np.array([2.1e-6]), 19_200.0, "m", 2e-6)
    with pytest.raises(InputError, match="whole number of samples"):
        Waveform(np.array([0.0]), 19_200.5, "m", 2e-6)
    with pytest.raises(InputError, match="finite"):
        Waveform(np.array([np.nan]), 19_200.0, "m", 2e-6)


@pytest.mark.parametrize("encoding", ["float32", "int16", "int24"])
def test_a_file_is_made_of_the_chunks_that_its_format_asks_for(encoding: Any) -> None:
    data = wav_bytes(Waveform(np.zeros(3), 8000.0, "V", 1.0), encoding)
    assert struct.unpack("<I", data[4:8])[0] == len(data) - 8
    chunks, place = {}, 12
    while place < len(data):
        size = int.from_bytes(data[place + 4 : place + 8], "little")
        chunks[data[place : place + 4]] = data[place + 8 : place + 8 + size]
        place += 8 + size + size % 2
    assert place == len(data)
    floats = encoding == "float32"
    # What is not PCM says how long its extension is, and how many samples there are.
    assert list(chunks) == [b"fmt ", *([b"fact"] if floats else []), b"sqzf", b"data"]
    width = {"float32": 4, "int16": 2, "int24": 3}[encoding]
    head = struct.pack("<HHIIHH", 3 if floats else 1, 1, 8000, 8000 * width, width, 8 * width)
    assert chunks[b"fmt "] == head + (b"\0\0" if floats else b"")
    assert chunks.get(b"fact", struct.pack("<I", 3)) == struct.pack("<I", 3)
    assert len(chunks[b"data"]) == 3 * width


@pytest.mark.parametrize(
    ("shape", "words"),
    [((2, 2), r"shape \(2, 2\) are no sound of one channel"), ((0,), "samples is empty"),
     ((), "samples is one number"), ((0, 2), "samples is empty")],
)  # fmt: skip
def test_a_sound_has_one_channel_and_a_sample(shape: tuple[int, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Waveform(np.zeros(shape), 8000.0, "V", 1.0)


def test_a_rate_is_a_whole_number_of_samples() -> None:
    with pytest.raises(InputError, match=r"sample_rate = 8000\.5 Hz cannot be written"):
        Waveform(np.zeros(2), 8000.5, "V", 1.0)


def test_what_does_not_fit_into_a_file_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    from squeezefilm.core.formats import traces

    wave = Waveform(np.zeros(100), 8000.0, "V", 1.0)
    monkeypatch.setattr(traces, "_MOST_BYTES", 200)
    assert len(wav_bytes(wave, "int16")) > 200
    with pytest.raises(InputError, match="100 samples of 3 bytes do not fit"):
        wav_bytes(wave, "int24")
