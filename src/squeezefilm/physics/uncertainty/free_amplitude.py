"""The amplitude of a display that is not quite the described one, without solving it anew."""

from __future__ import annotations

import dataclasses
import functools
import math
import warnings
from collections.abc import Iterator
from operator import attrgetter
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plate.layout import (
    Actuator,
    AnnularStator,
    DiscPlate,
    RectangularPlate,
)
from squeezefilm.physics.plate.working_mode import working_mode
from squeezefilm.physics.uncertainty.parameters import made_with, number_paths

# What a rectangular plate is beside its layout; how much each moves it is asked for once.
_MADE_OF = ("substrate", "ceramic", "glue", "quality_factor")
_CONSTANTS = "ceramic.constants."
# How far the discs are from the described one that say how each number moves the amplitude.
_APART = 1.1


def require_bent(display: Display, prediction: Prediction) -> None:
    """Raise `OutOfRangeError` for a rectangular plate whose drive does not bend it: how its
    amplitude changes with what it is made of is not known."""
    if prediction.voltage is not None and isinstance(display.actuator, RectangularPlate):
        beam_response(display.actuator).require_driven()


class FreeAmplitude:
    """The amplitude (m) without a finger of a display with other values, from a prediction's; where
    an amplitude was given, that one.

    What a plate or disc is made of moves it constant by constant, as three beams or three solved
    discs say (`_moved`), a disc's dimensions likewise; a rectangular plate's layout moves it as a
    beam's would, Q and an uncertain voltage in proportion.
    """

    def __init__(self, display: Display, prediction: Prediction) -> None:
        require_bent(display, prediction)
        self.nominal, self.prediction = display, prediction
        self.free = prediction.held_amplitude
        self.reference = self._per_volt(display.actuator) if prediction.voltage is not None else 1.0
        self._curves: dict[str, tuple[float, float]] = {}
        self._last: tuple[Actuator, float] = display.actuator, 1.0

    def __call__(self, display: Display) -> si.Metre:
        """The amplitude of a display (m)."""
        here = display.actuator
        # Draws one after the other often have the same.
        if here is not self._last[0]:
            self._last = here, self._share(here)
        return self.free * self._volts(display) * self._last[1]

    def _share(self, here: Actuator) -> float:
        """The amplitude with an actuator over that with the described one."""
        nominal = self.nominal.actuator
        if self.prediction.voltage is None or here == nominal:
            return 1.0
        values = _values(here, nominal, self._paths)
        share = math.prod(self._moved(path, value) for path, value in values)
        if isinstance(here, RectangularPlate):
            as_made: dict[str, Any] = {name: getattr(nominal, name) for name in _MADE_OF}
            laid_out = dataclasses.replace(here, **as_made)
            if laid_out != nominal:
                share *= self._per_volt(laid_out) / self.reference
        return share

    def _volts(self, display: Display) -> float:
        """An uncertain drive in proportion; a voltage asked for stands as it is."""
        if self.prediction.voltage is None or self.nominal.drive.voltage == 0:
            return 1.0
        return display.drive.voltage / self.nominal.drive.voltage

    @functools.cached_property
    def _paths(self) -> tuple[str, ...]:
        """The numbers of the actuator that move it one by one, by their dotted paths."""
        actuator = self.nominal.actuator
        paths = number_paths(actuator)
        if isinstance(actuator, RectangularPlate):
            paths = (path for path in paths if path.split(".")[0] in _MADE_OF)
        return tuple(path for path in paths if attrgetter(path)(actuator))

    def _moved(self, path: str, value: float) -> float:
        """Factor by which one number alone moves the amplitude per volt: a parabola in logarithms
        through beams or discs with 10 % less, as described and with 10 % more. A disc for every
        draw would take minutes; a tenth off in all numbers at once they differ by some per cent."""
        actuator = self.nominal.actuator
        nominal = attrgetter(path)(actuator)
        if value == nominal:
            return 1.0
        if path == "quality_factor":
            # At resonance, in proportion; a stator's amplitude is measured, whatever its Q.
            return 1.0 if isinstance(actuator, AnnularStator) else value / nominal
        if path not in self._curves:
            less, more = (
                math.log(self._per_volt(made_with(actuator, {path: share * nominal})))
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


def _values(
    here: Actuator, nominal: Actuator, paths: tuple[str, ...]
) -> Iterator[tuple[str, float]]:
    """The values at paths. Of a ceramic's full constants what went along with its in-plane
    stiffness or its d31 counts with these, and what of a disc went along with its diameter."""
    with_it = {"compliance": 1.0, "charge": 1.0}
    if any(path.startswith(_CONSTANTS) for path in paths):
        now, then = (attrgetter("ceramic")(plate) for plate in (here, nominal))
        with_it["compliance"] = then.in_plane_stiffness / now.in_plane_stiffness
        with_it["charge"] = now.charge_coefficient / then.charge_coefficient
    if isinstance(here, DiscPlate) and isinstance(nominal, DiscPlate):
        with_it["diameter"] = here.diameter / nominal.diameter
    for path in paths:
        value, own = attrgetter(path)(here), attrgetter(path)(nominal)
        is_diameter = path.endswith("_diameter")
        if path.startswith(_CONSTANTS) or is_diameter:
            kind = "diameter" if is_diameter else path.removeprefix(_CONSTANTS).split("_")[0]
            alone = own if value is None else value / with_it.get(kind, 1.0)
            value = own if math.isclose(alone, own, rel_tol=1e-9) else alone
        yield path, value
