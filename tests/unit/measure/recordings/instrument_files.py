"""Exports of instruments, made here: every number is computed. No recording of these instruments
was at hand but those of `test_instruments.py`.

After documentation or readers that were found: E4990A, WaveForms, R&S, Copper Mountain, Siglent,
Rigol. From memory, so that reader and writer may share a mistake: Bode 100, Sinephase, Moku, Red
Pitaya, RTB, and the words of the 4294A's parameters. A writer takes frequencies (Hz) and
impedances (Ω), or times (s) and voltages (V)."""

from __future__ import annotations

import io
import wave
from collections.abc import Callable, Sequence

import numpy as np

from squeezefilm.core import quantities as si

Sweep = Callable[[si.HertzArray, si.ComplexArray], str]
Scope = Callable[[si.SecondArray, si.FloatArray, si.FloatArray], str | bytes]


def _rows(
    columns: Sequence[si.FloatArray], delimiter: str, decimal: str = ".", end: str = ""
) -> str:
    rows = zip(*(np.asarray(one).tolist() for one in columns), strict=True)
    lines = (delimiter.join(f"{v:.12e}" for v in row).replace(".", decimal) + end for row in rows)
    return "\n".join(lines) + "\n"


def _degrees(z: si.ComplexArray) -> si.FloatArray:
    return np.asarray(np.degrees(np.angle(z)))


def agilent_4294a(parameter: str, values: Callable[..., tuple[si.FloatArray, ...]],
                  memory: bool = False) -> Sweep:  # fmt: skip
    """The ASCII export of a 4294A (words of parameters from memory): a head, then one table a
    trace, with the traces in memory where they are on."""

    def write(f: si.HertzArray, z: si.ComplexArray) -> str:
        text = (
            f'4294A REV1.11\n"DATE:  1"\n\n\n"MEASURE PARAMETER: {parameter}"\n"ADAPTER: NONE"\n'
            f'"SWEEP TYPE: LIN FREQ"\n"NUMBER of POINTS: {f.size}"\n"OSC LEVEL:  500 mVolt"\n\n'
        )
        kept = ('\t"Memory Trace Real"\t"Memory Trace Imag"',) if memory else ("",)
        for letter, column in zip("AB", values(f, z), strict=True):
            more = [np.ones(f.size), np.zeros(f.size)] if memory else []
            parts = [np.real(column), np.imag(column)]
            text += f'\n"TRACE: {letter}"\n"FORMAT: LIN"\n\n"Frequency"\t"Data Trace Real"\t'
            text += f'"Data Trace Imag"{kept[0]}\n' + _rows([f, *parts, *more], "\t")
        return text

    return write


def e4990a(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of an E4990A: a head behind "!", the table between BEGIN and END."""
    head = "!Keysight Technologies,E4990A,MY00000000,A.04.00\n!Date: Fri Nov 20 11:24:29 2026\n\n"
    names = "BEGIN CH1_DATA\nFrequency(Hz), |Z|(Ohm)-data, theta-z(deg)-data\n"
    return head + names + _rows([f, np.abs(z), _degrees(z)], ", ") + "END\n"


def e4990a_two_channels(f: si.HertzArray, z: si.ComplexArray) -> str:
    """The same with the columns in another order and a second channel."""
    head = "!Keysight Technologies,E4990A,MY00000000,A.04.00\n\n"
    first = "BEGIN CH1_DATA\nFrequency(Hz),X(Ohm)-data,R(Ohm)-data\n"
    second = "END\n\nBEGIN CH2_DATA\nFrequency(Hz),Cp(F)-data,D(U)-data\n"
    cp = (1 / z).imag / (2 * np.pi * f)
    return (head + first + _rows([f, z.imag, z.real], ",") + second
            + _rows([f, cp, 1 / z.imag], ",") + "END\n")  # fmt: skip


def e5061b(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of an E5061B with the impedance option: series capacitance and loss."""
    head = "!Agilent Technologies,E5061B,MY49000000,A.02.09\n!Date: Mon Nov 02 2026\n"
    names = "BEGIN CH1_DATA\nFrequency(Hz),Cs(F)-data,D(U)-data\n"
    cs = -1 / (2 * np.pi * f * z.imag)
    return head + names + _rows([f, cs, -z.real / z.imag], ",") + "END\n"


def keysight_network_analyser(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of an ENA or PNA: real and imaginary part of S11."""
    s = (z - 50) / (z + 50)
    names = "BEGIN CH1_DATA\nFreq(Hz),S11(REAL),S11(IMAG)\n"
    return names + _rows([f, s.real, s.imag], ",") + "END\n"


def waveforms_impedance(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of the impedance analyser of Digilent WaveForms, with comments."""
    head = "#Digilent WaveForms Impedance Analyzer\n#Device Name: Analog Discovery 2\n#Serial: 0\n"
    names = "Frequency (Hz),Trace θ (deg),Trace |Z| (Ohm),Trace Rs (Ohm),Trace Xs (Ohm)\n"
    return head + names + _rows([f, _degrees(z), np.abs(z), z.real, z.imag], ",")


def waveforms_capacitance(f: si.HertzArray, z: si.ComplexArray) -> str:
    """The same with series capacitance and resistance on."""
    head = "#Digilent WaveForms Impedance Analyzer\n#Device Name: Analog Discovery 3\n"
    names = "Frequency (Hz),Trace Rs (Ohm),Trace Cs (F)\n"
    return head + names + _rows([f, z.real, -1 / (2 * np.pi * f * z.imag)], ",")


def bode_100(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of the Bode Analyzer Suite, as where decimals stand after a comma."""
    names = "Frequency (Hz);Trace 1: Impedance: Magnitude (Ω);Trace 2: Impedance: Phase (°)\n"
    return names + _rows([f, np.abs(z), _degrees(z)], ";", ",")


def sinephase(f: si.HertzArray, z: si.ComplexArray) -> str:
    """Text of a Sinephase analyser: tabs, phase first."""
    head = "# SinePhase Impedance Analyzer 16777k\n# Date: 2026-11-20\n"
    names = "Frequency [kHz]\tPhase [°]\tImpedance [Ω]\n"
    return head + names + _rows([f / 1e3, _degrees(z), np.abs(z)], "\t")


def rohde_schwarz(f: si.HertzArray, z: si.ComplexArray) -> str:
    """Trace export of a ZNB or ZNL: semicolons, the last at the end of the line."""
    s = (z - 50) / (z + 50)
    names = "freq[Hz];re:Trc1_S11;im:Trc1_S11;\n"
    return names + _rows([f, s.real, s.imag], ";", end=";")


def copper_mountain(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of a Copper Mountain analyser: names behind "!" in the last line of the head."""
    s = (z - 50) / (z + 50)
    head = "! COPPER MOUNTAIN TECHNOLOGIES, R60, 000, 1.0\n! Date: 20.11.2026 10:00:00\n"
    names = "! Stimulus(Hz), S11(Real), S11(Imag)\n"
    return head + names + _rows([f, s.real, s.imag], ", ")


def touchstone(
    option: str = "# HZ S RI R 50", ports: int = 1, kind: str = "S", head: str = ""
) -> Sweep:
    """A Touchstone file with an option line (version 1: Z and Y over the reference)."""

    def write(f: si.HertzArray, z: si.ComplexArray) -> str:
        words = option.upper().split()
        over = float(words[-1]) if words[-2:-1] == ["R"] else 50.0
        value = {"S": (z - over) / (z + over), "Z": z / over, "Y": over / z}[kind]
        factor = {"HZ": 1.0, "KHZ": 1e3, "MHZ": 1e6}.get(words[1] if len(words) > 1 else "", 1e9)
        pair = [np.abs(value), _degrees(value)]
        if "RI" in words:
            pair = [value.real, value.imag]
        elif "DB" in words:
            pair = [20 * np.log10(np.abs(value)), _degrees(value)]
        others = [1e-3 * np.ones(f.size)] * (6 if ports == 2 else 0)
        return f"! made here\n{head}{option}\n" + _rows([f / factor, *pair, *others], " ")

    return write


def touchstone_2(f: si.HertzArray, z: si.ComplexArray) -> str:
    """Version 2 of one port: Z in ohms, comments at the end of lines."""
    rows = _rows([f / 1e3, z.real, z.imag], " ").replace("\n", " ! point\n")
    head = "[Version] 2.0\n# kHz Z RI\n[Number of Ports] 1\n[Reference] 75\n"
    return f"{head}[Number of Frequencies] {f.size}\n[Network Data]\n{rows}[End]\n"


def _gain(z: si.ComplexArray) -> si.ComplexArray:
    """The voltage over a shunt of 100 Ω, over that of device and shunt."""
    return np.asarray(100 / (100 + z))


def moku(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of the Moku's frequency response analyser: a head behind "%"."""
    head = "% Moku:Go Frequency Response Analyzer\n% Acquired 2026-11-20\n"
    names = "% Frequency (Hz), Magnitude (dB), Phase (deg)\n"
    gain = _gain(z)
    return head + names + _rows([f, 20 * np.log10(np.abs(gain)), _degrees(gain)], ", ")


def waveforms_network(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of the network analyser of WaveForms: channel 2 over channel 1."""
    gain = _gain(z)
    head = "#Digilent WaveForms Network Analyzer - Bode\n#Device Name: Analog Discovery 2\n"
    names = (
        "Frequency (Hz),Channel 1 Magnitude (dB),Channel 2 Magnitude (dB),Channel 2 Phase (deg)\n"
    )
    zero = np.zeros(f.size)
    return head + names + _rows([f, zero, 20 * np.log10(np.abs(gain)), _degrees(gain)], ",")


def red_pitaya_bode(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of the Red Pitaya's Bode analyser."""
    gain = _gain(z)
    names = "# Red Pitaya Bode analyzer\nFrequency[Hz],Gain[dB],Phase[deg]\n"
    return names + _rows([f, 20 * np.log10(np.abs(gain)), _degrees(gain)], ",")


def rohde_schwarz_bode(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of the Bode plot of an RTB or RTM."""
    gain = _gain(z)
    names = "Sample,Frequency in Hz,Gain in dB,Phase in °,Amplitude in Vpp\n"
    count = np.arange(f.size, dtype=float)
    columns = [count, f, 20 * np.log10(np.abs(gain)), _degrees(gain), np.ones(f.size)]
    return names + _rows(columns, ",")


def red_pitaya_impedance(f: si.HertzArray, z: si.ComplexArray) -> str:
    """CSV of the Red Pitaya's impedance analyser."""
    names = "# Red Pitaya impedance analyzer\nFrequency[Hz],Phase[deg],Z[Ohm]\n"
    return names + _rows([f, _degrees(z), np.abs(z)], ",")


def rigol_1000z(t: si.SecondArray, a: si.FloatArray, b: si.FloatArray) -> str:
    """CSV of a DS1000Z: numbers of samples, start and increment in the second row."""
    step = float(t[1] - t[0])
    head = f"X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,{t[0]:.6e},{step:.6e}\n"
    return head + "".join(
        f"{k},{x:.6e},{y:.6e},,\n" for k, (x, y) in enumerate(zip(a, b, strict=True))
    )


def rigol_5000(t: si.SecondArray, a: si.FloatArray, b: si.FloatArray) -> str:
    """CSV of an MSO5000's memory: voltages alone, the times in the head."""
    head = f"CH1(V),t0 = {t[0]:.6e}s, tInc = {t[1] - t[0]:.6e},\n"
    return head + "".join(f"{x:.6e},,\n" for x in a)


def rigol_screen(t: si.SecondArray, a: si.FloatArray, b: si.FloatArray) -> str:
    """CSV of what is on an MSO5000's screen."""
    return "Time(s),CH1(V),CH2(V)\n" + _rows([t, a, b], ",")


def tektronix_tds(t: si.SecondArray, a: si.FloatArray, b: si.FloatArray) -> str:
    """CSV of a TDS2000 or TBS1000: what is said beside the first rows, values in columns 4, 5."""
    said = [f"Record Length,{t.size:.6e},,", f"Sample Interval,{t[1] - t[0]:.6e},,",
            "Trigger Point,0.0,,", "Source,CH1,,", "Vertical Units,V,,"]  # fmt: skip
    said += [",,,"] * (t.size - len(said))
    rows = zip(said, t, a, strict=True)
    return "".join(f"{head}{x:.9e},{y:.6e},\n" for head, x, y in rows)


def tektronix_mdo(t: si.SecondArray, a: si.FloatArray, b: si.FloatArray) -> str:
    """CSV of an MDO3000: a head of pairs, then TIME and channels."""
    head = f"Model,MDO3024\nFirmware Version,1.28\n\nHorizontal Units,s\nRecord Length,{t.size}\n"
    return head + "Vertical Units,V,V\nLabel,,\nTIME,CH1,CH2\n" + _rows([t, a, b], ",")


def siglent(t: si.SecondArray, a: si.FloatArray, b: si.FloatArray) -> str:
    """CSV of an SDS1000X-E."""
    head = f"Record Length,Analog:{t.size}\nSample Interval,{t[1] - t[0]:.6e}\n"
    return head + "Vertical Scale,CH1:1.00,CH2:1.00\nSecond,Volt,Volt\n" + _rows([t, a, b], ",")


def picoscope(t: si.SecondArray, a: si.FloatArray, b: si.FloatArray) -> str:
    """CSV of PicoScope where decimals stand after a comma: milliseconds, an empty line."""
    return "Time;Channel A;Channel B\n(ms);(V);(mV)\n\n" + _rows([1e3 * t, a, 1e3 * b], ";", ",")


def keysight_scope(t: si.SecondArray, a: si.FloatArray, b: si.FloatArray) -> str:
    """CSV of an InfiniiVision."""
    return "x-axis,1,2\nsecond,Volt,Volt\n" + _rows([t, a, b], ",")


def sound(t: si.SecondArray, a: si.FloatArray, b: si.FloatArray, width: int = 3) -> bytes:
    """A WAV file of two channels; one is full scale."""
    buffer = io.BytesIO()
    with wave.open(buffer, "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(width)
        file.setframerate(round(1 / (t[1] - t[0])))
        both = np.round(np.stack([a, b], axis=1) * (2 ** (8 * width - 1) - 1)).astype("<i4")
        both += 128 if width == 1 else 0
        file.writeframes(both.reshape(-1, 1).view(np.uint8)[:, :width].tobytes())
    return buffer.getvalue()


def _pair(first: str, second: str) -> Callable[..., tuple[si.FloatArray, ...]]:
    def values(f: si.HertzArray, z: si.ComplexArray) -> tuple[si.FloatArray, ...]:
        y, w = 1 / z, 2 * np.pi * f
        known = {
            "|Z|": np.abs(z), "|Y|": np.abs(y), "DEG": _degrees(z), "RAD": np.angle(z),
            "YDEG": _degrees(y), "R": z.real, "X": z.imag, "G": y.real, "B": y.imag,
            "LS": z.imag / w, "CS": -1 / (w * z.imag), "RS": z.real, "RP": 1 / y.real,
            "LP": -1 / (w * y.imag), "CP": y.imag / w, "Q": np.abs(z.imag) / z.real,
            "D": -z.real / z.imag,
        }  # fmt: skip
        return known[first], known[second]

    return values


AGILENT_PAIRS: tuple[tuple[str, str, str], ...] = (
    ("IMPEDANCE MAG PHASE (DEG)", "|Z|", "DEG"), ("IMPEDANCE MAG PHASE (RAD)", "|Z|", "RAD"),
    ("ADMITTANCE MAG PHASE (DEG)", "|Y|", "YDEG"), ("IMPEDANCE REAL IMAG", "R", "X"),
    ("ADMITTANCE REAL IMAG", "G", "B"), ("LS-RS", "LS", "RS"), ("CS-RS", "CS", "RS"),
    ("CS-D", "CS", "D"), ("CP-G", "CP", "G"), ("CP-D", "CP", "D"), ("CP-RP", "CP", "RP"),
    ("LP-G", "LP", "G"), ("LP-RP", "LP", "RP"), ("IMPEDANCE MAG CS", "|Z|", "CS"),
    ("IMPEDANCE MAG LS", "|Z|", "LS"), ("IMPEDANCE MAG CP", "|Z|", "CP"),
    ("IMPEDANCE MAG LP", "|Z|", "LP"),
)  # fmt: skip
"""Parameters of a 4294A as its head names them, and what traces A and B hold."""


SWEEPS: dict[str, tuple[str, Sweep]] = {
    **{f"4294A {word}": ("txt", agilent_4294a(word, _pair(a, b))) for word, a, b in AGILENT_PAIRS},
    "4294A with memory": (
        "txt", agilent_4294a("IMPEDANCE MAG PHASE (DEG)", _pair("|Z|", "DEG"), memory=True)
    ),
    "E4990A": ("csv", e4990a), "E4990A of two channels": ("csv", e4990a_two_channels),
    "E5061B": ("csv", e5061b), "ENA": ("csv", keysight_network_analyser),
    "WaveForms": ("csv", waveforms_impedance), "WaveForms Cs": ("csv", waveforms_capacitance),
    "Bode 100": ("csv", bode_100), "Sinephase": ("txt", sinephase),
    "ZNL": ("csv", rohde_schwarz), "Copper Mountain": ("csv", copper_mountain),
    "Red Pitaya": ("csv", red_pitaya_impedance),
    "s1p RI": ("s1p", touchstone()), "s1p MA": ("s1p", touchstone("# kHz S MA R 75")),
    "s1p DB": ("s1p", touchstone("# MHZ S DB R 50")), "s1p default": ("s1p", touchstone("#")),
    "s1p Z": ("s1p", touchstone("# Hz Z RI R 50", kind="Z")),
    "s1p Y": ("s1p", touchstone("# Hz Y MA R 50", kind="Y")),
    "s1p of a NanoVNA": ("s1p", touchstone(head="! NanoVNA-Saver 0.6\n")),
    "s2p": ("s2p", touchstone(ports=2)), "Touchstone 2": ("ts", touchstone_2),
}  # fmt: skip
"""Sweeps that say themselves what they hold: suffix and writer."""

GAINS: dict[str, Sweep] = {
    "Moku": moku, "WaveForms network": waveforms_network, "Red Pitaya Bode": red_pitaya_bode,
    "RTB Bode": rohde_schwarz_bode,
}  # fmt: skip
"""Gains over a shunt."""

SCOPES: dict[str, tuple[str, int, Scope]] = {
    "DS1000Z": ("csv", 2, rigol_1000z), "MSO5000 memory": ("csv", 1, rigol_5000),
    "MSO5000 screen": ("csv", 2, rigol_screen), "TDS": ("csv", 1, tektronix_tds),
    "MDO": ("csv", 2, tektronix_mdo), "SDS": ("csv", 2, siglent),
    "PicoScope": ("csv", 2, picoscope), "InfiniiVision": ("csv", 2, keysight_scope),
    "WAV": ("wav", 1, sound),
}  # fmt: skip
"""Signals over time: suffix, how many channels are kept, writer."""
