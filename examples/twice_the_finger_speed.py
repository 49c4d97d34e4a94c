"""A 0.4 mm grating at twice the speed its plate can follow, with a sensor that knows the finger."""

from squeezefilm.analysis.textures import driven_envelope
from squeezefilm.chain.prediction import predict
from squeezefilm.display import load_display
from squeezefilm.render.fidelity.rendered_stroke import rendered_stroke
from squeezefilm.render.fidelity.report import FidelityReport, fidelity_report
from squeezefilm.render.motion.sensor import LVDT_10_KHZ
from squeezefilm.render.motion.stroke import Stroke
from squeezefilm.render.resonator.square_swing import fastest_compensated_speed
from squeezefilm.render.texture.gratings import Square


def main() -> dict[str, FidelityReport]:
    p = predict(load_display("biet2008-plate"))
    envelope = driven_envelope(p, braking=True)
    grating = Square(0.4e-3, low=0.0, high=0.8 * envelope.amplitude_limit)
    speed = 2 * fastest_compensated_speed(0.4e-3, envelope, grating.low, grating.high, "none")
    friction = p.law.table(envelope.amplitude_limit)
    reports = {}
    for compensation in ("none", "inverse", "preview"):
        stroke = rendered_stroke(
            grating, Stroke(speed, 0.05, 4), envelope, friction,
            compensation=compensation, sensor=LVDT_10_KHZ, control_rate=40e3,
        )  # fmt: skip
        r = reports[compensation] = fidelity_report(stroke)
        print(
            f"{compensation:>8} at {1e3 * speed:.0f} mm/s: friction errs by {r.rms_error:.3f}, "
            f"keeps {r.contrast_kept[0]:.0%} of its contrast, trails {1e6 * r.lag:.0f} µm"
        )
    return reports


if __name__ == "__main__":
    main()
