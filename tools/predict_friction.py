"""Predict friction that was measured and kept back, before any of it is read.

    python tools/predict_friction.py             # writes predictions/friction-of-fingers.toml
    python tools/predict_friction.py --check     # makes it again and compares

People are drawn from those that `tools/levitation_fit.py` fits; each interval holds 90 % of the
draws, by a rule that was fixed before anything was compared. The file ends with the SHA-256 of all
lines before, as those of `tools/predict_disc.py` do.
"""

from __future__ import annotations

import argparse
import math
import re
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from levitation_fit import law_of
from predict_disc import is_sealed, sealed
from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.measure.fits.friction.friction_scores import with_decay_length
from squeezefilm.physics.chain.friction import FrictionLaw
from squeezefilm.physics.chain.pad_law import FrictionModel
from squeezefilm.physics.contact.finger.fingertip import (
    CONTACT_DECAY_LENGTH,
    DECAY_SPEED_EXPONENT,
    RIDGE_POWER_OF_PEOPLE,
    RIDGE_POWER_OF_SPEED,
    Finger,
)

FOLDER = Path(__file__).parents[1] / "predictions"
FILES: Mapping[FrictionModel, Path] = {
    "levitation": FOLDER / "friction-of-fingers.toml",
    "levitation-ridges": FOLDER / "friction-of-fingers-over-ridges.toml",
}
SEED, DRAWS = 44, 2000
AMPLITUDES = np.array([0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5]) * 1e-6
# Of ln ℓ between people: of three at 10 mm/s 0.45, of seventy strokes 0.34. A new one is drawn with
# what three people leave open of their mean.
PEOPLE = 0.40 * math.sqrt(1 + 1 / 3)
# What is left of a curve with its person's own length, of the friction at rest.
LEFT = 0.03
GLASS_2016, GLASS_2018 = (
    str(presets.friction_folder() / name)
    for name in ("wiertlewski2016-glass.toml", "monnoyer2018-glass.toml")
)
ASSUMED = (
    "The model is levitation (docs/decisions/0018): the closed form of 2016 without a gap at rest, "
    "at each place of the pad, its length fitted to three people and to strokes of 14.",
    "Interval: 5 to 95 % of draws of the length (and where said of speed, force and the growth of "
    "the length with the speed), with a normal error of 0.03 on each friction.",
    "Relative friction is over the friction at rest that the model fits to the curve; over_line is "
    "over the line through the first three amplitudes, at zero.",
    "An artificial finger is taken for a person of unknown length with twice the spread of people, "
    "since two skins of equal hardness were published at 0.084 and 0.81; a stiff one for one whose "
    "length is twice that of people, and three times their spread.",
    "Talc is taken to change the friction at rest and nothing else.",
    "Vacuum: no model. Student's t of three published repeats (0.82, 0.60, 0.64), for one more.",
    "Coefficient at rest at 10 mm/s: log-normal of the three people's 2.91, 2.97 and 1.92.",
    "Strokes: log-normal with the mean, spread and correlation of the seventy that are known.",
)
OVER_RIDGES = (
    "The model is levitation-ridges: the balance of 2016 with films solved over single ridges, "
    "whose length follows the closed form's by its power of people and of speed.",
    *ASSUMED[1:5],
    "Vacuum: by the model at 29.075 kHz, 1.6 um and 0.35 N, slip by Veijola, over the lengths of "
    "an artificial finger as above; nothing is fitted to a vacuum.",
)


def curve_quantiles(
    law: FrictionLaw,
    lengths: si.MetreArray,
    amplitudes: si.MetreArray,
    random: Any,
    *,
    over_line: bool = False,
) -> list[list[float]]:
    """5, 50 and 95 % of µ′/µ over draws of the length, a row for each amplitude."""
    drawn = drawn_curves(law, lengths, amplitudes)
    if over_line:
        first = np.polynomial.polynomial.polyfit(amplitudes[:3], drawn[:, :3].T, 1)[0]
        drawn = drawn / first[:, None]
    drawn = np.clip(drawn + LEFT * random.standard_normal(drawn.shape), 0.0, 1.2)
    return [[float(f"{x:.3f}") for x in row] for row in np.quantile(drawn, [0.05, 0.5, 0.95], 0).T]


def drawn_curves(
    law: FrictionLaw, lengths: si.MetreArray, amplitudes: si.MetreArray
) -> si.DimensionlessArray:
    """µ′/µ of each length at each amplitude; over ridges, where each takes films, between those of
    80 lengths."""
    if law.model == "levitation":
        return np.array(
            [with_decay_length(law, float(length)).curve(amplitudes) for length in lengths]
        )
    known = np.geomspace(lengths.min(), lengths.max(), 80)
    curves = np.array([with_decay_length(law, float(one)).curve(amplitudes) for one in known])
    place = np.log(lengths)
    return np.column_stack([np.interp(place, np.log(known), column) for column in curves.T])


def curve_of(law: FrictionLaw, lengths: si.MetreArray, random: Any) -> dict[str, Any]:
    """A predicted curve at `AMPLITUDES`, over either friction at rest."""
    return {
        "amplitude_um": (1e6 * AMPLITUDES).round(3).tolist(),
        "relative_friction_5_50_95": curve_quantiles(law, lengths, AMPLITUDES, random),
        "over_line_5_50_95": curve_quantiles(law, lengths, AMPLITUDES, random, over_line=True),
    }


def lengths_at(
    model: FrictionModel,
    speed: si.FloatLike,
    random: Any,
    spread: float = PEOPLE,
    scale: float = 1.0,
) -> si.MetreArray:
    """Draws of a new person's length of the closed form (m) at a speed (m/s), or of one that stands
    for that over ridges; at 10 mm/s, where three people were measured, the growth with the speed is
    as fitted, else drawn between none and twice that."""
    exponent: si.FloatLike = DECAY_SPEED_EXPONENT
    if np.any(np.asarray(speed) > 0.011):
        exponent = random.uniform(0.0, 2 * DECAY_SPEED_EXPONENT, DRAWS)
    if model == "levitation-ridges":
        exponent = exponent * (RIDGE_POWER_OF_SPEED / RIDGE_POWER_OF_PEOPLE)
    middle = CONTACT_DECAY_LENGTH * scale * (np.asarray(speed) / Finger.decay_speed) ** exponent
    drawn = middle * np.exp(spread * random.standard_normal(DRAWS))
    return np.asarray(np.clip(drawn, 1e-7, 1e-3))


def predictions(model: FrictionModel) -> Mapping[str, Any]:
    """Every prediction of a model by its name; those without a model are the default's."""
    random = np.random.default_rng(SEED)
    made: dict[str, Any] = {}
    at_10 = {
        "person at 10 mm/s, 0.12 N": (0.12, PEOPLE, 1.0),
        "person at 10 mm/s, 0.40 N": (0.40, PEOPLE, 1.0),
        "artificial finger at 10 mm/s, 0.78 N, skin roughness 1.4 um": (0.78, 2 * PEOPLE, 1.0),
    }
    for name, (force, spread, scale) in at_10.items():
        law = law_of(GLASS_2016, 29.08e3, force, 0.01).by(model)
        lengths = lengths_at(model, 0.01, random, spread, scale)
        made[name] = curve_of(law, lengths, random)
    rest = np.log([2.91, 2.97, 1.92])
    middle, spread = float(rest.mean()), float(rest.std(ddof=1) * math.sqrt(1 + 1 / 3))
    made["coefficient at rest of a person at 10 mm/s"] = {
        "friction_coefficient_5_50_95": [
            float(f"{math.exp(middle + 1.645 * side * spread):.3f}") for side in (-1, 0, 1)
        ]
    }
    law = law_of(GLASS_2018, 30e3, 0.34, 0.04).by(model)
    lengths = lengths_at(model, random.uniform(0.02, 0.08, DRAWS), random)
    made["talc-covered finger, 30 kHz, 0.34 N, 20 to 80 mm/s"] = curve_of(law, lengths, random)
    law, one = law_of(GLASS_2016, 32.1e3, 0.5, 0.01).by(model), np.array([2.1e-6])
    for name, spread, scale in (
        ("human finger at 2.1 um, 0.5 N, 10 mm/s, 32.1 kHz", PEOPLE, 1.0),
        ("stiff artificial finger at 2.1 um, 0.5 N, 10 mm/s, 32.1 kHz", 3 * PEOPLE, 2.0),
    ):
        lengths = lengths_at(model, 0.01, random, spread, scale)
        made[name] = {"relative_friction_5_50_95": curve_quantiles(law, lengths, one, random)[0]}
    if model == "levitation-ridges":
        made["share of the effect left at 0.017 atm, one more repeat"] = {
            "share_5_50_95": vacuum_shares(random)
        }
        return made
    decays = np.loadtxt(
        presets.friction_folder() / "monnoyer2018-strokes.csv", delimiter=",", skiprows=1
    )
    logs = np.log(decays)
    made["seventy more strokes of 14 people"] = {
        "decay_amplitude_um_5_25_50_75_95": _log_normal(logs[:, 0]),
        "friction_at_rest_5_25_50_75_95": _log_normal(logs[:, 1]),
        "correlation_of_logarithms": float(f"{np.corrcoef(logs.T)[0, 1]:.2f}"),
    }
    shares = np.array([0.82, 0.60, 0.64])
    from scipy.stats import t

    reach = t.ppf([0.05, 0.5, 0.95], 2) * np.std(shares, ddof=1) * math.sqrt(1 + 1 / 3)
    made["share of the effect left at 0.017 atm, one more repeat"] = {
        "share_5_50_95": np.clip(shares.mean() + reach, 0.0, 1.0).round(3).tolist()
    }
    return made


def vacuum_shares(random: Any) -> list[float]:
    """5, 50 and 95 % of the share of the friction reduction that is left at 0.017 atm, over the
    lengths of an artificial finger."""
    law = replace(law_of(GLASS_2016, 29.075e3, 0.35, 0.01).by("levitation-ridges"), slip="veijola")
    thin = replace(law, gas=law.gas.at_pressure(0.017 * law.gas.ambient_pressure))
    lengths, one = lengths_at(law.model, 0.01, random, 2 * PEOPLE), np.array([1.6e-6])
    whole, left = (1 - drawn_curves(here, lengths, one)[:, 0] for here in (law, thin))
    return [float(f"{x:.3f}") for x in np.quantile(left / whole, [0.05, 0.5, 0.95])]


def _log_normal(logs: si.FloatArray) -> list[float]:
    from scipy.stats import norm

    levels = norm.ppf([0.05, 0.25, 0.5, 0.75, 0.95])
    return [float(f"{x:.3f}") for x in np.exp(logs.mean() + levels * logs.std(ddof=1))]


def text(model: FrictionModel) -> str:
    """The file of a model without its digest."""
    document = tomlkit.document()
    document.add(tomlkit.comment("Predictions, made before what was measured was read."))
    document["title"] = "Friction of fingers on ultrasonic glass that was kept back"
    document["made"] = {"date": "2026-11-27", "by": "python tools/predict_friction.py",
                        "draws": DRAWS, "seed": SEED}  # fmt: skip
    document["assumed"] = list(ASSUMED if model == "levitation" else OVER_RIDGES)
    document["prediction"] = dict(predictions(model))
    return tomlkit.dumps(document)


def alike(written: str, made: str) -> bool:
    """Whether a file that was written is sealed, and says what comes out now: numbers with
    decimals may differ by one in the third, as they do where the same films are solved anew."""
    number = re.compile(r"\d+\.\d+")
    before, now = (one.rsplit("\nsha256", 1)[0] for one in (written, made))
    numbers = [np.array([float(found) for found in number.findall(one)]) for one in (before, now)]
    same_words = is_sealed(written) and number.sub("", before) == number.sub("", now)
    return same_words and bool(np.all(np.abs(numbers[0] - numbers[1]) < 0.0015))


def main() -> int:
    """Write the predictions, or compare them with those that were written."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    check, changed = parser.parse_args().check, False
    for model, file in FILES.items():
        made = sealed(text(model))
        if check:
            same = alike(file.read_text(encoding="utf-8"), made)
            print(f"{model}: {'the same' if same else 'another prediction comes out'}")
            changed |= not same
        else:
            file.write_text(made, encoding="utf-8")
            print(file)
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main())
