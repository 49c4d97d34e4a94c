"""Prints the table of docs/explanation/models.md: µ'/µ over force, speed, amplitude and law.

Run `python tools/friction_over_laws.py`. The stator's film, µ 0.9, pad at an antinode; what is not
in a column stands at 0.5 N, 80 mm/s and 2 µm. A dash where the law refuses. A test compares
what is printed with the page.
"""

from __future__ import annotations

import dataclasses
import warnings

from squeezefilm.chain.friction import FrictionLaw, friction_law
from squeezefilm.contact.asperities import AsperityLaw
from squeezefilm.display import load_display
from squeezefilm.errors import SqueezefilmError, SqueezefilmWarning

FORCES, SPEEDS, AMPLITUDES = (0.05, 0.1, 0.5, 1, 2, 5), (5, 20, 80, 300), (0.5, 1, 2, 3)
HALF_WAVELENGTH, FREQUENCY = 9.35e-3, 40.5e3

LAWS = {
    "Persson, following (the default)": {},
    "Persson, constant": {"tangential_stiffness": "constant"},
    "Persson, rigid": {"tangential_stiffness": "rigid"},
    "Persson, following, fixed area": {"contact_area_exponent": 0.0},
    "exponential, following": {"asperities": AsperityLaw()},
    "exponential, rigid": {"asperities": AsperityLaw(), "tangential_stiffness": "rigid"},
    "exponential, rigid, fixed area": {
        "asperities": AsperityLaw(),
        "tangential_stiffness": "rigid",
        "contact_area_exponent": 0.0,
    },
    "Gaussian, following": {"asperities": AsperityLaw(heights="gaussian")},
    "Gaussian, rigid, fixed area": {
        "asperities": AsperityLaw(heights="gaussian"),
        "tangential_stiffness": "rigid",
        "contact_area_exponent": 0.0,
    },
}


def law_of(**finger: object) -> FrictionLaw:
    """The stator's law with another finger, at 0.5 N and 80 mm/s."""
    display = load_display("biet2008-stator")
    changed = dataclasses.replace(display.finger, **finger)
    return friction_law(
        dataclasses.replace(display, finger=changed), HALF_WAVELENGTH, FREQUENCY, normal_force=0.5
    )


def cell(law: FrictionLaw, amplitude: float, **at: float) -> str:
    """µ'/µ with two digits, or a dash where the law is refused."""
    try:
        return f"{dataclasses.replace(law, **at).at(amplitude):.2f}".lstrip("0")
    except SqueezefilmError:
        return "–"


def rows() -> list[str]:
    """The table's lines, in Markdown."""
    head = [*(f"{f:g} N" for f in FORCES), *(f"{v:g}" for v in SPEEDS)]
    head[len(FORCES)] += " mm/s"
    head += [f"{AMPLITUDES[0]:g} µm", *(f"{a:g}" for a in AMPLITUDES[1:])]
    found = [f"| law | {' | '.join(head)} |", f"|---{'|---' * len(head)}|"]
    for name, finger in LAWS.items():
        law = law_of(**finger)
        cells = [cell(law, 2e-6, normal_force=f) for f in FORCES]
        cells += [cell(law, 2e-6, speed=1e-3 * v) for v in SPEEDS]
        cells += [cell(law, 1e-6 * a) for a in AMPLITUDES]
        found.append(f"| {name} | {' | '.join(cells)} |")
    return found


if __name__ == "__main__":
    with warnings.catch_warnings():
        # What lies outside of a law's range is what the page speaks of.
        warnings.simplefilter("ignore", SqueezefilmWarning)
        print("\n".join(rows()))
