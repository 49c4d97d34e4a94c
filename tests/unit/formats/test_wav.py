"""WAV with a scale: what is written is read, and read right by others; the rest is refused."""

import struct
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile

from squeezefilm.errors import InputError
from squeezefilm.formats.wav import Encoding, Waveform, read_wav, wav_bytes, waveform_from


def envelope(n: int = 1001) -> Waveform:
    t = np.arange(n) / 19_200
    return Waveform(2e-6 * np.sin(300 * t), 19_200.0, "m", 2e-6, {"seed": 3})


@pytest.mark.parametrize(
    ("encoding", "error"),
    [("float32", 6e-8), ("int16", 0.5 / 32767), ("int24", 0.5 / 8388607)],
)
def test_what_is_written_is_read_within_half_a_step(
    encoding: Encoding, error: float, tmp_path: Path
) -> None:
    written = envelope()
    (tmp_path / "a.wav").write_bytes(wav_bytes(written, encoding))
    read = read_wav(tmp_path / "a.wav")
    assert read.unit == "m"
    assert read.full_scale == 2e-6
    assert read.sample_rate == 19_200
    assert read.metadata == {"seed": 3}
    assert np.max(np.abs(read.samples - written.samples)) <= error * 1.0001 * 2e-6
    assert np.max(np.abs(read.samples - written.samples)) > 0


@pytest.mark.parametrize("value", [1.0, -1.0])
@pytest.mark.parametrize("encoding", ["float32", "int16", "int24"])
def test_full_scale_is_exact(encoding: Encoding, value: float) -> None:
    wave = Waveform(np.array([value, 0.0]) * 15.0, 192_000.0, "V", 15.0)
    assert waveform_from(wav_bytes(wave, encoding)).samples.tolist() == [15.0 * value, 0.0]


def test_another_program_reads_the_same_samples(tmp_path: Path) -> None:
    # An odd number of 16-bit samples and a JSON chunk of any length: padding must be right.
    for n in (100, 101):
        (tmp_path / "a.wav").write_bytes(wav_bytes(envelope(n), "int16"))
        with pytest.warns(wavfile.WavFileWarning, match="not understood"):
            rate, samples = wavfile.read(tmp_path / "a.wav")
        assert rate == 19_200
        assert samples.shape == (n,)
        assert samples / 32767 * 2e-6 == pytest.approx(envelope(n).samples, abs=1e-10)


def test_nothing_is_clipped() -> None:
    with pytest.raises(InputError, match=r"samples = 2\.1 µm"):
        Waveform(np.array([2.1e-6]), 19_200.0, "m", 2e-6)
    with pytest.raises(InputError, match="whole number of samples"):
        Waveform(np.array([0.0]), 19_200.5, "m", 2e-6)
    with pytest.raises(InputError, match="finite"):
        Waveform(np.array([np.nan]), 19_200.0, "m", 2e-6)


def test_what_is_no_such_file_is_refused() -> None:
    good = wav_bytes(envelope())
    with pytest.raises(InputError, match="no WAV file"):
        waveform_from(b"RIFX" + good[4:])
    with pytest.raises(InputError, match="cut short"):
        waveform_from(good[:-7])
    with pytest.raises(InputError, match="does not say what full scale is"):
        waveform_from(good.replace(b"sqzf", b"junk"))
    place = good.index(b"fmt ") + 10
    with pytest.raises(InputError, match="2 channels"):
        waveform_from(good[:place] + struct.pack("<H", 2) + good[place + 2 :])
    with pytest.raises(InputError, match="no scale"):
        waveform_from(good.replace(b'"full_scale": 2e-06', b'"full_scale": -2e-6'))
