"""Tables as makers and people write them: localised heads, units behind strokes and underscores,
cells of words, several tables, negative axes, other encodings."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.unit.measure.recordings.bench_files import resonator, text, written
from tests.unit.measure.recordings.test_universal import function, nodes
from tests.unit.measure.recordings.test_universal import written as universal

from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings.files.raw_table import parted, unit_alone
from squeezefilm.measure.recordings.kinds import FrequencyResponse, ImpedanceSweep, RingDown
from squeezefilm.measure.recordings.read import (
    check_recording,
    propose_description,
    read_recording,
)

F, Z = resonator()
Y, W = 1 / Z, 2 * np.pi * F
SIZE, PHASE = np.abs(Z), np.degrees(np.angle(Z))
S11 = (Z - 50) / (Z + 50)
S11_DB, S11_DEG = 20 * np.log10(np.abs(S11)), np.degrees(np.angle(S11))


def german(table: str) -> str:
    """A table with semicolons and decimal commas."""
    return table.replace(",", ";").replace(".", ",")


def worded(head: str, columns: tuple[np.ndarray, ...], first: str, last: str) -> str:
    """A table whose rows begin and end with words."""
    rows = text("", columns).split("\n")[1:-1]
    return "\n".join([head, *(f"{first},{row},{last}" for row in rows)]) + "\n"


POLAR = (F, SIZE, PHASE)
PLAIN = text("f (Hz),|Z| (Ohm),phase (deg)", POLAR)
TABLES: dict[str, str | bytes] = {
    "German, units behind a stroke": german(text("Frequenz / Hz,Impedanz / Ω,Phase / °", POLAR)),
    "German, in Grad": german(
        text("Frequenz in Hz,|Z| in Ohm,Phasenwinkel in Grad", POLAR)
    ).encode("latin-1"),
    "French": german(text("Fréquence (Hz),Module (Ω),Phase (°)", POLAR)),
    "French, Latin-1": german(text("Fréquence (Hz),Impédance (ohm),Phase (°)", POLAR)).encode(
        "latin-1"
    ),
    "a stroke without blanks": text("f/kHz,G/µS,B/µS", (F / 1e3, 1e6 * Y.real, 1e6 * Y.imag)),
    "underscores": text("frequency_khz,z_mag_kohm,z_phase_deg", (F / 1e3, SIZE / 1e3, PHASE)),
    "capital units": text("FREQ(HZ),IMPEDANCE(OHM),PHASE(DEG)", POLAR),
    "no mark of two bytes": PLAIN.encode("utf-16-le"),
    "cells at the end of the head": PLAIN.replace("(deg)", "(deg),,").replace("\n", ",,\n"),
    "words in rows": worded("date," + PLAIN.split("\n")[0] + ",state", POLAR, "2026-11-20", "OK"),
    "a row of units": PLAIN.replace("f (Hz),|Z| (Ohm),phase (deg)", "f,|Z|,phase\nHz,Ohm,°"),
    "two tables": PLAIN + "\n" + PLAIN,
    "words below": PLAIN + "\nEnd of data\n",
    "quoted decimal commas": "\n".join(
        ",".join(f'"{cell.replace(".", ",")}"' for cell in row.split(","))
        for row in PLAIN.strip().split("\n")
    ),
    "Fortran": PLAIN.replace("e+", "D+").replace("e-", "D-"),
    "radians not told": text("f (Hz),|Z| (Ohm),phase", (F, SIZE, np.radians(PHASE))),
    "negative imaginary part": text("f (Hz),Z' (Ohm),-Z'' (Ohm)", (F, Z.real, -Z.imag)),
    "all of EIS": text(
        "f (Hz),Z' (Ohm),-Z'' (Ohm),|Z| (Ohm),-phase (°)", (F, Z.real, -Z.imag, SIZE, -PHASE)
    ),
    "decibels of an impedance": text(
        "Frequency (Hz),Trace 1: Impedance: Magnitude (dBΩ),Trace 2: Impedance: Phase (°)",
        (F, 20 * np.log10(SIZE), PHASE),
    ),
    "Bode 100, Rs and Cs": text(
        "Frequency (Hz),Trace 1: Impedance: Rs (Ω),Trace 2: Impedance: Cs (F)",
        (F, Z.real, -1 / (W * Z.imag)),
    ),
    "Bode 100, admittance": text(
        "Frequency (Hz),Trace 1: Admittance: Real (S),Trace 1: Admittance: Imag (S)",
        (F, Y.real, Y.imag),
    ),
    "PNA": text("Freq(Hz),S11(DB),S11(DEG)", (F, S11_DB, S11_DEG)),
    "ENA": "BEGIN CH1_DATA\n" + text("FREQ(HZ),S11(REAL),S11(IMAG)", (F, S11.real, S11.imag))
    + "END\n",
    "ZNL in dB": text("freq[Hz],db:Trc1_S11,ang:Trc1_S11", (F, S11_DB, S11_DEG)).replace(",", ";"),
    "MFIA": text("size,frequency,realz,imagz,absz,phasez", (F * 0, F, Z.real, Z.imag, SIZE,
                                                          np.radians(PHASE))),
    "Gamry": "EXPLAIN\nTAG\tEISPOT\nZCURVE\tTABLE\n" + text(
        "\tPt\tFreq\tZreal\tZimag\tZmod\tZphz\tIdc\n\t#\tHz\tohm\tohm\tohm\t°\tA",
        (np.arange(F.size), F, Z.real, Z.imag, SIZE, PHASE, F * 0),
    ).replace(",", "\t").replace("\n", "\r\n\t").rstrip("\t"),
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_proposed_as_what_it_holds(name: str, tmp_path: Path) -> None:
    data = TABLES[name]
    path = tmp_path / "a.csv"
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    described = tmp_path / "b.toml"
    described.write_text(propose_description(path).text, encoding="utf-8")
    sweep = read_recording(path, described)
    assert isinstance(sweep, ImpedanceSweep)
    assert sweep.phase_recorded
    assert np.allclose(sweep.frequency, F)
    assert np.allclose(1 / sweep.admittance, Z, rtol=1e-5)


def test_what_was_left_out_is_told(tmp_path: Path) -> None:
    for name, said in (("words in rows", "no numbers were left out: 1, 5"), ("two tables", "")):
        path = written(tmp_path, str(TABLES[name]), propose_text(tmp_path, str(TABLES[name])))
        found = check_recording(path)
        assert said in " ".join(how for _, how in found.facts)
    assert found.doubts == (f"a second table begins in line {F.size + 3}: the first was read",)


def propose_text(folder: Path, data: str) -> str:
    """The description that is proposed of a table."""
    path = folder / "p.csv"
    path.write_text(data, encoding="utf-8")
    return propose_description(path).text


def test_thousands_and_a_range_that_was_left(tmp_path: Path) -> None:
    rows = "\n".join(f'"{f:,.1f}";{z:.9g};{p:.9g}' for f, z, p in zip(*POLAR, strict=True))
    data = "f (Hz);|Z| (Ohm);phase (deg)\n" + rows + "\n"
    sweep = read_recording(written(tmp_path, data, propose_text(tmp_path, data)))
    assert np.allclose(sweep.frequency, F, atol=0.06)
    over = PLAIN.replace(PLAIN.split("\n")[3].split(",")[1], "∞")
    with pytest.raises(ConfigError, match="over its range here; record with a larger"):
        read_recording(written(tmp_path, over))


def test_a_phase_in_radians_under_degrees_is_doubted(tmp_path: Path) -> None:
    data = text("f,|Z|,phase", (F, SIZE, np.radians(PHASE)))
    said = propose_text(tmp_path, data).replace('"rad"', '"deg"')
    doubts = check_recording(written(tmp_path, data, said)).doubts
    assert any("is its unit rad?" in doubt for doubt in doubts)


def test_units_in_names() -> None:
    assert parted("Frequency (kHz)") == ("Frequency", "kHz")
    assert parted("|Z|(Ohm)-data") == ("|Z|-data", "ohm")
    assert parted("R_s") == ("R_s", "")
    assert parted("Trc1_S11") == ("Trc1_S11", "")
    assert parted("B/A") == ("B/A", "")
    assert parted("Velocity / Voltage [(m/s)/V]")[1] == ""
    assert [unit_alone(cell) for cell in ("[ m/s ]", "kHz", "f", "Second")] == [
        "m/s", "kHz", "", "",
    ]  # fmt: skip


@pytest.mark.parametrize("signed", [True, False])
@pytest.mark.parametrize("loss", ["D", "Q"])
@pytest.mark.parametrize("part", ["Cs", "Cp", "Ls", "Lp"])
def test_a_loss_has_the_sign_of_its_part_or_none(
    part: str, loss: str, signed: bool, tmp_path: Path
) -> None:
    reactive = {
        "Cs": -1 / (W * Z.imag),
        "Cp": Y.imag / W,
        "Ls": Z.imag / W,
        "Lp": -1 / (W * Y.imag),
    }
    ratio = np.abs(Z.real / Z.imag) ** (1 if loss == "D" else -1)
    ratio *= np.sign(reactive[part]) if signed else 1
    unit = "F" if part[0] == "C" else "H"
    data = text(f"f (Hz),{part} ({unit}),{loss}", (F, reactive[part], ratio))
    sweep = read_recording(written(tmp_path, data, propose_text(tmp_path, data)))
    assert isinstance(sweep, ImpedanceSweep)
    assert np.allclose(1 / sweep.admittance, Z, rtol=1e-5)


def two_ports(s11: np.ndarray, s21: np.ndarray) -> str:
    """A Touchstone file of two alike ports."""
    parts = (s11.real, s11.imag, s21.real, s21.imag)
    return text("# HZ S RI R 50", (F, *parts, *parts[2:], *parts[:2])).replace(",", " ")


def test_a_device_between_two_ports_is_read_from_what_passes(tmp_path: Path) -> None:
    path = written(tmp_path, two_ports(Z / (Z + 100), 100 / (Z + 100)), "", "a.s2p")
    found = check_recording(path)
    assert np.allclose(1 / found.recording.admittance, Z, rtol=1e-6)
    assert any("in series between the ports" in how for _, how in found.facts)
    for across in (1 / (1 + 25 / Z), 1 / (1 + 0.1 / Z)):
        path = written(tmp_path, two_ports(across - 1, across), "", "b.s2p")
        assert any("port 2 takes part" in doubt for doubt in check_recording(path).doubts)
    commas = text("# HZ S RI R 50", (F, S11.real, S11.imag)).replace(",", " ").replace(".", ",")
    sweep = read_recording(written(tmp_path, commas, "", "c.s1p"))
    assert np.allclose(1 / sweep.admittance, Z, rtol=1e-5)


TIME = np.arange(600) * 5e-6
DECAY = np.exp(-np.pi * 300 * TIME) * np.cos(2 * np.pi * 30e3 * TIME)


def infiniium(rows: tuple[np.ndarray, ...]) -> str:
    """Text of an Infiniium, with times in its rows or without."""
    head = "Type:raw\nXInc:5.0E-06\nXOrg:0.0E+00\nXUnits:second\nYUnits:Volt\nData:"
    return text(head, rows)


def tektronix() -> str:
    """Two channels of a TDS side by side, the head beside the first rows."""
    rows = ["Record Length,2.5e+03,,", "Sample Interval,5e-6,,", "Source,CH1,,"]
    rows += [",,,"] * (TIME.size - len(rows))
    lines = zip(rows, TIME, DECAY, strict=True)
    return "".join(f"{head}{t:.9f},{v:.9f},,{head}{t:.9f},{-v:.9f},\n" for head, t, v in lines)


def floats() -> bytes:
    """A WAV file of floats whose head is the extensible one."""
    data = DECAY.astype("<f4").tobytes()
    form = struct.pack("<HHIIHHHHIH", 0xFFFE, 1, 200000, 800000, 4, 32, 22, 32, 3, 3)
    form += bytes.fromhex("000000001000800000aa00389b71")
    body = b"WAVEfmt " + struct.pack("<I", len(form)) + form
    body += b"data" + struct.pack("<I", len(data)) + data
    return b"RIFF" + struct.pack("<I", len(body)) + body


SIGNALS: dict[str, tuple[str, Callable[[], str | bytes]]] = {
    "Infiniium": ("csv", lambda: infiniium((TIME, DECAY))),
    "Infiniium without times": ("csv", lambda: infiniium((DECAY,))),
    "GW Instek": ("csv", lambda: text("Memory Length,600\nSampling Period,5e-6\nWaveform Data",
                                      (DECAY,))),
    "TDS, two channels": ("csv", tektronix),
    "Time(S)": ("csv", lambda: text("#,Time(S),CH1(V)", (np.arange(600), TIME, DECAY))),
    "WAV of floats": ("wav", floats),
}  # fmt: skip


@pytest.mark.parametrize("name", SIGNALS)
def test_a_signal_is_read_by_its_first_channel(name: str, tmp_path: Path) -> None:
    suffix, write = SIGNALS[name]
    data = write()
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    said = propose_description(path).text
    if 'kind = "raw signals"' in said:
        said = "\n".join(line for line in said.split("\n") if not line.startswith("displ"))
        said = said.replace("raw signals", "ring-down").replace("voltage =", "signal =")
    path.with_suffix(".toml").write_text(said, encoding="utf-8")
    ring = read_recording(path)
    assert isinstance(ring, RingDown)
    assert np.allclose(ring.time, TIME, atol=1e-9)
    assert np.allclose(ring.displacement, DECAY, atol=1e-6)


def test_both_channels_of_a_sound_are_proposed_over_full_scale(tmp_path: Path) -> None:
    data = np.repeat(np.round(DECAY * 32767).astype("<i2"), 2).tobytes()
    form = struct.pack("<HHIIHH", 1, 2, 200000, 800000, 4, 16)
    body = b"WAVEfmt " + struct.pack("<I", 16) + form + b"data" + struct.pack("<I", len(data))
    path = tmp_path / "a.wav"
    path.write_bytes(b"RIFF" + struct.pack("<I", len(body + data)) + body + data)
    said = propose_description(path).text.replace("… V", "2 V").replace("… nm", "5 nm")
    path.with_suffix(".toml").write_text(said, encoding="utf-8")
    found = read_recording(path)
    assert np.allclose(found.voltage, 2 * DECAY, atol=1e-4)
    assert np.allclose(found.displacement, 5e-9 * DECAY, atol=1e-12)


def units(length: float) -> dict[str, object]:
    """A data set of units, with so many lengths a metre."""
    import pyuff

    return dict(
        pyuff.prepare_164(
            units_code=5, units_description="own", temp_mode=1, length=length, force=1.0,
            temp=1.0, temp_offset=0.0,
        )
    )  # fmt: skip


@pytest.mark.parametrize(("length", "unit"), [(1.0, "m/V"), (1e3, "mm/V")])
def test_units_of_a_universal_file_are_held_against_the_description(
    length: float, unit: str, tmp_path: Path
) -> None:
    f = np.linspace(29e3, 31e3, 41)
    h = 1e-7 / (1 - (f / 30e3) ** 2 + 1j * f / 30e3 / 60)
    path = universal(tmp_path / "a.uff", units(length), function(length * h, x=f), nodes())
    said = (
        'kind = "frequency response"\n[columns]\nfrequency = { column = "x", unit = "Hz" }\n'
        'displacement = { column = "58.1 real", unit = "UNIT" }\n'
        'displacement_imaginary = { column = "58.1 imaginary", unit = "UNIT" }\n'
    )
    path.with_suffix(".toml").write_text(said.replace("UNIT", unit), encoding="utf-8")
    found = check_recording(path)
    assert isinstance(found.recording, FrequencyResponse)
    assert np.allclose(found.recording.displacement_per_volt, h, rtol=1e-4)
    assert any(f"{length:g} lengths a metre" in how for _, how in found.facts)
    other = "um/V" if unit == "m/V" else "m/V"
    path.with_suffix(".toml").write_text(said.replace("UNIT", other), encoding="utf-8")
    with pytest.raises(ConfigError, match=f'write unit = "{unit}"'):
        read_recording(path)
