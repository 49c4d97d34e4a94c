"""Plate, film and finger of a display's description: the constants of a twin's plant."""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.instruments.control.gains import IdentifiedPlate
from squeezefilm.instruments.twin.settings import PickupModel, TwinSettings
from squeezefilm.physics.chain.area_map import at_best_place
from squeezefilm.physics.chain.friction import TABLE_SPEEDS, friction_law
from squeezefilm.physics.chain.touch import chosen_mode, load_ratios
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.beam_response import patch_capacitance
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.working_mode import WorkingMode
from squeezefilm.physics.plausibility.checks import require_plausible

_log = logging.getLogger(__name__)

FORCES: si.FloatArray = np.array([0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.5, 2.5, 5.0])
"""Normal forces (N) at which friction and load are tabulated; linear between, held beyond."""
POINTS = 129
_SOLVERS = 1e-7
OTHER_CAPACITANCE: si.Farad = 20e-9
"""Where neither settings nor layout say (assumed)."""
OTHER_COUPLING = 0.1
"""Effective coupling coefficient where the modal mass is not known (assumed)."""


@dataclass(frozen=True, eq=False)
class WorkingPoint:
    """A display's working mode and what finger and film do on it, over force, amplitude and the
    skin's speed.

    Attributes:
        display, mode: what it is of.
        forces: of the tables' rows (N), shape (m,).
        speeds: of the skin, for its friction (m/s), shape (k,), from 0 and held beyond the last;
            one where the law does not depend on it.
        highest_amplitude: of the tables' last column (m); column j is at (j/(n−1))² of it.
        relative_friction: µ′/µ, shape (m, k, n).
        load: δ, the finger's modal stiffness over the mode's own, shape (m, n).
        capacitance: of the plate held still (F).
        force_factor: modal force per volt (N/V), which is charge per amplitude (C/m) by
            reciprocity.
        evidence: what of these was assumed.
    """

    display: Display
    mode: WorkingMode
    forces: si.NewtonArray
    speeds: si.MetrePerSecondArray
    highest_amplitude: si.Metre
    relative_friction: si.DimensionlessArray
    load: si.ComplexArray
    capacitance: si.Farad
    force_factor: si.NewtonPerVolt
    evidence: tuple[str, ...]

    @property
    def amplitudes(self) -> si.FloatArray:
        """Amplitudes of the tables' columns (m)."""
        count = self.load.shape[1]
        return np.asarray(self.highest_amplitude * (np.arange(count) / (count - 1)) ** 2)

    def pickup_calibration(self, pickup: PickupModel) -> si.MetrePerVolt:
        """Vibration amplitude per signal of a pickup (m/V), at the predicted resonance."""
        if pickup.kind == "sensing_patch":
            return 1 / pickup.sensitivity
        omega = 2 * math.pi * self.mode.resonance_frequency
        return 1 / (omega * self.force_factor * pickup.shunt)

    def identified(self, settings: TwinSettings) -> IdentifiedPlate:
        """Plate that a sweep of the twin before its drift would identify, for `loop_gains`.

        Raises `InputError` for a plate or a pickup that no loop can use.
        """
        mode = self.mode
        ratio = mode.amplitude_per_volt / self.pickup_calibration(settings.pickup)
        ratio *= settings.amplifier.gain
        return IdentifiedPlate(mode.resonance_frequency, mode.quality_factor, ratio)


def working_point(
    display: Display, settings: TwinSettings, mode: WorkingMode | None = None
) -> WorkingPoint:
    """The working point of a display; solves its plate (seconds) unless a `mode` is given.

    Where a plate's working mode cannot be found in three dimensions a beam's is taken, as
    `predict` does. Raises what these raise, and `InputError` for a mode without amplitude.
    """
    evidence: list[str] = []
    if mode is None:
        evidence += require_plausible(display)
        mode, objections = chosen_mode(display.actuator)
        evidence += objections
    if not mode.amplitude_per_volt > 0 or display.drive.voltage <= 0:
        raise InputError(
            f"the display '{display.name}' has no amplitude at {display.drive.voltage:g} V; a twin "
            "needs a drive voltage above 0 and a mode that it moves"
        )
    highest = mode.amplitude_per_volt * display.drive.voltage * settings.highest_amplitude_ratio
    highest, speeds, friction, load = _tables(display, mode, highest)
    capacitance = settings.amplifier.capacitance
    if capacitance is None and isinstance(display.actuator, RectangularPlate):
        capacitance = patch_capacitance(display.actuator)
    elif capacitance is None:
        capacitance = OTHER_CAPACITANCE
        evidence.append(f"capacitance assumed: {si.format_quantity(capacitance, si.Unit('F'))}")
    omega = 2 * math.pi * mode.resonance_frequency
    if mode.modal_mass is not None:
        factor = mode.amplitude_per_volt * mode.modal_mass * omega**2 / mode.quality_factor
    else:
        motional = capacitance * OTHER_COUPLING**2 / (1 - OTHER_COUPLING**2)
        factor = motional * mode.quality_factor / mode.amplitude_per_volt
        evidence.append(
            "modal mass not known: the finger takes nothing from the vibration, and the motional "
            f"current is that of a coupling coefficient of {OTHER_COUPLING:g} (assumed)"
        )
    for line in evidence:
        _log.info("twin of %s: %s", display.name, line)
    return WorkingPoint(
        display, mode, FORCES, speeds, highest, friction, load, capacitance, factor, tuple(evidence)
    )


def _tables(
    display: Display, mode: WorkingMode, highest: si.Metre
) -> tuple[si.Metre, si.MetrePerSecondArray, si.DimensionlessArray, si.ComplexArray]:
    """Speeds, friction over them, and load, up to the amplitude that can be solved, at most
    `highest`; the amplitude first. The pad is where `predict` has it, as described and driven."""
    half, frequency = mode.half_wavelength, mode.resonance_frequency
    law = friction_law(display, half, frequency)
    place = at_best_place(display, mode, law).place
    for _ in range(12):
        grid = highest * (np.arange(POINTS) / (POINTS - 1)) ** 2
        try:
            laws = [
                friction_law(display, half, frequency, normal_force=float(force), place=place)
                for force in FORCES
            ]
            speeds = TABLE_SPEEDS if laws[0].kind.fitted else np.zeros(1)
            friction = np.stack([law.over_speeds(grid, speeds) for law in laws])
            # Where the law holds nothing at rest, nothing shall: not what its solver leaves.
            friction = np.clip(np.where(friction < _SOLVERS, 0.0, friction), 0.0, 1.0)
            load = np.stack([load_ratios(mode, law, grid) for law in laws])
            return highest, speeds, friction, np.ascontiguousarray(load)
        except OutOfRangeError as error:
            # So strong a vibration closes the gap somewhere; the table ends below it.
            _log.info("tables to %.3g m do not hold (%s); they end lower", highest, error)
            highest *= 0.7
    raise OutOfRangeError(
        f"no friction law could be tabulated for '{display.name}'; its gap closes at "
        f"{si.format_quantity(highest, si.Unit('m'))} already"
    )
