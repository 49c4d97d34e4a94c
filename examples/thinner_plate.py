"""# A thinner plate

What a thinner plate would do: resonance and amplitude per volt of a design of one's own.
"""

import squeezefilm as sf


def main() -> list[tuple[str, float, float]]:
    found, predictions = [], []
    for thickness in ("2 mm", "1.5 mm", "1 mm"):
        plate = sf.replaced("biet2008-plate", {"actuator.thickness": thickness})
        predictions.append(sf.predict(plate))
        mode = predictions[-1].mode
        found.append((thickness, mode.resonance_frequency, mode.amplitude_per_volt))
        print(
            f"{thickness}: {mode.resonance_frequency / 1e3:.2f} kHz, "
            f"{mode.amplitude_per_volt * 1e9:.0f} nm/V ({mode.model})"
        )
    sf.plot(predictions).savefig("thinner_plate.png")
    return found


if __name__ == "__main__":
    main()
