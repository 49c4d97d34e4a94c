"""# A sweep over the thickness

How thick must an aluminium plate be to work at 40 kHz, and what does each thickness do to
amplitude and friction? Every point is a plate solved in three dimensions.
"""

import squeezefilm as sf

THICKNESSES = ["1.5 mm", "1.75 mm", "2 mm", "2.25 mm", "2.5 mm"]
ASKED = ["resonance_frequency", "amplitude_per_volt", "relative_friction"]


def main() -> dict[str, list[float]]:
    found = sf.sweep(
        "own_plate.toml", vary={"actuator.thickness": THICKNESSES}, ask=",".join(ASKED)
    )
    answers = {name: [float(one) for one in found.column(name)] for name in ASKED}
    for thickness, frequency in zip(THICKNESSES, answers["resonance_frequency"], strict=True):
        print(f"{thickness}: {1e-3 * frequency:.2f} kHz")
    sf.plot(found).savefig("sweep_over_thickness.png")
    return answers


if __name__ == "__main__":
    main()
