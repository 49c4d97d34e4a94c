"""# Friction of the stator

The paper's main numbers: how slippery the stator gets, and why not to believe it blindly.
"""

import squeezefilm as sf


def main() -> dict[str, float]:
    p = sf.predict("biet2008-stator", vibration_amplitude="2 um", model="paper2008")
    zero = p.law.amplitude_for(0.0)
    print(p)
    print(f"levitation at      {zero * 1e6:.2f} um")
    for check in p.validity.failed:
        print(f"but: {check.sentence}")
    sf.plot(p).savefig("friction_of_the_stator.png")
    return {"relative_friction": p.relative_friction, "zero_friction_amplitude": zero}


if __name__ == "__main__":
    main()
