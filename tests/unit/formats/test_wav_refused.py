"""WAV files that other programs or accidents made, byte by byte."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
import pytest

from squeezefilm.errors import InputError
from squeezefilm.formats.wav import Waveform, wav_bytes, waveform_from

NOTE = {"unit": "V", "full_scale": 2.0, "seed": 3}


def chunk(name: bytes, body: bytes) -> bytes:
    return name + struct.pack("<I", len(body)) + body + b"\0" * (len(body) % 2)


def made(
    data: bytes, *, tag: int = 1, width: int = 2, note: Any = NOTE, before: bytes = b""
) -> bytes:
    head = struct.pack("<HHIIHH", tag, 1, 8000, 8000 * width, width, 8 * width)
    body = before + chunk(b"fmt ", head) + chunk(b"sqzf", json.dumps(note).encode())
    body += chunk(b"data", data)
    return b"RIFF" + struct.pack("<I", 4 + len(body)) + b"WAVE" + body


def test_samples_of_each_kind_are_read_with_their_sign() -> None:
    sixteen = waveform_from(made(struct.pack("<4h", 0, 32767, -32767, 1)))
    assert sixteen.samples == pytest.approx([0.0, 2.0, -2.0, 2 / 32767])
    assert (sixteen.unit, sixteen.full_scale, sixteen.sample_rate) == ("V", 2.0, 8000.0)
    assert sixteen.metadata == {"seed": 3}
    whole = [0, 8388607, -8388607, -1]
    packed = b"".join(struct.pack("<i", one)[:3] for one in whole)
    wide = waveform_from(made(packed, width=3))
    assert wide.samples == pytest.approx(2 * np.array(whole) / 8388607)
    floats = waveform_from(made(struct.pack("<3f", 0.5, -1.0, 1.0), tag=3, width=4))
    assert floats.samples == pytest.approx([1.0, -2.0, 2.0])


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


def test_chunks_of_others_are_passed_over_also_those_of_odd_length() -> None:
    other = chunk(b"LIST", b"odd") + chunk(b"bext", b"even")
    found = waveform_from(made(struct.pack("<h", 32767), before=other))
    assert found.samples.tolist() == [2.0]


def test_a_float_a_rounding_above_full_scale_is_full_scale_and_more_is_refused() -> None:
    scale = {**NOTE, "full_scale": 3.0}
    above = float(np.nextafter(np.float32(1.0), np.float32(2.0)))
    assert above - 1 > 1e-7
    with pytest.raises(InputError, match="samples"):
        waveform_from(made(struct.pack("<f", above), tag=3, width=4, note=scale))
    exact = waveform_from(made(struct.pack("<f", -1.0), tag=3, width=4, note=scale))
    assert exact.samples.tolist() == [-3.0]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (made(b""), "0 bytes of samples"),
        (made(b"\0\0\0"), "3 bytes of samples, no whole number"),
        (made(b"\0" * 4, width=3), "4 bytes of samples"),
        (made(b"\0" * 4, tag=3, width=2), "channels of 16 bits"),
        (made(b"\0" * 4, tag=1, width=4), "channels of 32 bits"),
        (made(b"\0" * 4, note=[1]), "does not say what full scale is"),
        (made(b"\0" * 4, note={"unit": "V"}), "does not say what full scale is"),
        (made(b"\0" * 4, note={"unit": "V", "full_scale": "much"}), "does not say"),
        (made(b"\0" * 4, note={"unit": "W", "full_scale": 1.0}), "which is no scale"),
        (made(b"\0" * 4, note={"unit": "V", "full_scale": 0.0}), "which is no scale"),
        (made(b"\0" * 4).replace(b"data", b"dat_"), "no format or no samples"),
        (made(b"\0" * 4).replace(b"fmt ", b"fmt_"), "no format or no samples"),
        (b"RIFF\0\0\0\0WAVX", "no WAV file"),
        (b"RIFF\0\0\0\0WAVE", "no format or no samples"),
    ],
)
def test_what_is_wrong_is_said(data: bytes, words: str) -> None:
    with pytest.raises(InputError, match=words):
        waveform_from(data, "mine.wav")


def test_a_format_that_is_too_short_is_none() -> None:
    short = chunk(b"fmt ", b"\0" * 15) + chunk(b"data", b"\0\0")
    with pytest.raises(InputError, match="no format or no samples"):
        waveform_from(b"RIFF" + struct.pack("<I", len(short) + 4) + b"WAVE" + short)


def test_a_file_cut_anywhere_is_refused_at_its_chunk() -> None:
    whole = wav_bytes(Waveform(np.array([0.5, -0.5]), 8000.0, "V", 1.0), "int16")
    place = whole.index(b"data")
    for cut in range(1, 5):
        with pytest.raises(InputError, match=f"cut short at byte {place}"):
            waveform_from(whole[:-cut])


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
    from squeezefilm.formats import wav

    wave = Waveform(np.zeros(100), 8000.0, "V", 1.0)
    monkeypatch.setattr(wav, "_MOST_BYTES", 200)
    assert len(wav_bytes(wave, "int16")) > 200
    with pytest.raises(InputError, match="100 samples of 3 bytes do not fit"):
        wav_bytes(wave, "int24")
