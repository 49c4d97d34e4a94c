"""# A grating under a finger

A 0.4 mm grating under a finger at three speeds: how much of it gets through the resonator.
"""

import numpy as np

import squeezefilm as sf


def main() -> dict[float, float]:
    high = sf.predict("biet2008-plate").vibration_amplitude
    grating = sf.Amplitude(sf.SquareWave("0.4 mm"), 0.0, high)
    kept = {}
    for speed in (0.05, 0.1, 0.2):
        # A micrometre before an edge no sample falls on one.
        stroke = sf.Stroke(speed, "2 cm", start="1 um")
        rendered = sf.render_texture("biet2008-plate", grating, stroke, control_rate="20 kHz")
        loop = rendered.stroke
        settled = loop.time > 15 * rendered.time_constant
        kept[speed] = float(np.ptp(loop.amplitude[settled]) / np.ptp(loop.wanted[settled]))
        print(f"{speed * 1e3:3.0f} mm/s: {kept[speed]:.0%} of the amplitude's swing is left")
    sf.plot(rendered, "friction").savefig("grating_under_a_finger.png")
    return kept


if __name__ == "__main__":
    main()
