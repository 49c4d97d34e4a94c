"""The paper's main numbers: how slippery the stator gets, and why not to believe it blindly."""

from squeezefilm.chain.prediction import predict
from squeezefilm.display import load_display


def main() -> dict[str, float]:
    stator = load_display("biet2008-stator")
    p = predict(stator, vibration_amplitude=2e-6, model="paper2008")
    zero = p.law.amplitude_for(0.0)
    print(f"squeeze number     {p.squeeze_number:.3f}")
    print(f"relative friction  {p.relative_friction:.3f}  ({p.model})")
    print(f"levitation at      {zero * 1e6:.2f} um")
    for check in p.validity.failed:
        print(f"but: {check.sentence}")
    return {"relative_friction": p.relative_friction, "zero_friction_amplitude": zero}


if __name__ == "__main__":
    main()
