"""Predict the second radial mode of a measured disc before its recording is opened.

    python tools/predict_disc.py first-radial.csv             # writes predictions/….toml
    python tools/predict_disc.py first-radial.csv --check     # makes it again and compares

The recording: frequency in Hz, |Z| in Ω, phase in degrees, of a free disc poled through its
thickness and covered by its electrodes. The file that is written ends with the SHA-256 of all
lines before: whoever changes the prediction later changes that, and its commit says when it was
made.
"""

from __future__ import annotations

import argparse
import hashlib
import math
import subprocess
import sys
import tomllib
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from radial_mode import RadialPrediction, predict_radial_mode
from squeezefilm import __version__
from squeezefilm.measure.fits.ceramic.constants import DiscConstants, disc_constants
from squeezefilm.measure.fits.estimate import Estimate
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc

ROOT = Path(__file__).parents[1]
FILE = ROOT / "predictions" / "pzt-disc-35mm-second-radial.toml"
DIAMETER, THICKNESS, MASS = 35e-3, 2e-3, 14.8993e-3
DISC = CeramicDisc(DIAMETER, THICKNESS, MASS / (math.pi / 4 * DIAMETER**2 * THICKNESS))
SEED, DRAWS = 19, 2000

ASSUMED = (
    "The disc is free, round, homogeneous, poled through its thickness and covered by electrodes.",
    "Poisson's ratio, s13, s33, s44, d33, d15 and eps11 are not told by the first radial mode: "
    "their ratios scatter as those of the four ceramics of squeezefilm's library (PZT-4, PZT-5A, "
    "PZT-5H, PZT-8). The Poisson's ratio that was stated elsewhere for this disc is not used: it "
    "may have come from the mode that is predicted.",
    "Constants fall with frequency as a constant loss asks for (Kramers and Kronig), by 1 +- 0.5 "
    "of that; without it the frequencies would be 0.37 % lower.",
    "Mechanical losses differ from those at the first mode by 12 %, electrical ones by 20 % beside "
    "it (standard deviations, assumed). The loss of s12 is that of s11 within 20 % (assumed).",
    "What the solved disc leaves at the peaks of the first mode it may leave at the second.",
    "Tolerances of diameter and thickness are taken up by the fit: 1 % of thickness changes the "
    "predicted frequencies by 0.012 %, 0.3 % of diameter by 0.004 %.",
)


def sealed(text: str) -> str:
    """The text with the digest of itself as its last line."""
    digest = hashlib.sha256(text.encode()).hexdigest()
    return f'{text}sha256 = "{digest}"\n'


def is_sealed(text: str) -> bool:
    """Whether the last line is the digest of those before."""
    content, mark, _ = text.rpartition('sha256 = "')
    return bool(mark) and sealed(content) == text


def read_sweep(path: Path) -> ImpedanceSweep:
    """Frequency, |Z| and phase in degrees, under one line of names."""
    frequency, size, phase = np.loadtxt(path, delimiter=",", skiprows=1).T
    return ImpedanceSweep(frequency, np.exp(-1j * np.radians(phase)) / size)


def _told(estimate: Estimate) -> dict[str, Any]:
    low, high = estimate.interval
    return {
        "value": float(f"{estimate.value:.6g}"),
        "standard_error": float(f"{estimate.standard_error:.3g}"),
        "interval_95": [float(f"{low:.6g}"), float(f"{high:.6g}")],
        "unit": estimate.unit,
    }


def prediction_text(
    recording: Path, constants: DiscConstants, found: RadialPrediction, made: dict[str, str]
) -> str:
    """The whole prediction as TOML, without its digest."""
    page = tomlkit.document()
    page.add(tomlkit.comment("A prediction, made before the recording of this mode was opened."))
    page["title"] = "Second radial mode of a free ceramic disc, predicted from its first"
    page["disc"] = {"diameter_m": DIAMETER, "thickness_m": THICKNESS, "mass_kg": MASS}
    page["made"] = {
        **made,
        "by": "python tools/predict_disc.py",
        "squeezefilm": __version__,
        "draws": found.draws,
        "seed": found.seed,
        "fitted_to": recording.name,
        "fitted_to_sha256": hashlib.sha256(recording.read_bytes()).hexdigest(),
    }
    page["definitions"] = {
        "series_resonance": "frequency of the largest conductance, Re Y",
        "parallel_resonance": "frequency of the largest resistance, Re 1/Y",
        "peak_conductance": "largest Re Y",
        "peak_resistance": "largest Re 1/Y",
        "value": "median; intervals hold 95 % of the draws",
    }
    page["prediction"] = {name: _told(getattr(found, name)) for name in PREDICTED}
    page["share_of_variance"] = {
        source: {name: round(share, 3) for name, share in zip(PREDICTED, shares, strict=True)}
        for source, shares in found.shares.items()
    }
    page["assumed"] = {"sentences": list(ASSUMED)}
    page["fitted"] = {
        "mean_misfit": round(constants.adequacy.residual, 5),
        "adequacy": constants.adequacy.sentence,
        **{name: _told(getattr(constants, name)) for name in FITTED},
    }
    page["standard_deviation_over_that_of_the_prior"] = {
        name: float(f"{left:.3g}") for name, left in constants.from_data.items()
    }
    page["combinations_that_the_first_mode_tells"] = {
        str(k + 1): {
            "left_of_the_standard_deviation": float(f"{one.left:.2g}"),
            **{name: round(weight, 2) for name, weight in one.weights.items()},
        }
        for k, one in enumerate(constants.combinations)
    }
    return f"{tomlkit.dumps(page)}\n[seal]\n"


PREDICTED = ("series_resonance", "parallel_resonance", "peak_conductance", "peak_resistance")
FITTED = (
    "compliance_11",
    "compliance_12",
    "poisson_ratio",
    "charge_coefficient_31",
    "free_permittivity_33",
    "planar_coupling",
    "quality_factor",
    "charge_loss",
    "dielectric_loss",
)


def difference(old: dict[str, Any], found: RadialPrediction) -> float:
    """The largest relative difference of a prediction made again, in half intervals."""
    worst = 0.0
    for name in PREDICTED:
        before, now = old["prediction"][name], getattr(found, name)
        low, high = before["interval_95"]
        ends = [before["value"] - now.value, low - now.interval[0], high - now.interval[1]]
        worst = max(worst, *(abs(end) / ((high - low) / 2) for end in ends))
    return worst


def main() -> int:
    """Make the prediction, or make it again and compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording", type=Path)
    parser.add_argument("--check", action="store_true", help="compare with the file that is there")
    arguments = parser.parse_args()
    sweep = read_sweep(arguments.recording)
    constants = disc_constants(sweep, DISC)
    found = predict_radial_mode(constants, sweep, seed=SEED, draws=DRAWS)
    if arguments.check:
        text = FILE.read_text(encoding="utf-8")
        worst = difference(tomllib.loads(text), found)
        print(
            f"seal holds: {is_sealed(text)}; made again, it differs by {worst:.3f} half intervals"
        )
        return 0 if is_sealed(text) and worst < 0.05 else 1
    if FILE.exists():
        print(f"{FILE.name} is there; a prediction is made once", file=sys.stderr)
        return 1
    commit = ["git", "rev-parse", "--short", "HEAD"]
    made = {
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "commit": subprocess.run(
            commit, cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout.strip(),
    }
    FILE.parent.mkdir(exist_ok=True)
    text = sealed(prediction_text(arguments.recording, constants, found, made))
    FILE.write_text(text, encoding="utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
