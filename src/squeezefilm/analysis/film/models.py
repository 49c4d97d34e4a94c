"""What the paper's film promises and what solved films do, side by side at one working point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.chain.friction import FrictionLaw
from squeezefilm.chain.prediction import Prediction
from squeezefilm.contact.sharing.film_load import DESCRIPTIONS, FILM_MODELS, FilmModel, is_still
from squeezefilm.display import Display
from squeezefilm.errors import SqueezefilmError
from squeezefilm.plate.layout import AnnularStator


@dataclass(frozen=True)
class FilmResult:
    """One reading of the finger: the film's mean over-pressure over ambient with its error, the
    share of the finger's load that it would carry, and the friction that would be left."""

    model: FilmModel
    description: str
    over_pressure: si.Dimensionless
    over_pressure_error: si.Dimensionless
    load_share: si.Dimensionless
    relative_friction: si.Dimensionless
    status: str


@dataclass(frozen=True, eq=False)
class FilmCurve:
    """The share of the load that one film would carry against the vibration amplitude."""

    model: FilmModel
    amplitude: si.MetreArray
    load_share: si.DimensionlessArray


@dataclass(frozen=True)
class ToothResult:
    """Whether a toothed surface matters: over-pressure over ambient on a toothed and on a
    continuous surface, for the paper's ridges and for a plateau."""

    tooth_pitch: si.Metre
    slot_width: si.Metre
    continuous: si.Dimensionless
    toothed: si.Dimensionless
    ratio: si.Dimensionless
    sentence: str


@dataclass(frozen=True)
class PlateauBalance:
    """The mean gap at which plateaus of the film at an antinode carry the finger alone."""

    mean_gap: si.Metre
    mean_gap_error: si.Metre
    least_gap: si.Metre
    plateau_pressure: si.Pascal
    sentence: str


@dataclass(frozen=True, eq=False)
class FilmComparison:
    """All readings of the finger at one working point, and their curves over the amplitude."""

    results: tuple[FilmResult, ...]
    curves: tuple[FilmCurve, ...]
    teeth: ToothResult | None
    balance: PlateauBalance | None

    def result(self, model: FilmModel) -> FilmResult:
        """The result of one model."""
        return next(item for item in self.results if item.model == model)


# A film in the plane takes a tenth of a second, the others a hundredth; over the logarithm of the
# amplitude all are nearly straight.
_POINTS = {
    "paper2008": 41,
    "film-sealed": 16,
    "film-open": 6,
    "film-plateau": 21,
    "film-smooth": 16,
}


def compare_film_models(display: Display, prediction: Prediction) -> FilmComparison | None:
    """The film models at the working point of a prediction; None where nothing vibrates.

    A film that cannot be solved has NaN and the reason as its status; its curve ends there.
    """
    p = prediction
    if is_still(p.law.gap(p.vibration_amplitude)):
        return None
    pressure = p.normal_force / display.finger.contact_length**2 / display.gas.ambient_pressure
    results, curves = [], []
    top = max(4e-6, 1.25 * p.vibration_amplitude)
    for model in FILM_MODELS:
        law = p.law.by(model)
        results.append(_result(law, model, p.vibration_amplitude, pressure))
        # Denser at small amplitudes, where the load falls with their square.
        amplitude = np.geomspace(top / 40, top, _POINTS[model])
        share = np.full(amplitude.size, np.nan)
        for index, a in enumerate(amplitude):
            try:
                share[index] = law.load(float(a)).over_pressure / pressure
            except SqueezefilmError:
                break
        curves.append(FilmCurve(model, amplitude, share))
    return FilmComparison(
        tuple(results), tuple(curves), _teeth(display, prediction), _balance(display, prediction)
    )


def _result(
    law: FrictionLaw, model: FilmModel, amplitude: si.Metre, pressure: si.Dimensionless
) -> FilmResult:
    """One film at one amplitude; NaN with the reason where it cannot be solved, so that the others
    can still be compared."""
    try:
        load = law.load(amplitude)
        friction = law.under(load, amplitude)
    except SqueezefilmError as error:
        nan = float("nan")
        return FilmResult(model, DESCRIPTIONS[model], nan, nan, nan, nan, f"not solved: {error}")
    return FilmResult(
        model=model,
        description=DESCRIPTIONS[model],
        over_pressure=load.over_pressure,
        over_pressure_error=load.error,
        load_share=load.over_pressure / pressure,
        relative_friction=friction,
        status=load.status,
    )


def _teeth(display: Display, prediction: Prediction) -> ToothResult | None:
    actuator = display.actuator
    if not isinstance(actuator, AnnularStator) or actuator.tooth_pitch is None:
        return None
    from squeezefilm.film.gas import FilmGas
    from squeezefilm.film.planar.gap import PlanarGap
    from squeezefilm.film.planar.teeth import compare_teeth

    assert actuator.slot_width is not None
    p, gas = prediction, display.gas
    gap = p.law.gap(p.vibration_amplitude)
    reference = float(gap.reference_thickness)
    ridged = PlanarGap(
        float(gap.vibration_amplitude) / reference,
        gap.wave_number,
        gap.ridge_amplitude / reference,
        gap.ridge_number,
    )
    try:
        found = compare_teeth(
            p.squeeze_number,
            ridged,
            tooth_width=(actuator.tooth_pitch - actuator.slot_width) / gap.contact_length,
            tooth_pitch=actuator.tooth_pitch / gap.contact_length,
            gas=FilmGas(knudsen_number=gas.mean_free_path / reference),
        )
    except SqueezefilmError:
        return None
    matters = "matter little here" if 0.8 <= found.ratio <= 1.25 else "do matter here"
    return ToothResult(
        tooth_pitch=actuator.tooth_pitch,
        slot_width=actuator.slot_width,
        continuous=found.continuous,
        toothed=found.toothed,
        ratio=found.ratio,
        sentence=f"Teeth change the over-pressure under open ridges to {si.percent(found.ratio)} "
        f"of that of a continuous surface: they {matters}, and the paper assumes that they do not "
        "(the tooth's dimensions are assumed).",
    )


def _balance(display: Display, prediction: Prediction) -> PlateauBalance | None:
    from squeezefilm.errors import UnreachableError
    from squeezefilm.film.periodic.balance import VibratedFilm, mean_gap_for_load

    p, finger, gas = prediction, display.finger, display.gas
    load = finger.mean_pressure * finger.ridge_period / finger.plateau_width
    load *= p.normal_force / finger.normal_force
    try:
        film = VibratedFilm(
            p.vibration_amplitude,
            p.frequency,
            finger.plateau_width,
            gas.viscosity,
            gas.ambient_pressure,
            mean_free_path=gas.mean_free_path,
        )
        found = mean_gap_for_load(film, load)
    except UnreachableError:
        return None
    clear = found.least_gap - p.surface.roughness
    sentence = (
        f"On flattened ridges over an antinode the film carries the finger at a mean gap of "
        f"{found.mean_gap * 1e6:.3g} µm, at its least {found.least_gap * 1e6:.2g} µm: "
        + (
            "above the roughness, so the finger could float there."
            if clear > 0
            else f"below the roughness of {p.surface.roughness * 1e6:.2g} µm, so film and contact "
            "share the load."
        )
    )
    return PlateauBalance(
        mean_gap=found.mean_gap,
        mean_gap_error=found.mean_gap_error,
        least_gap=found.least_gap,
        plateau_pressure=load,
        sentence=sentence,
    )
