"""A texture of friction, composed, written to a file, and played on the paper's plate."""

import numpy as np

from squeezefilm.chain.prediction import predict
from squeezefilm.display import load_display
from squeezefilm.render.program.inverse import FrictionInverse
from squeezefilm.render.program.lowering import lower
from squeezefilm.render.program.renderer import render
from squeezefilm.render.program.wave import WaveCompensation
from squeezefilm.render.texture.gates import speed
from squeezefilm.render.texture.levels import RelativeFriction
from squeezefilm.render.texture.noise import Noise
from squeezefilm.render.texture.shapes import Band, Bump, SquareWave
from squeezefilm.texture_file import texture_from_text, texture_text


def main() -> dict[str, float]:
    p = predict(load_display("biet2008-plate"))
    inverse = FrictionInverse.from_function(
        p.law.table(p.vibration_amplitude), p.vibration_amplitude
    )
    least = inverse.least_friction
    print(f"friction from {least:.2f} to 1, met within {inverse.max_error:.1e}")

    # A grating of 2 mm, then a rough stretch with a bump in it; at rest unless the finger moves.
    fine = RelativeFriction(SquareWave(2e-3), least, 1.0)
    rough = RelativeFriction(Noise(1e-3, seed=7) | Bump(0.03, 2e-3), least, 1.0)
    texture = (fine.then(rough, at=0.02) & Band(0.0, 0.04, fade=1e-3)).when(speed > 0.005)
    text = texture_text(texture)
    assert texture_from_text(text).texture == texture
    print(text)

    # A finger at 80 mm/s; the sensor loses it for 15 ms.
    t = np.arange(0.0, 0.5, 1e-3)
    x = 0.08 * t
    x[100:115] = np.nan
    played = render(lower(texture, inverse=inverse), x, 0.0, 0.08, t)
    print(f"{played.counters}")

    # The plate's wave is weaker off its antinodes; dividing by it costs amplitude.
    wave = WaveCompensation.over_contact(p.mode.half_wavelength, contact_length=6e-3)
    evened = render(lower(texture, inverse=inverse, compensation=wave), x, 0.0, 0.08, t)
    print(f"with the wave made up for, {evened.counters.saturated} ticks want more than there is")
    return {
        "least_friction": least,
        "inverse_error": inverse.max_error,
        "largest_amplitude_m": float(played.amplitude.max()),
        "available_amplitude_m": p.vibration_amplitude,
        "lost": played.counters.bad_place,
        "unreachable": played.counters.unreachable,
        "saturated": evened.counters.saturated,
    }


if __name__ == "__main__":
    main()
