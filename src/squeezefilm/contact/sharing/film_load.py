"""What the solved film carries under a finger, in four readings of what a finger is.

The paper takes sinusoidal ridges, grooves without ends and an infinite squeeze number. Here the
same gap is solved: with grooves that are sealed (the paper's own one-dimensional equation, at its
own squeeze number), with grooves that are open at the edge of the contact, with ridges pressed flat
into plateaus whose grooves are at ambient pressure, and for a finger without ridges.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.film.closed.limits import contact_mean_pressure
from squeezefilm.film.gap import PaperGap, squeeze_number
from squeezefilm.materials import Gas

if TYPE_CHECKING:
    from squeezefilm.film.periodic.solution import FilmSolution

FilmModel = Literal["paper2008", "film-sealed", "film-open", "film-plateau", "film-smooth"]
FILM_MODELS: tuple[FilmModel, ...] = get_args(FilmModel)

DESCRIPTIONS: dict[FilmModel, str] = {
    "paper2008": "the paper's asymptote: no gas escapes (σ → ∞), sinusoidal ridges",
    "film-sealed": "the paper's own equation solved at its squeeze number: ridges along an endless "
    "contact, grooves sealed at their ends",
    "film-open": "the same ridges on a square contact, grooves open at their ends",
    "film-plateau": "ridges pressed flat, each plateau a film of its own between ambient grooves",
    "film-smooth": "a finger without ridges",
}

DEFAULT_PLATEAU_WIDTH: si.Metre = 250e-6

# The over-pressure goes with the square of the relative amplitude: below this it is at most 1e-8
# of ambient, a millionth of a finger's pressure, and the solvers would work on rounding.
STILL: si.Dimensionless = 1e-4


@dataclass(frozen=True)
class FilmLoad:
    """The mean over-pressure of a film over contact and period, divided by ambient.

    `error` is the solver's estimate of its absolute error (0 for the closed form), `model` names
    the reading of the finger, a `FilmModel` or one that shares the load with asperities.
    """

    model: str
    over_pressure: si.Dimensionless
    error: si.Dimensionless
    squeeze_number: si.Dimensionless
    status: str


@si.checked_numbers
def film_load(
    gap: PaperGap,
    frequency: si.Hertz,
    gas: Gas,
    model: FilmModel = "film-sealed",
    *,
    plateau_width: si.Metre = DEFAULT_PLATEAU_WIDTH,
    slip: str = "first",
    tolerance: float = 1e-3,
) -> FilmLoad:
    """The over-pressure that a film carries under the finger of `gap` (a single amplitude).

    Isothermal; slip by the local Knudsen number, `slip` names the law; `tolerance` is relative on
    the over-pressure. The wave's antinode and a groove are at the centre of the contact. Holds
    where `film.validity` says that inertia does not count. Raises `InputError` for an unknown
    model, an array of amplitudes or plateaus wider than the ridge period, `ConvergenceError` where
    the film cannot be solved to `tolerance`.
    """
    if np.ndim(gap.vibration_amplitude) != 0:
        raise InputError("film_load takes a single vibration amplitude; call it for each")
    amplitude, sigma = float(gap.vibration_amplitude), float(gap.squeeze_number(frequency, gas))
    if is_still(gap):
        bound = 1.25 * (amplitude / float(gap.crest_thickness)) ** 2
        return FilmLoad(model, 0.0, bound, sigma, "too still for a pressure")
    if model == "paper2008":
        over = float(contact_mean_pressure(gap)) - 1.0
        return FilmLoad(model, over, 0.0, sigma, "closed form")
    if model == "film-plateau":
        return _plateaus(gap, frequency, gas, plateau_width, slip, tolerance)
    if model == "film-open":
        return _open(gap, frequency, gas, slip, tolerance)
    film = line_film(
        gap,
        frequency,
        gas,
        ridges=model == "film-sealed",
        slip=slip,
        tolerance=tolerance,
        field=False,
    )
    return FilmLoad(
        model, film.over_pressure, film.over_pressure_error, film.squeeze_number, film.status
    )


def is_still(gap: PaperGap) -> bool:
    """Whether the vibration (m, a single amplitude) is too small for a film to speak of."""
    return float(gap.vibration_amplitude) < STILL * float(gap.roughness)


@si.checked_numbers
def line_film(
    gap: PaperGap,
    frequency: si.Hertz,
    gas: Gas,
    *,
    ridges: bool = True,
    slip: str = "first",
    tolerance: float = 1e-3,
    field: bool = True,
) -> FilmSolution:
    """The film along the contact of `gap`, with its ridges (grooves sealed) or without them.

    The solution's pressures are over ambient, X = x/l0; without `field` it has the load only.
    Raises what `solve_profile` raises.
    """
    from squeezefilm.film.periodic.film import solve_profile
    from squeezefilm.film.periodic.profile import flexural_profile

    reference = float(gap.reference_thickness if ridges else gap.crest_thickness)
    profile = flexural_profile(
        float(gap.vibration_amplitude) / reference,
        wavenumber=gap.wave_number,
        ridge_depth=gap.ridge_amplitude / reference if ridges else 0.0,
        ridge_wavenumber=gap.ridge_number if ridges else 0.0,
    )
    sigma = squeeze_number(
        frequency, gap.contact_length, reference, gas.viscosity, gas.ambient_pressure
    )
    return solve_profile(
        float(sigma),
        profile,
        knudsen_number=gas.mean_free_path / reference,
        slip=slip,
        tolerance=tolerance,
        field=field,
    )


def _open(gap: PaperGap, frequency: si.Hertz, gas: Gas, slip: str, tolerance: float) -> FilmLoad:
    from squeezefilm.film.gas import FilmGas
    from squeezefilm.film.planar.film import solve_planar
    from squeezefilm.film.planar.gap import PlanarGap

    reference = float(gap.reference_thickness)
    sigma = float(gap.squeeze_number(frequency, gas))
    excursion, ridges = float(gap.vibration_amplitude) / reference, gap.ridge_amplitude / reference
    film = solve_planar(
        "rectangle",
        PlanarGap(excursion, gap.wave_number, ridges, gap.ridge_number),
        sigma,
        gas=FilmGas(knudsen_number=gas.mean_free_path / reference, slip=slip),
        # In the plane a per cent costs a tenth of a second, a tenth of that a second.
        tolerance=max(tolerance, 1e-2),
    )
    return FilmLoad("film-open", film.over_pressure, film.over_pressure_error, sigma, film.status)


def ridge_positions(gap: PaperGap) -> tuple[float, ...]:
    """The crests under the contact (m from its centre): where 1 + cos(k2 X) is least."""
    half = gap.contact_length / 2
    count = int(np.floor(half / gap.ridge_period + 0.5))
    return tuple(
        float(sign * (number + 0.5) * gap.ridge_period)
        for number in range(count)
        for sign in (1, -1)
    )


def _plateaus(
    gap: PaperGap,
    frequency: si.Hertz,
    gas: Gas,
    plateau_width: si.Metre,
    slip: str,
    tolerance: float,
) -> FilmLoad:
    from squeezefilm.film.periodic.batch import solve_films

    si.require("plateau_width", plateau_width, si.Unit("m"), above=0, at_most=gap.ridge_period)
    crest = float(gap.crest_thickness)
    sigma = float(
        squeeze_number(frequency, plateau_width, crest, gas.viscosity, gas.ambient_pressure)
    )
    positions = np.array(ridge_positions(gap))
    if positions.size == 0:
        raise InputError(
            f"a contact of {gap.contact_length * 1e3:.3g} mm holds no ridge of period "
            f"{gap.ridge_period * 1e3:.3g} mm; make the contact longer or use 'film-smooth'"
        )
    wave = np.abs(np.cos(2 * np.pi * positions / gap.wavelength))
    # A plateau at a node hardly moves and carries nothing that matters.
    excursion = np.maximum(wave * float(gap.vibration_amplitude) / crest, 1e-6)
    films = solve_films(
        np.full_like(excursion, sigma),
        excursion,
        knudsen_number=gas.mean_free_path / crest,
        slip=slip,
        tolerance=tolerance,
        workers=1,
    )
    share = plateau_width / gap.ridge_period
    over = share * float(np.mean(films.over_pressure))
    error = share * float(np.mean(films.over_pressure_error))
    return FilmLoad(
        "film-plateau",
        over,
        error,
        sigma,
        f"{positions.size} plateaus of {plateau_width * 1e6:.4g} µm, each solved as a strip",
    )
