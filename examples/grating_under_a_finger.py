"""A 0.4 mm grating under a finger at three speeds: how much of it gets through the resonator."""

from squeezefilm.chain.prediction import predict
from squeezefilm.display import load_display
from squeezefilm.render.fidelity.survival import swing_kept
from squeezefilm.render.fidelity.trace import friction_trace
from squeezefilm.render.motion.stroke import Stroke
from squeezefilm.render.resonator.envelope import envelope_time_constant
from squeezefilm.render.texture.gratings import Square


def main() -> dict[float, float]:
    display = load_display("biet2008-plate")
    p = predict(display)
    tau = float(envelope_time_constant(p.mode.quality_factor, p.mode.resonance_frequency))
    grating = Square(spatial_period=0.4e-3, low=0.0, high=p.vibration_amplitude)
    friction = p.law.table(p.vibration_amplitude)
    kept = {}
    for speed in (0.05, 0.1, 0.2):
        trace = friction_trace(grating, Stroke(speed=speed, length=0.02), tau, friction)
        kept[speed] = swing_kept(trace)
        print(f"{speed * 1e3:3.0f} mm/s: {kept[speed]:.0%} of the amplitude's swing is left")
    return kept


if __name__ == "__main__":
    main()
