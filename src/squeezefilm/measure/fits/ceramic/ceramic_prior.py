"""What is known of a ceramic before it is measured: the ratios of the library's ceramics."""

from __future__ import annotations

import functools
import math

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.presets.materials import materials
from squeezefilm.measure.fits.complex_fit import Prior

PARAMETERS = (
    "ln s11",
    "-s12/s11",
    "ln |d31|",
    "ln eps33",
    "loss of s11",
    "loss of d31",
    "loss of eps33",
    "loss of s12 over loss of s11, less 1",
    "s13/s11",
    "s33/s11",
    "s44/s11",
    "d33/d31",
    "d15/d31",
    "eps11/eps33",
)
"""What is fitted of a disc, in this order: s at constant field, ε relative and at constant
stress."""

WIDE = 1.0
"""Spread of ln s11, ln |d31| and ln ε33 before anything is measured: as good as nothing."""
_LOSS, _LOSS_SPREAD = 0.015, 0.02
_SHEAR_LOSS_SPREAD = 0.2


@functools.cache
def ceramic_prior() -> Prior:
    """Means and standard deviations of `PARAMETERS`.

    The ratios that a sweep of a disc hardly tells (among them Poisson's) scatter as those of the
    library's lead zirconate titanates do, hard to very soft; of a further one of their kind they
    are known to √(1 + 1/n) of that. The three sizes are as good as unknown. Losses: 0.015 ± 0.02;
    that of s12 that of s11 to 20 % (both assumed). Read from `core/presets/materials.toml`.
    """
    rows = np.array(
        [_ratios(material.values) for material in materials() if material.kind == "ceramic"]
    )
    mean, spread = rows.mean(axis=0), rows.std(axis=0, ddof=1) * math.sqrt(1 + 1 / len(rows))
    spread[[0, 2, 3]] = WIDE
    means = np.concatenate([mean[:4], [_LOSS] * 3, [0.0], mean[4:]])
    spreads = np.concatenate([spread[:4], [_LOSS_SPREAD] * 3, [_SHEAR_LOSS_SPREAD], spread[4:]])
    return Prior(means, spreads)


def _ratios(values: dict[str, object]) -> list[float]:
    """ln s11, −s12/s11, ln |d31|, ln ε33, then the six ratios of `PARAMETERS`."""
    table = values["constants"]
    assert isinstance(table, dict)

    def of(name: str) -> float:
        value = table[name]["value"]
        return float(value) if isinstance(value, int | float) else float(str(value).split()[0])

    s11, s12, s13, s33, s44 = (of(f"compliance_{k}") for k in ("11", "12", "13", "33", "44"))
    d31, d33, d15 = (of(f"charge_coefficient_{k}") for k in ("31", "33", "15"))
    eps11, eps33 = of("free_permittivity_11"), of("free_permittivity_33")
    logs = [math.log(s11), -s12 / s11, math.log(abs(d31) * 1e-12), math.log(eps33)]
    return [*logs, s13 / s11, s33 / s11, s44 / s11, d33 / d31, d15 / d31, eps11 / eps33]


@si.checked_numbers
def compliances(
    p: si.DimensionlessArray,
) -> tuple[si.ComplexArray, si.ComplexArray, si.ComplexArray]:
    """Complex compliances s11, s12, s13, s33, s44 (m²/N), charge coefficients d31, d33, d15 (m/V)
    and free relative permittivities ε11, ε33 of parameters `p` in the order of `PARAMETERS`.

    All compliances but s12 have the loss of s11, all charge coefficients that of d31, both
    permittivities that of ε33 (assumed: a radial mode hardly asks for the others).
    """
    if p.shape != (len(PARAMETERS),):
        raise InputError(f"p has the shape {p.shape}; give the {len(PARAMETERS)} of PARAMETERS")
    s11 = math.exp(p[0]) * (1 - 1j * p[4])
    s12 = -p[1] * math.exp(p[0]) * (1 - 1j * p[4] * (1 + p[7]))
    d31 = -math.exp(p[2]) * (1 - 1j * p[5])
    eps33 = math.exp(p[3]) * (1 - 1j * p[6])
    return (
        np.array([s11, s12, s11 * p[8], s11 * p[9], s11 * p[10]]),
        np.array([d31, d31 * p[11], d31 * p[12]]),
        np.array([eps33 * p[13], eps33]),
    )
