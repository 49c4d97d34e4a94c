"""Demands of a plate on its amplifier: current, power, slew, the inductor that matches it; and
which class of amplifier can give that."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError, UnreachableError
from squeezefilm.physics.plate.circuit import (
    DrivenResponse,
    EquivalentCircuit,
    with_static_capacitance,
)
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.ring.body import modal_circuit, ring_body
from squeezefilm.physics.plate.ring.modes import annular_admittance, clamped_capacitance
from squeezefilm.physics.plate.solid.working import response_frequencies
from squeezefilm.physics.plate.working_mode import WorkingMode


@dataclass(frozen=True)
class AmplifierPart:
    """A class of amplifier by one part: what its data sheet prints.

    `ranges` are pairs of a voltage amplitude (V) and the current amplitude (A) that goes with it,
    rising in voltage; `slew_rate` is in V/s, None where none is printed.
    """

    kind: str
    part: str
    ranges: tuple[tuple[si.Volt, si.Ampere], ...]
    slew_rate: si.VoltPerSecond | None
    source: str


AMPLIFIERS: tuple[AmplifierPart, ...] = (
    AmplifierPart(
        "chip made for haptics",
        "TI DRV2667",
        # The sheet prints loads at 300 Hz, 680 nF at 50 V peak to peak and so on: I = π f C Vpp.
        tuple((v / 2, np.pi * 300 * c * v) for v, c in
              ((50, 680e-9), (100, 330e-9), (150, 150e-9), (200, 100e-9))),
        None,
        "data sheet SLOS751D, features: 680 nF at 50 V, 330 nF at 100 V, 150 nF at 150 V, 100 nF "
        "at 200 V peak to peak, all at 300 Hz; the currents follow from these",
    ),
    AmplifierPart(
        "power operational amplifier",
        "TI OPA549",
        ((25.0, 10.0),),
        9e6,
        "data sheet SBOS093E: ±30 V supply less 4.8 V at 8 A, 10 A peak, 9 V/µs",
    ),
    AmplifierPart(
        "piezo amplifier for the laboratory",
        "PiezoDrive PD200X4",
        # Power bandwidths at 100 nF, 56, 27 and 13 kHz at 100, 150 and 200 V peak to peak.
        tuple((v / 2, np.pi * f * 100e-9 * v) for v, f in ((100, 56e3), (150, 27e3), (200, 13e3))),
        150e6,
        "manual of 13/01/2021: 150 V/µs; power bandwidth at 100 nF of 56 kHz at 100 V, 27 kHz at "
        "150 V, 13 kHz at 200 V peak to peak; the currents follow from these",
    ),
)  # fmt: skip
"""A part for each class, as an example of it and no recommendation."""


@dataclass(frozen=True)
class AmplifierCheck:
    """True where a part can drive the load, and what it would give or lacks, in words."""

    kind: str
    part: str
    suffices: bool
    why: str
    source: str


@dataclass(frozen=True)
class ElectricalLoad:
    """Load that a plate without a finger, which is when it takes most, is for its amplifier.

    Amplitudes are zero-to-peak. `capacitance` is that of the electrodes beside the mode (None where
    the mode has no circuit), `channels` how many ceramics are driven, in parallel; what is `per
    channel` is their mean. `parallel_inductance` takes the reactive current away, so that the
    amplifier gives `matched_current` at the same voltage; `series_inductance` takes the reactive
    voltage away, so that it gives the same current at `matched_voltage`; both are None where the
    load is not capacitive at this frequency.
    """

    frequency: si.Hertz
    voltage: si.Volt
    capacitance: si.Farad | None
    current: si.Ampere
    apparent_power: Annotated[float, si.Unit("VA")]
    real_power: si.Watt
    power_factor: si.Dimensionless
    slew_rate: si.VoltPerSecond
    parallel_inductance: si.Henry | None
    matched_current: si.Ampere
    series_inductance: si.Henry | None
    matched_voltage: si.Volt
    channels: int
    current_per_channel: si.Ampere
    capacitance_per_channel: si.Farad | None
    amplifiers: tuple[AmplifierCheck, ...]
    assumed: str = ""


@si.checked_numbers
def electrical_load(
    response: DrivenResponse,
    voltage: Annotated[si.Volt, si.AtLeast(0)],
    frequency: Annotated[si.Hertz, si.Above(0)],
    *,
    circuit: EquivalentCircuit | None = None,
    channels: Annotated[int, si.AtLeast(1)] = 1,
) -> ElectricalLoad:
    """The load of a body at a voltage amplitude (V) and a frequency (Hz) of its response; `circuit`
    is that of its mode, where it is known.

    The admittance Y is interpolated between the response's frequencies. I = |Y| V; L parallel =
    1 / (ω Im Y), L series = −Im(1/Y) / ω; a sine's steepest slope is ω V. Raises `OutOfRangeError`
    for a frequency outside the response.
    """
    known = response.frequencies
    if not known[0] <= frequency <= known[-1]:
        low, high, asked = (
            si.format_quantity(float(f), si.Unit("Hz")) for f in (known[0], known[-1], frequency)
        )
        raise OutOfRangeError(
            f"the admittance at {asked} is not known: the response was solved from {low} to {high}"
        )
    omega = 2 * np.pi * frequency
    Y = complex(np.interp(frequency, known, response.admittance))
    Z = 1 / Y
    current, slew = abs(Y) * voltage, omega * voltage
    capacitive = Y.imag > 0
    capacitance = None if circuit is None else circuit.static_capacitance
    return ElectricalLoad(
        frequency=frequency,
        voltage=voltage,
        capacitance=capacitance,
        current=current,
        apparent_power=current * voltage / 2,
        real_power=Y.real * voltage**2 / 2,
        power_factor=Y.real / abs(Y),
        slew_rate=slew,
        parallel_inductance=1 / (omega * Y.imag) if capacitive else None,
        matched_current=Y.real * voltage if capacitive else current,
        series_inductance=-Z.imag / omega if capacitive else None,
        matched_voltage=current * Z.real if capacitive else voltage,
        channels=channels,
        current_per_channel=current / channels,
        capacitance_per_channel=None if capacitance is None else capacitance / channels,
        amplifiers=tuple(
            amplifier_check(amplifier, voltage, current, slew) for amplifier in AMPLIFIERS
        ),
    )


@si.checked_numbers
def load_of_mode(
    actuator: Actuator, mode: WorkingMode, voltage: si.Volt | None, frequency: si.Hertz
) -> ElectricalLoad | None:
    """The load of a display's plate, disc or stator at a voltage (V) and a drive frequency (Hz).

    A disc's admittance is that of the harmonics that it drives most, within 5 % of that of all; a
    stator's is one channel's of the body that was fitted to it (see `fit_stator`), its motion as
    measured. None where there is no voltage, no admittance was solved (a beam, a stator that
    nothing fits), or none near this frequency.
    """
    if voltage is None:
        return None
    if isinstance(actuator, AnnularStator | DiscPlate):
        try:
            ring = ring_admittance(actuator)
            load = electrical_load(ring, voltage, frequency, circuit=ring.circuit)
        except (OutOfRangeError, UnreachableError):
            return None
        return replace(load, assumed=ring.assumed)
    if mode.solid is None:
        return None
    solid = mode.solid
    try:
        return electrical_load(
            solid.response,
            voltage,
            frequency,
            circuit=solid.circuit,
            channels=driven_ceramics(actuator),
        )
    except OutOfRangeError:
        return None


_FITTED = (
    "one channel of a stator whose ceramic, materials and thickness are assumed, and fitted to its "
    "frequency; its motion is as measured"
)


@dataclass(frozen=True, eq=False)
class RingAdmittance(DrivenResponse):
    """The admittance (S) of a disc or of one channel of a stator around its working mode, the
    circuit (None where the channel does not drive the mode), and what of it is assumed."""

    frequencies: si.HertzArray
    admittance: si.ComplexArray
    circuit: EquivalentCircuit | None
    assumed: str = field(default="")


@functools.lru_cache(maxsize=8)
def ring_admittance(actuator: AnnularStator | DiscPlate) -> RingAdmittance:
    """The admittance of a disc or a stator from 8 bandwidths below its working mode to 8 above.

    Takes 0.1 to 0.6 s, and for a stator 3 s to fit it (processor time, presets). Raises
    `UnreachableError` for a stator that nothing fits.
    """
    body = ring_body(actuator)
    mode = body.mode()
    f = response_frequencies(mode.frequency, mode.quality_factor)
    # The mode's harmonic, and those up to three times it that hold a twentieth of its charge.
    own = mode.harmonic
    shares = [abs(body.drive.coefficient(m)) ** 2 for m in range(3 * own + 3)]
    admittance = annular_admittance(
        body.section,
        body.drive,
        f,
        harmonics=[m for m, part in enumerate(shares) if m == own or part > 0.05 * shares[own]],
        quality_factor=body.quality_factor,
    )
    if not body.drives(mode):
        return RingAdmittance(f, admittance, None)
    branch, assumed = modal_circuit(body, mode), ""
    if isinstance(actuator, AnnularStator):
        measured = actuator.reference_amplitude / actuator.reference_voltage
        # The current of motion is in proportion to the force squared, and the motion to the force:
        # a ceramic that moves the ring less takes so much less current for it, in all modes alike.
        share = (measured / mode.amplitude_per_volt(body.drive)) ** 2
        branch = replace(
            branch,
            motional_resistance=branch.motional_resistance / share,
            motional_inductance=branch.motional_inductance / share,
            motional_capacitance=branch.motional_capacitance * share,
        )
        held = 2j * np.pi * f * clamped_capacitance(body.section, body.drive)
        admittance = np.asarray(held + share * (admittance - held), dtype=complex)
        assumed = _FITTED
    bare = RingAdmittance(f, admittance, None, assumed)
    return replace(bare, circuit=with_static_capacitance(branch, bare))


def driven_ceramics(plate: RectangularPlate) -> int:
    """Number of ceramics of a plate that the amplifier drives, all in parallel."""
    return sum(patch.electrode == "driven" for patch in plate.patches)


@si.checked_numbers
def amplifier_check(
    amplifier: AmplifierPart, voltage: si.Volt, current: si.Ampere, slew_rate: si.VoltPerSecond
) -> AmplifierCheck:
    """Check that an amplifier gives a voltage and a current amplitude (V, A) with a slope (V/s)."""

    def said(value: float, unit: str) -> str:
        return si.format_quantity(value, si.Unit(unit), 3)

    def answer(suffices: bool, why: str) -> AmplifierCheck:
        return AmplifierCheck(amplifier.kind, amplifier.part, suffices, why, amplifier.source)

    most = amplifier.ranges[-1][0]
    enough = [amps for volts, amps in amplifier.ranges if volts >= voltage]
    if not enough:
        return answer(False, f"gives {said(most, 'V')} at most, and {said(voltage, 'V')} is wanted")
    wanted = f"{said(current, 'A')} is wanted at {said(voltage, 'V')}"
    if enough[0] < current:
        return answer(False, f"gives {said(enough[0], 'A')}, and {wanted}")
    if amplifier.slew_rate is not None and amplifier.slew_rate < slew_rate:
        fast = f"{amplifier.slew_rate / 1e6:.3g} V/µs"
        return answer(False, f"gives {fast}, and {slew_rate / 1e6:.3g} V/µs is wanted")
    return answer(True, f"gives {said(enough[0], 'A')}, and {wanted}")
