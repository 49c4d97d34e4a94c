"""Predict detection thresholds that were measured at another speed and kept back, before they are
read.

    python tools/predict_thresholds.py             # writes predictions/detection-thresholds-….toml
    python tools/predict_thresholds.py --check     # makes it again and compares

Rival senses (`validation.populations`) and their mixture; the file ends with the SHA-256
of all lines before, as those of `tools/predict_disc.py` do.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from predict_disc import sealed
from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.senses import MEAN_FRICTION
from squeezefilm.validation.populations import (
    RIVALS,
    detection_medians,
    rival_observer,
)
from threshold_fit import fitted, published

FILE = Path(__file__).parents[1] / "predictions" / "detection-thresholds-at-100-mm-per-s.toml"
SPEED, SEED, DRAWS = 0.1, 45, 20000
PERIODS = np.array([8.0, 4.0, 2.0, 1.0, 0.5, 0.25]) * 1e-3
FITTED_NUMBERS = 2
ASSUMED = (
    "A threshold is the median over the same 15 people of the least amplitude (zero-to-peak) of "
    "the friction coefficient that is detected, by the same method and force, at 100 mm/s.",
    "Two numbers were fitted to the thresholds at 50 mm/s (tools/threshold_fit.py): what the mean "
    "stretch of sliding skin masks in the slow channels, and in the fast one. At 50 mm/s all "
    "rivals are the same curve.",
    f"The mean friction coefficient is taken to be {MEAN_FRICTION:g} at both speeds.",
    "Interval: 5 to 95 % of Student's t of the logarithms, with the root mean square error of the "
    "seven thresholds at 50 mm/s, each predicted from the other six, and five degrees of freedom.",
    "The mixture has the rivals with equal weights, fixed before: thresholds at one speed say "
    "nothing of which is nearer.",
    "Of the source its abstract was seen, which says that speed matters strongly; no threshold at "
    "100 mm/s was. It changed neither rivals nor weights.",
)


def left_out_error() -> si.Dimensionless:
    """The root mean square of ln(predicted/measured) of each threshold, predicted from the others
    (1)."""
    measured, observer = published(), load_observer()
    alone = [
        detection_medians(fitted(observer, measured, k), measured)[k]
        for k in range(measured.period.size)
    ]
    return float(np.sqrt(np.mean(np.log(alone / measured.amplitude) ** 2)))


def predictions() -> dict[str, Any]:
    """5, 50 and 95 % of each threshold by each rival and by their mixture."""
    measured, observer = published(), load_observer()
    error = left_out_error()
    freedom = measured.period.size - FITTED_NUMBERS
    drawn = error * np.random.default_rng(SEED).standard_t(freedom, (len(RIVALS), DRAWS, 1))
    medians = np.array(
        [
            detection_medians(rival_observer(observer, rival), measured, speed=SPEED,
                              period=PERIODS)
            for rival in RIVALS
        ]
    )  # fmt: skip
    draws = medians[:, None, :] * np.exp(drawn)
    made: dict[str, Any] = {}
    for rival, values in [*zip(RIVALS, draws, strict=True), ("mixture", draws.reshape(-1, 6))]:
        rows = np.quantile(values, [0.05, 0.5, 0.95], axis=0).T
        made[rival] = {
            "friction_coefficient_amplitude_5_50_95": [
                [float(f"{x:.3g}") for x in row] for row in rows
            ]
        }
    return made


def text() -> str:
    """The file without its digest."""
    document = tomlkit.document()
    document.add(tomlkit.comment("Predictions, made before what was measured was read."))
    document["title"] = "Detection thresholds of friction modulation at 100 mm/s, kept back"
    document["made"] = {"date": "2026-11-27", "by": "python tools/predict_thresholds.py",
                        "draws": DRAWS, "seed": SEED}  # fmt: skip
    document["assumed"] = list(ASSUMED)
    document["finger_speed"] = "100 mm/s"
    document["spatial_period_mm"] = (1e3 * PERIODS).round(6).tolist()
    document["threshold"] = predictions()
    return tomlkit.dumps(document)


def main() -> int:
    """Write the predictions, or compare them with those that were written."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    made = sealed(text())
    if parser.parse_args().check:
        same = FILE.read_text(encoding="utf-8") == made
        print("the same" if same else "another prediction comes out")
        return 0 if same else 1
    FILE.write_text(made, encoding="utf-8")
    print(FILE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
