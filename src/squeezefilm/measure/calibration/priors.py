"""Values of a plate or disc that a calibration may move, and how far: the display's own ranges.

A value that the description gives a spread keeps it. The others have an **assumed** range, by as
much as such a value is seldom known; each stands in `ASSUMED` with its reason. What a ceramic's
constants are called in a data sheet differs, so they are moved together, by shares of the stated
ones: stiffness, charge and permittivity.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import NamedTuple, cast

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.distributions import Distribution, LogNormal, Normal, Uniform
from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.uncertainty.parameters import Origin, Parameter, value_at, with_values

STIFFNESS_SHARE, CHARGE_SHARE, PERMITTIVITY_SHARE = (
    "ceramic_stiffness_share",
    "ceramic_charge_share",
    "ceramic_permittivity_share",
)
SHARES = {
    STIFFNESS_SHARE: "all stiffnesses of the ceramic, relative to the stated ones",
    CHARGE_SHARE: "all charge coefficients d of the ceramic, relative to the stated ones",
    PERMITTIVITY_SHARE: "clamped permittivities of the ceramic, relative to the stated ones",
}


class _Range(NamedTuple):
    """A range in shares of the nominal value, and why."""

    low: float
    high: float
    why: str


ASSUMED: dict[str, _Range] = {
    "actuator.substrate.young_modulus": _Range(0.93, 1.07, "alloys and glasses of one name differ"),
    "actuator.substrate.density": _Range(0.985, 1.015, "alloys of one name differ"),
    "actuator.thickness": _Range(0.975, 1.025, "the tolerance of rolled sheet"),
    "actuator.patches.*.thickness": _Range(0.95, 1.05, "the tolerance of lapped ceramics"),
    "actuator.ceramic_thickness": _Range(0.95, 1.05, "the tolerance of lapped ceramics"),
    STIFFNESS_SHARE: _Range(0.9, 1.1, "batches of one ceramic"),
    CHARGE_SHARE: _Range(0.75, 1.25, "data sheets allow 20 % and more; ageing"),
    PERMITTIVITY_SHARE: _Range(0.75, 1.25, "data sheets allow 20 %; temperature"),
    "actuator.quality_factor": _Range(0.5, 1.6, "the losses of a bonded assembly"),
    "actuator.ceramic.quality_factor": _Range(0.5, 1.6, "of a bonded, driven ceramic"),
    "actuator.glue.thickness": _Range(0.3, 2.0, "a bond line is seldom measured"),
    "actuator.glue.young_modulus": _Range(0.3, 2.0, "cure, filler and temperature"),
}
"""Assumed ranges, in shares of the value as described: nobody measured them on this plate."""


def calibration_parameters(
    display: Display, paths: Mapping[str, Distribution | None] | None = None
) -> tuple[Parameter, ...]:
    """The values of a display's actuator that a calibration moves, with their prior distributions.

    Without `paths` those of `ASSUMED` that the display has and that its solved answer depends on.
    With it exactly these; a distribution beside a path is its prior, None means the display's own
    spread or the assumed one. Any dotted path of a number of the actuator may be given.

    Raises `InputError` for a stator (its answers are measured already), for a path that leads to no
    number, and for one that has no prior from anywhere.
    """
    actuator = display.actuator
    if isinstance(actuator, AnnularStator):
        raise InputError(
            f"the display '{display.name}' is a stator, whose frequency and amplitude are measured "
            "values already; calibrate a plate or a disc"
        )
    wanted = dict.fromkeys(_usual(actuator)) if paths is None else dict(paths)
    # What the description itself calls uncertain is moved too.
    if paths is None:
        for path, origin in display.provenance.items():
            if origin.distribution is not None and path.startswith("actuator."):
                wanted.setdefault(path, None)
    return tuple(_parameter(display, path, prior) for path, prior in wanted.items())


def _usual(actuator: RectangularPlate | DiscPlate) -> list[str]:
    """The paths of `ASSUMED` that an actuator has and that its answers depend on."""
    paths = [path for path in ASSUMED if path in SHARES]
    plate = isinstance(actuator, RectangularPlate)
    paths += ["actuator.substrate.young_modulus", "actuator.thickness"]
    paths += ["actuator.patches.*.thickness" if plate else "actuator.ceramic_thickness"]
    paths += ["actuator.substrate.density"]
    # With a quality factor of its own for the substrate every material has one.
    of_all = actuator.substrate.quality_factor is None
    paths += ["actuator.quality_factor" if of_all else "actuator.ceramic.quality_factor"]
    if actuator.glue is not None:
        paths += ["actuator.glue.thickness", "actuator.glue.young_modulus"]
    return [path for path in ASSUMED if path in paths]


def _parameter(display: Display, path: str, prior: Distribution | None) -> Parameter:
    if path in SHARES:
        nominal, unit, source = 1.0, si.Unit("1"), SHARES[path]
    else:
        nominal, unit = value_at(display, path)
        source = ""
    given = display.provenance.get(path.replace(".*", ".0"))
    origin: Origin = "given"
    if prior is None and given is not None and given.distribution is not None:
        prior, source = given.distribution, given.source
    if prior is None and path in ASSUMED:
        low, high, why = ASSUMED[path]
        ends = sorted((low * nominal, high * nominal))
        prior, source, origin = Uniform(*ends), why, "assumed"
    if prior is None:
        raise InputError(
            f"nothing says how uncertain '{path}' is; give it a range or an uncertainty in the "
            f"display's file, or leave it out. Known without one: {', '.join(ASSUMED)}",
            quantity="parameters",
        )
    low, high = prior.support
    if low * high <= 0 or nominal == 0:
        raise InputError(
            f"'{path}' may be anything from {low:.4g} to {high:.4g} and so change its sign; a "
            "calibration takes values of one sign, so give a narrower range",
            quantity="parameters",
        )
    return Parameter(path, nominal, unit, prior, origin, source)


def with_calibrated(display: Display, values: Mapping[str, float]) -> Display:
    """The display with other values at the paths of `calibration_parameters`, shares included.

    A ceramic's full constants are stated then, as `Piezoceramic.full_constants` had them. Raises
    `InputError` for what cannot be there.
    """
    shares = {path: value for path, value in values.items() if path in SHARES}
    rest = {path: value for path, value in values.items() if path not in SHARES}
    changed = with_values(display, rest)
    if not shares:
        return changed
    # A stator has no ceramic of its own, and `calibration_parameters` refuses it.
    actuator = cast("RectangularPlate | DiscPlate", changed.actuator)
    full = actuator.ceramic.full_constants
    stated = dataclasses.replace(
        actuator.ceramic,
        in_plane_stiffness=full.compliance_11 / (full.compliance_11**2 - full.compliance_12**2),
        charge_coefficient=full.charge_coefficient_31,
        stress_coefficient=None,
        data_set="from_d31",
        constants=full,
    )
    ceramic = stated.scaled(*(shares.get(name, 1.0) for name in SHARES))
    return dataclasses.replace(changed, actuator=dataclasses.replace(actuator, ceramic=ceramic))


class NormalScores:
    """Transformation of values of parameters into independent standard normal numbers.

    In these scores every prior is N(0, 1), so that a sampler sees one scale and no walls.
    `coordinates` are what an emulator takes: logarithms of the values, −1 and 1 at the ends of the
    priors; of glue, what matters is how far it shears under a stress, so difference and mean of its
    thickness and modulus stand for the two.
    """

    def __init__(self, parameters: tuple[Parameter, ...]) -> None:
        self.parameters = parameters
        ends = np.log(np.abs([parameter.distribution.support for parameter in parameters])).reshape(
            -1, 2
        )
        self._middle, self._half = ends.mean(axis=1), np.diff(ends, axis=1)[:, 0] / 2
        self.paths = tuple(parameter.path for parameter in parameters)
        pair = [f"actuator.glue.{name}" for name in ("thickness", "young_modulus")]
        self._glue = (
            [self.paths.index(path) for path in pair] if set(pair) <= set(self.paths) else None
        )

    def values(self, scores: si.DimensionlessArray) -> si.FloatArray:
        """The values (in each parameter's unit) of scores, shape (points, parameters)."""
        from scipy.special import ndtr

        share = ndtr(np.clip(scores, -8.0, 8.0))
        columns = [
            parameter.distribution.quantile(share[:, k])
            for k, parameter in enumerate(self.parameters)
        ]
        return np.stack(columns, axis=1) if columns else np.zeros((len(scores), 0))

    def by_path(self, scores: si.DimensionlessArray) -> Iterator[dict[str, float]]:
        """The values of each row of scores, by the paths of the parameters."""
        for row in self.values(scores).tolist():
            yield dict(zip(self.paths, row, strict=True))

    def coordinates(self, scores: si.DimensionlessArray) -> si.DimensionlessArray:
        """The emulator's coordinates of scores, shape (points, parameters)."""
        logs = np.log(np.abs(self.values(scores)))
        coordinates = np.asarray((logs - self._middle) / np.abs(self._half))
        if self._glue is not None:
            thick, stiff = coordinates[:, self._glue].T
            coordinates[:, self._glue] = np.stack([thick - stiff, thick + stiff], axis=1) / 2
        return coordinates


def share_of(prior: Distribution, values: si.FloatArray) -> si.DimensionlessArray:
    """The probabilities (the shape of `values`, in the quantity's unit) with which values are not
    exceeded: the inverse of `Distribution.quantile`, 0 or 1 beyond its support."""
    from scipy.special import ndtr

    if isinstance(prior, LogNormal):
        return share_of(prior.of_logarithm, np.log(np.maximum(values, prior.support[0])))
    if isinstance(prior, Normal):
        least, most = (
            float(ndtr((end - prior.mean) / prior.standard_deviation)) for end in prior.support
        )
        share = ndtr((values - prior.mean) / prior.standard_deviation)
        return np.clip((share - least) / (most - least), 0.0, 1.0)
    low, high = prior.support
    return np.clip((np.asarray(values) - low) / (high - low), 0.0, 1.0)
