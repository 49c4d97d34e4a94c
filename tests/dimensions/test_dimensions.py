"""Every closed form, called once with pint quantities built from its own annotations.

The units stand in the types, so nothing is written down twice: a formula whose result has not the
dimension that its signature promises fails here. Misprints of the paper that are kept on purpose
stand in `MISPRINTS`, and each must be *caught*.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import typing
from collections.abc import Callable
from typing import Any

import pint
import pytest

import squeezefilm
from squeezefilm.core.quantities import (
    CLOSED_FORMS,
    Dimensionless,
    Hertz,
    Metre,
    Newton,
    NewtonPerMetre,
    Pascal,
    Unit,
    closed_form,
    unit_of,
)

pint_units: Any = pint.UnitRegistry()

MISPRINTS = {
    "squeezefilm.physics.film.gap.squeeze_number_printed": "eq 4 has l0 where l0² belongs",
}

# A number small enough for every formula's range (ε, δ, Kn, Poisson's ratio …).
SMALL = 0.1

# What a formula needs that 0.1 is outside of.
VALUES: dict[tuple[str, str], float] = {}
DEFAULT_VALUES: dict[str, float] = {
    # Indices and ratios that start at 1.
    "polytropic_exponent": 1.2,
    "mean_pressure": 1.01,
    "quality_factor": 60.0,
    "relative_permittivity": 1000.0,
}

# What must at least be there; a formula that loses its mark would otherwise go unseen.
MINIMUM = {
    f"squeezefilm.{name}"
    for name in (
        "physics.film.gap.film_thickness",
        "physics.film.gap.squeeze_number",
        "physics.film.gap.squeeze_number_printed",
        "physics.film.gap.frequency_for_squeeze_number",
        "physics.film.closed.paper_mean_pressure",
        "physics.film.closed.paper_mean_pressure_printed",
        "physics.film.closed.relative_stiffness",
        "physics.film.closed.relative_damping",
        "physics.film.validity.reduced_reynolds_number",
        "physics.film.validity.knudsen_number",
        "physics.film.validity.crest_squeeze_number",
        "physics.contact.asperities.exponential_pressure",
        "physics.contact.finger.fingertip.skin_displacement_per_friction",
        "physics.plate.beam_modes.euler_bernoulli_frequency",
    )
}


class DimensionMismatchError(AssertionError):
    """A closed form whose result has not the dimension that it promises."""


def import_everything() -> None:
    for module in pkgutil.walk_packages(squeezefilm.__path__, "squeezefilm."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)


import_everything()
SHIPPED = {name: form for name, form in CLOSED_FORMS.items() if name.startswith("squeezefilm.")}


def pint_unit(unit: Unit) -> Any:
    kilogram, metre, second, ampere, kelvin, radian = unit.dimension
    return (
        pint_units.kilogram**kilogram
        * pint_units.metre**metre
        * pint_units.second**second
        * pint_units.ampere**ampere
        * pint_units.kelvin**kelvin
        * pint_units.radian**radian
    )


def example(name: str, parameter: inspect.Parameter, hint: Any) -> Any:
    """A pint quantity (a plain number if dimensionless) for an argument, from its annotation."""
    unit = unit_of(hint)
    assert unit is not None, (
        f"{name}: the argument '{parameter.name}' has neither a unit in its annotation nor a "
        "default; annotate it (`Dimensionless` if it has no unit)"
    )
    value = VALUES.get((name, parameter.name), DEFAULT_VALUES.get(parameter.name, SMALL))
    return value if unit.symbol == "1" else value * pint_unit(unit)


def check(name: str, form: Callable[..., Any]) -> None:
    """Call `form` with pint quantities; refuse a result of another dimension than promised."""
    hints = typing.get_type_hints(form, include_extras=True)
    arguments = {
        parameter.name: example(name, parameter, hints.get(parameter.name))
        for parameter in inspect.signature(form).parameters.values()
        if unit_of(hints.get(parameter.name)) or parameter.default is inspect.Parameter.empty
    }
    promised = hints.get("return")
    units = [unit_of(promised)]
    if units == [None] and typing.get_origin(promised) is tuple:
        units = [unit_of(part) for part in typing.get_args(promised)]
    assert None not in units, f"{name}: its return annotation carries no unit"
    try:
        result = form(**arguments)
    except pint.DimensionalityError as error:
        raise DimensionMismatchError(
            f"{name} adds or compares unlike quantities: {error}"
        ) from error
    for value, unit in zip(result if len(units) > 1 else [result], units, strict=True):
        dimension = pint_units.Quantity(value).dimensionality
        if dimension != pint_unit(unit).dimensionality:
            raise DimensionMismatchError(
                f"{name} promises {unit.symbol} and returns {dimension or 'a plain number'}"
            )


def test_the_registry_covers_what_it_must() -> None:
    assert SHIPPED
    assert MINIMUM - SHIPPED.keys() == set()
    assert MISPRINTS.keys() - SHIPPED.keys() == set()


@pytest.mark.parametrize("name", sorted(SHIPPED.keys() - MISPRINTS.keys()))
def test_closed_form_has_the_dimension_it_promises(name: str) -> None:
    check(name, SHIPPED[name])


@pytest.mark.parametrize("name", sorted(MISPRINTS))
def test_misprint_is_caught(name: str) -> None:
    with pytest.raises(DimensionMismatchError):
        check(name, SHIPPED[name])


def test_printed_equation_4_is_caught_for_its_missing_length() -> None:
    name = "squeezefilm.physics.film.gap.squeeze_number_printed"
    with pytest.raises(DimensionMismatchError, match=r"promises 1 and returns 1 / \[length\]"):
        check(name, SHIPPED[name])
    check(
        "squeezefilm.physics.film.gap.squeeze_number",
        SHIPPED["squeezefilm.physics.film.gap.squeeze_number"],
    )


def test_the_test_itself_catches_wrong_formulas() -> None:
    @closed_form(positive="force length")
    def wrong_power(force: Newton, length: Metre) -> Pascal:
        return force / length

    @closed_form(positive="force frequency")
    def unlike_sum(force: Newton, frequency: Hertz) -> Newton:
        return force + frequency

    @closed_form(positive="force length scale")
    def right(
        force: Newton, length: Metre, scale: Dimensionless, strict: bool = True
    ) -> NewtonPerMetre:
        return scale * force / length

    @closed_form(positive="force")
    def without_unit(force: Newton, length) -> NewtonPerMetre:  # type: ignore[no-untyped-def]
        return force / length

    forms = [key for key in CLOSED_FORMS if key.startswith(__name__)]
    try:
        for bad in (wrong_power, unlike_sum):
            with pytest.raises(DimensionMismatchError):
                check("bad", bad)
        check("right", right)
        with pytest.raises(AssertionError, match="neither a unit"):
            check("without_unit", without_unit)
    finally:
        for key in forms:
            CLOSED_FORMS.pop(key, None)
