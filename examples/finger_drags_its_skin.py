"""A square grating under a finger whose skin has a mass: its force, and how the skin vibrates."""

from squeezefilm.chain.prediction import predict
from squeezefilm.chain.stroke_force import stroke_force
from squeezefilm.contact.finger.fingerpad import EVIDENCE
from squeezefilm.display import load_display
from squeezefilm.render.fidelity.trace import friction_trace
from squeezefilm.render.motion.stroke import Stroke
from squeezefilm.render.resonator.envelope import envelope_time_constant
from squeezefilm.render.texture.gratings import Square


def main() -> dict[str, float]:
    display = load_display("biet2008-plate")
    p = predict(display, model="paper2008")
    tau = float(envelope_time_constant(p.mode.quality_factor, p.mode.resonance_frequency))
    grating = Square(spatial_period=1e-3, low=0.0, high=p.vibration_amplitude)
    friction = p.law.table(p.vibration_amplitude)
    trace = friction_trace(grating, Stroke(speed=0.08, length=0.04), tau, friction)
    force = stroke_force(trace, display.surface().friction_coefficient, 0.5)
    lines = force.vibration()
    motion = force.motion
    sliding = motion.bone_force[motion.time >= force.settled]
    result = {
        "sticks_until_s": float(motion.time[motion.sticking][-1]),
        "least_force_N": float(sliding.min()),
        "greatest_force_N": float(sliding.max()),
        "fundamental_Hz": float(lines.harmonic_frequency[0]),
        "displacement_amplitude_m": float(lines.displacement_amplitude[0]),
        "energy_residual_J": motion.energy_residual,
    }
    for name, value in result.items():
        print(f"{name}: {value:.4g}")
    print("The pad's mechanics are unverified defaults:", *EVIDENCE.values(), sep="\n  ")
    return result


if __name__ == "__main__":
    main()
