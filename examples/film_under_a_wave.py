"""# Gas film under a wave

The gas film under a ridge that a flexural wave bends: pressure within, and what it carries.
"""

import numpy as np

import squeezefilm as sf


def main() -> dict[str, float]:
    # X from −1/2 to 1/2 across the ridge, T the phase: mean gap 1, excursion 0.5.
    flat = sf.solve_film(20, lambda X, T: 1 + 0 * X + 0.5 * np.cos(T))
    bent = sf.solve_film(20, lambda X, T: 1 + 0.5 * np.cos(np.pi * X) * np.cos(T))
    for name, film in (("flat surface", flat), ("flexural wave", bent)):
        print(
            f"{name:>13}: over-pressure {film.over_pressure:.4f} of ambient, "
            f"± {film.over_pressure_error:.1e}"
        )
    sf.plot(bent).savefig("film_under_a_wave.png")
    # What a flat film of vast squeeze number carries: √((1 + 3ε²/2) / (1 − ε²)) − 1.
    limit = float(np.sqrt((1 + 1.5 * 0.5**2) / (1 - 0.5**2)) - 1)
    return {"flat": flat.over_pressure, "bent": bent.over_pressure, "limit": limit}


if __name__ == "__main__":
    main()
