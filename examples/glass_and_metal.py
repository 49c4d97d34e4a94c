"""# Mode shapes of glass and metal

How a solved plate moves: the working mode of a glass disc and of the paper's metal plate.
"""

import squeezefilm as sf


def main() -> dict[str, float]:
    found = {}
    for name, figure in (("winfield2007-tpad", "shape"), ("biet2008-plate", "plan")):
        mode = sf.predict(name).mode
        found[name] = mode.resonance_frequency
        print(
            f"{name}: {mode.label} at {mode.resonance_frequency / 1e3:.2f} kHz, "
            f"{mode.amplitude_per_volt * 1e9:.0f} nm/V, half wavelength "
            f"{mode.half_wavelength * 1e3:.1f} mm"
        )
        sf.plot(sf.solve_plate(name), figure).savefig(f"{name}.png")
    return found


if __name__ == "__main__":
    main()
