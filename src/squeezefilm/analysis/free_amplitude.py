"""The amplitude of a display that is not quite the described one, without solving it anew."""

from __future__ import annotations

import dataclasses
import functools
import math
import warnings
from operator import attrgetter

from squeezefilm import quantities as si
from squeezefilm.analysis.parameters import number_paths, with_values
from squeezefilm.chain.prediction import Prediction
from squeezefilm.display import Display
from squeezefilm.plate.beam.response import beam_response
from squeezefilm.plate.layout import Actuator, AnnularStator, RectangularPlate
from squeezefilm.plate.working_mode import working_mode

# How far the discs are from the described one that say how each number moves the amplitude.
_APART = 1.1


class FreeAmplitude:
    """The amplitude (m) without a finger of a display with other values, from a prediction's.

    A rectangular plate's own dimensions and constants move it as a beam's would, a disc's each by
    itself as three solved discs say (`_moved`), Q and an uncertain voltage in proportion.
    """

    def __init__(self, display: Display, prediction: Prediction) -> None:
        self.nominal, self.prediction = display, prediction
        self.free = prediction.touch.free_amplitude
        self.reference = self._per_volt(display.actuator) if prediction.voltage is not None else 1.0
        self._curves: dict[str, tuple[float, float]] = {}

    def __call__(self, display: Display) -> si.Metre:
        """The amplitude of a display (m)."""
        free = self.free * self._volts(display)
        here, nominal = display.actuator, self.nominal.actuator
        if self.prediction.voltage is None or here == nominal:
            return free
        if dataclasses.replace(here, quality_factor=nominal.quality_factor) == nominal:
            # At resonance, in proportion; a stator's amplitude is measured, whatever its Q.
            measured = isinstance(here, AnnularStator)
            return free * (1 if measured else here.quality_factor / nominal.quality_factor)
        if isinstance(here, RectangularPlate):
            return free * self._per_volt(here) / self.reference
        values = [(path, attrgetter(path)(here)) for path in self._paths]
        return free * math.prod(self._moved(path, value) for path, value in values)

    def _volts(self, display: Display) -> float:
        """An uncertain drive in proportion; a voltage asked for stands as it is."""
        if self.prediction.voltage is None or self.nominal.drive.voltage == 0:
            return 1.0
        return display.drive.voltage / self.nominal.drive.voltage

    @functools.cached_property
    def _paths(self) -> tuple[str, ...]:
        """The numbers of the actuator, by their dotted paths."""
        actuator = self.nominal.actuator
        return tuple(path for path in number_paths(actuator) if attrgetter(path)(actuator))

    def _moved(self, path: str, value: float) -> float:
        """By how much one number alone moves the amplitude per volt: a parabola in logarithms
        through discs with 10 % less, as described and with 10 % more. A solve for every draw would
        take minutes; at a tenth off in all numbers at once they differ by some per cent."""
        actuator = self.nominal.actuator
        nominal = attrgetter(path)(actuator)
        if value == nominal:
            return 1.0
        if path not in self._curves:
            less, more = (
                math.log(self._per_volt(with_values(actuator, {path: share * nominal})))
                - math.log(self.reference)
                for share in (1 / _APART, _APART)
            )
            step = math.log(_APART)
            self._curves[path] = (more - less) / (2 * step), (more + less) / (2 * step**2)
        slope, bend = self._curves[path]
        off = math.log(value / nominal)
        return math.exp(slope * off + bend * off**2)

    @staticmethod
    # Every question of an analysis asks for the same discs.
    @functools.lru_cache(maxsize=256)
    def _per_volt(actuator: Actuator) -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if isinstance(actuator, RectangularPlate):
                return beam_response(actuator).amplitude_per_volt
            return working_mode(actuator).amplitude_per_volt
