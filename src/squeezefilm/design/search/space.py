"""The numbers that a search may choose, and a choice of them."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

# By so many grains a neighbour differs from a design, in one value.
_GRAINS_BESIDE = (-10, -3, -1, 1, 3, 10)
# How far a neighbour moves along a range, and how often it takes another step or name.
_STEP, _JUMP, _NEAR_BY = 0.06, 0.12, 0.2

VOLTAGE = "voltage"
"""The one variable, of every shape, that is set and not built."""

Setting = float | int | str
Values = Mapping[str, Setting]


@dataclass(frozen=True)
class Number:
    """A length or a voltage between `low` and `high` (SI), equal ends where it is fixed; in whole
    multiples of a `grain`, as one builds and sets it, but for the ends."""

    name: str
    low: float
    high: float
    unit: si.Unit
    grain: float

    @property
    def is_fixed(self) -> bool:
        """True where there is nothing to choose."""
        return self.low == self.high

    def at(self, share: float, chosen: Values) -> float:
        """The value at a share of the way from `low` to `high`, from 0 to 1."""
        value = round((self.low + share * (self.high - self.low)) / self.grain) * self.grain
        return min(max(value, self.low), self.high)

    def share(self, values: Values) -> float:
        """Position of a design's value, from 0 to 1: what distances are measured in."""
        return (float(values[self.name]) - self.low) / (self.high - self.low)

    def place(self, values: Values) -> float:
        """A share from which `at` makes the value of a design."""
        return min(max(self.share(values), 0.0), 1.0)


@dataclass(frozen=True)
class Step:
    """Choice of one of rising values (SI), as of counts and stock thicknesses; of the list that
    goes with the name chosen for `by`, where the list depends on one."""

    name: str
    lists: Mapping[str, tuple[float, ...]]
    unit: si.Unit
    by: str = ""

    @property
    def is_fixed(self) -> bool:
        """True where there is nothing to choose."""
        return all(len(values_of_one) == 1 for values_of_one in self.lists.values())

    def _values(self, chosen: Values) -> tuple[float, ...]:
        return self.lists[str(chosen[self.by]) if self.by else ""]

    def at(self, share: float, chosen: Values) -> float:
        """The value at a share of the way through the list, from 0 to 1."""
        values = self._values(chosen)
        return values[min(int(share * len(values)), len(values) - 1)]

    def share(self, values: Values) -> float:
        """Position of a design's value among all that there are, from 0 to 1."""
        every = [value for choices in self.lists.values() for value in choices]
        low, high = min(every), max(every)
        return (float(values[self.name]) - low) / ((high - low) or 1.0)

    def place(self, values: Values) -> float:
        """A share from which `at` makes the value of a design: the middle of its part."""
        known, value = self._values(values), float(values[self.name])
        nearest = min(range(len(known)), key=lambda k: abs(known[k] - value))
        return (nearest + 0.5) / len(known)


@dataclass(frozen=True)
class Choice:
    """Choice of one of several names without an order, as of materials."""

    name: str
    values: tuple[str, ...]

    @property
    def is_fixed(self) -> bool:
        """True where there is nothing to choose."""
        return len(self.values) == 1

    def at(self, share: float, chosen: Values) -> str:
        """The name at a share of the way through the list, from 0 to 1."""
        return self.values[min(int(share * len(self.values)), len(self.values) - 1)]

    def share(self, values: Values) -> float:
        """Position of a design's name in the list, from 0 to 1."""
        return self.values.index(str(values[self.name])) / max(len(self.values) - 1, 1)

    def place(self, values: Values) -> float:
        """A share from which `at` makes the name of a design: the middle of its part."""
        return (self.values.index(str(values[self.name])) + 0.5) / len(self.values)


Variable = Number | Step | Choice


@dataclass(frozen=True)
class Space:
    """Choices of one shape: its name and its variables."""

    shape: str
    variables: tuple[Variable, ...]

    def __iter__(self) -> Iterator[Variable]:
        return iter(self.variables)

    @functools.cached_property
    def free(self) -> tuple[Variable, ...]:
        """The variables with something to choose."""
        return tuple(variable for variable in self.variables if not variable.is_fixed)

    def variable(self, name: str) -> Variable:
        """The variable of a name, which there is."""
        return next(variable for variable in self if variable.name == name)

    def at(self, shares: Mapping[str, float]) -> dict[str, Setting]:
        """The values at shares (0 to 1) by name; what is fixed needs none."""
        chosen: dict[str, Setting] = {}
        for variable in self:
            chosen[variable.name] = variable.at(
                0.0 if variable.is_fixed else shares[variable.name], chosen
            )
        return chosen

    def places(self, values: Values) -> dict[str, float]:
        """Shares from which `at` makes these values, by name, of what is free."""
        return {variable.name: variable.place(values) for variable in self.free}

    def moved(self, places: Mapping[str, float], draw: np.random.Generator) -> dict[str, float]:
        """Places a little beside others: lengths and voltages by some percent of their range, each
        with even odds, steps to one near by or any other now and then, names to any other."""
        beside = dict(places)
        for variable in self.free:
            chance, step = draw.random(), _STEP * draw.standard_normal()
            if isinstance(variable, Number) and chance < 0.5:
                beside[variable.name] = float(np.clip(places[variable.name] + step, 0.0, 1.0))
            elif not isinstance(variable, Number) and chance < _JUMP:
                beside[variable.name] = float(draw.random())
            elif isinstance(variable, Step) and chance < _JUMP + _NEAR_BY:
                beside[variable.name] = float(np.clip(places[variable.name] + 2 * step, 0.0, 1.0))
        return beside

    def beside(self, places: Mapping[str, float]) -> Iterator[dict[str, float]]:
        """Places that differ in one number, by a few of its grains either way: the next that can be
        built and set."""
        for variable in self.free:
            if isinstance(variable, Number):
                for grains in _GRAINS_BESIDE:
                    step = grains * variable.grain / (variable.high - variable.low)
                    yield {
                        **places,
                        variable.name: float(np.clip(places[variable.name] + step, 0.0, 1.0)),
                    }

    def shares(self, values: Values) -> list[float]:
        """Positions of values, each from 0 to 1, of what is free: features of a design."""
        return [variable.share(values) for variable in self.free]


# What a workshop, and whoever sets a voltage, does not go below.
_GRAINS = {"m": 1e-4, "V": 0.1, "1": 0.01}


def number(name: str, low: float, high: float, unit: str) -> Number:
    """A number that may be chosen: lengths to 0.1 mm, voltages to 0.1 V, shares to 1 %.

    Raises `InputError` where its range ends before it begins.
    """
    if high < low:
        symbol = si.Unit(unit)
        first, last = (si.format_quantity(bound, symbol) for bound in (low, high))
        raise InputError(
            f"{name} may be from {first} to {last}, which is no range; make the largest at least "
            "the least",
            quantity=name,
        )
    return Number(name, low, high, si.Unit(unit), _GRAINS[unit])


def step(name: str, lists: Mapping[str, tuple[float, ...]], unit: str, by: str = "") -> Step:
    """Choice of one of a list of values, in rising order, by the name chosen for `by` if any.

    Raises `InputError` for an empty list.
    """
    for of, values in lists.items():
        if not values:
            whose = f" of {of}" if of else ""
            raise InputError(f"{name}{whose} is an empty list; give at least one", quantity=name)
    rising = {of: tuple(sorted(set(values))) for of, values in lists.items()}
    return Step(name, rising, si.Unit(unit), by)
