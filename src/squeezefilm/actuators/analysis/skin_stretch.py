"""Results of `squeezefilm analyze` for a skin-stretch array."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from squeezefilm.actuators.analysis.drawn import DrawnAnswers, Usual, drawn_answers
from squeezefilm.actuators.skin_stretch.array import (
    ArrayPull,
    Lines,
    SkinStretchArray,
    SkinStretchDescription,
    charging_power,
    lines_needed,
    loss_power,
)
from squeezefilm.actuators.skin_stretch.bimorph import LoadedTip, loaded_tip, tip_motion
from squeezefilm.actuators.skin_stretch.cradle import (
    Seating,
    finest_period,
    force_for_all,
    pattern_voltages,
    radii_that_touch_all,
    seat,
)
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import UnreachableError
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import Result, values_of
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.render.texture.shapes import SineWave

# The wave that is shown: so many of the finest periods long, and so many steps of it.
_LONG, _FRAMES, _SETTLED = 2.0, 24, 5
_SHOWN_SPEED: si.MetrePerSecond = 0.05
_FREQUENCIES = 300
# What a maker chooses, such as a length, is not uncertain; what he gets and what skin is, are.
_USUAL = {
    "skin_stretch.actuator.ceramic.charge_coefficient": Usual(
        0.8, 1.2, "makers grant ±20 % on d33 (APC International); all d together"
    ),
    "skin_stretch.actuator.ceramic_thickness": Usual(0.95, 1.05, "ceramic as it is sold; assumed"),
    "skin_stretch.actuator.length": Usual(0.98, 1.02, "as clamped; assumed"),
    "skin_stretch.tissue.shear_modulus": Usual(
        0.4, 1.6, "implied by the paper's figures; skins differ by more than twice; a guess"
    ),
    "skin_stretch.tissue.thickness": Usual(0.6, 1.4, "pulp of a finger; a guess"),
    "skin_stretch.tissue.poisson_ratio": Usual(0.92, 1.04, "0.44 to 0.5; a guess", 0.499),
}
_WAYS: tuple[Lines, ...] = ("direct", "matrix", "daisy_chain")


@dataclass(frozen=True, eq=False)
class ShownWave:
    """A sinusoidal texture that moves over the finger, its period two of the finest: `strain` ε_xx
    in cells between `edges_x` and `edges_y`, shape (frames, cells x, cells y), at `times`, and the
    skin's `displacements` under the contactors and which of these slip, shape (frames, contactors);
    `pull` is the array at the first."""

    period: si.Metre
    speed: si.MetrePerSecond
    times: si.SecondArray
    edges_x: si.MetreArray
    edges_y: si.MetreArray
    strain: si.FloatArray
    displacements: si.MetreArray
    slips: np.ndarray[tuple[int, ...], np.dtype[np.bool]]
    pull: ArrayPull


@dataclass(frozen=True, eq=False, repr=False)
class SkinStretchAnalysis(Result):
    """An array at its voltage.

    Attributes:
        described: the array as its file describes it.
        voltage: on each actuator, either way.
        skin: what one contactor alone meets.
        tip: one actuator against it, quasi-static and its resonance.
        frequencies, motion: of a sinusoidal voltage, and the tip's amplitude.
        together: all actuators at the voltage, pulling the same way.
        seating: the finger on the cradle under its force.
        least_force: under which all contactors touch; None where some never do.
        radii: across, of cradles on which all touch under the finger's force; None where none.
        wave: a texture that moves over the finger.
        drawn: deflections, forces and crosstalk where what is uncertain is drawn together.
        warnings: in sentences.
    """

    described: SkinStretchDescription
    voltage: si.Volt
    skin: FingerpadDynamics
    tip: LoadedTip
    frequencies: si.HertzArray
    motion: si.ComplexArray
    together: ArrayPull
    seating: Seating
    least_force: si.Newton | None
    radii: tuple[si.Metre, si.Metre] | None
    wave: ShownWave
    drawn: DrawnAnswers
    warnings: tuple[str, ...]
    _shown: ClassVar[str] = "described.name voltage free_deflection blocked_force"

    @property
    def array(self) -> SkinStretchArray:
        """Array that is described."""
        return self.described.skin_stretch

    @property
    def free_deflection(self) -> si.Metre:
        """Free deflection of one actuator at the voltage (m)."""
        return self.voltage * self.array.bender.deflection_per_volt

    @property
    def blocked_force(self) -> si.Newton:
        """Blocked force of one actuator at the voltage (N)."""
        return self.voltage * self.array.bender.force_per_volt

    @property
    def power(self) -> tuple[si.Watt, si.Watt]:
        """Power at 100 Hz, all actuators: the heat in the ceramics of a sine, and what drivers burn
        that swing the whole voltage and recover none of it (W)."""
        array = self.array
        heat = loss_power(array.actuator, array.bender, self.voltage, 100.0)
        return array.cradle.count * heat, charging_power(
            array.bender, array.cradle.count, self.voltage, 100.0
        )

    @property
    def lines(self) -> dict[str, int]:
        """Wires to the array, by how it is wired."""
        return {way: lines_needed(self.array.cradle.count, way) for way in _WAYS}

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values, with units in the keys."""
        array, budget = self.array, self.array.budget
        heat, driven = self.power
        return {
            "actuator": self.described.name,
            "kind": "skin_stretch",
            "actuators": array.cradle.count,
            **values_of(
                self,
                "voltage array.actuator.largest_voltage free_deflection blocked_force "
                "array.bender.resonance_frequency array.crosstalk lines drawn warnings",
            ),
            "deflection_on_skin_m": self.tip.deflection,
            "force_on_skin_N": self.tip.force,
            "skin_stiffness_N_per_m": self.skin.stiffness,
            "resonance_frequency_on_skin_Hz": self.tip.resonance_frequency,
            "bandwidth_on_skin_Hz": self.tip.bandwidth,
            "all_together_mean_displacement_m": float(np.mean(self.together.displacements)),
            "contactors_that_slip_together": self.together.slipping,
            "contactors_that_slip_in_the_wave": self.wave.pull.slipping,
            "largest_strain_of_the_wave": float(np.max(np.abs(self.wave.strain))),
            "finest_period_along_m": finest_period(array.cradle),
            "contactors_that_touch": self.seating.touching,
            "normal_force_for_all_N": self.least_force,
            "cradle_radii_across_m": None if self.radii is None else list(self.radii),
            "mass_of_actuators_kg": budget.mass,
            "volume_of_actuators_m3": budget.volume,
            "active_area_m2": budget.area,
            "heat_at_100_Hz_W": heat,
            "driver_power_at_100_Hz_W": driven,
        }


@si.checked_numbers
def analyze_skin_stretch(
    described: SkinStretchDescription,
    *,
    voltage: Annotated[si.Volt, si.Above(0.0)] | None = None,
    progress: SayProgress | None = None,
) -> SkinStretchAnalysis:
    """A described array at a voltage (V, on each actuator, either way; if None the largest that its
    ceramics bear): one actuator on the skin, all of them together, the finger on the cradle, and a
    texture that moves over it.

    Quasi-static but for the tip's resonance; skin linear, contactors stick or slip. Raises
    `OutOfRangeError` for a voltage that undoes the poling, `UnreachableError`
    for a finger that no force seats.
    """
    tell = progress or (lambda _: None)
    array = described.skin_stretch
    volts = array.actuator.largest_voltage if voltage is None else voltage
    array.actuator.require_voltage(volts)
    tell("one actuator")
    skin = array.tissue.under_contactor(*array.cradle.size)
    tip = loaded_tip(array.bender, skin, volts)
    frequencies = np.geomspace(1.0, 5 * tip.resonance_frequency, _FREQUENCIES)
    motion = tip_motion(array.bender, skin, volts, frequencies)
    tell("all together")
    together = array.answer(np.full(array.cradle.count, volts))
    seating = seat(array.cradle, array.finger, array.pulp, array.normal_force)
    tell("the cradle")
    least, radii = _cradle(array)
    tell("a texture")
    wave = _wave(array, volts)
    tell("how sure that is")
    sure = drawn_answers(
        described,
        described.provenance,
        _USUAL,
        lambda drawn: _answers(drawn, volts),
        progress=lambda done, of: None if done % 16 else tell(f"{done} of {of} draws"),
    )
    warnings = tuple(_warnings(array, together, wave, seating, least))
    return SkinStretchAnalysis(
        described,
        volts,
        skin,
        tip,
        frequencies,
        motion,
        together,
        seating,
        least,
        radii,
        wave,
        sure,
        warnings,
    )


def _cradle(
    array: SkinStretchArray,
) -> tuple[si.Newton | None, tuple[si.Metre, si.Metre] | None]:
    cradle, finger, pulp = array.cradle, array.finger, array.pulp
    least, radii = None, None
    try:
        least = force_for_all(cradle, finger, pulp)
        radii = radii_that_touch_all(cradle, finger, pulp, array.normal_force)
    except UnreachableError:
        pass
    return least, radii


def _wave(array: SkinStretchArray, voltage: si.Volt) -> ShownWave:
    period = _LONG * finest_period(array.cradle)
    times = np.arange(_FRAMES) / _FRAMES * period / _SHOWN_SPEED
    driven = pattern_voltages(SineWave(period), array.cradle, times, (_SHOWN_SPEED, 0.0), voltage)
    x, y, per_force = array.strain_per_force()
    # What slides at first settles by a fourth with each period: the last of six is shown.
    pulls = array.answers(np.tile(driven, (_SETTLED + 1, 1)))[-_FRAMES:]
    strain = np.moveaxis(per_force[0] @ np.array([pull.forces for pull in pulls]).T, -1, 0)
    moved, slips = np.array([pull.displacements for pull in pulls]), [pull.slips for pull in pulls]
    return ShownWave(period, _SHOWN_SPEED, times, x, y, strain, moved, np.array(slips), pulls[0])


def _answers(described: SkinStretchDescription, voltage: si.Volt) -> Mapping[str, float]:
    array = described.skin_stretch
    skin = array.tissue.under_contactor(*array.cradle.size)
    tip = loaded_tip(array.bender, skin, voltage)
    return {
        "skin_stiffness_N_per_m": skin.stiffness,
        "free_deflection_m": voltage * array.bender.deflection_per_volt,
        "blocked_force_N": voltage * array.bender.force_per_volt,
        "deflection_on_skin_m": tip.deflection,
        "force_on_skin_N": tip.force,
        "crosstalk": array.crosstalk,
    }


def _warnings(
    array: SkinStretchArray,
    together: ArrayPull,
    wave: ShownWave,
    seating: Seating,
    least: si.Newton | None,
) -> list[str]:
    count, said = array.cradle.count, list(array.budget.over)
    for pull, doing in ((together, "all pull the same way"), (wave.pull, "the wave moves past")):
        if pull.slipping:
            said.append(
                f"{pull.slipping} of {count} contactors slip where {doing}: they pull no harder "
                "than their friction, and less of the pattern comes through."
            )
    if seating.touching < count:
        needs = "No force" if least is None else f"{least:.2g} N"
        said.append(
            f"{seating.touching} of {count} contactors touch under {array.normal_force:g} N; "
            f"{needs} would seat all."
        )
    return said
