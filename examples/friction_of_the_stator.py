"""The paper's main numbers: how slippery the stator gets, and why not to believe it blindly."""

from squeezefilm.contact.paper import zero_friction_amplitude
from squeezefilm.display import load_display
from squeezefilm.prediction import paper_gap, predict


def main() -> dict[str, float]:
    stator = load_display("biet2008-stator")
    p = predict(stator, vibration_amplitude=2e-6)
    gap = paper_gap(stator, p.surface, p.mode.half_wavelength, p.vibration_amplitude)
    zero = zero_friction_amplitude(gap, p.normal_force, stator.gas.ambient_pressure)
    print(f"squeeze number     {p.squeeze_number:.3f}")
    print(f"relative friction  {p.relative_friction:.3f}  ({p.model})")
    print(f"levitation at      {zero * 1e6:.2f} um")
    for check in p.validity.failed:
        print(f"but: {check.sentence}")
    return {"relative_friction": p.relative_friction, "zero_friction_amplitude": zero}


if __name__ == "__main__":
    main()
