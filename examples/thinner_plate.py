"""What a thinner plate would do: resonance and amplitude per volt of a design of one's own."""

import dataclasses

from squeezefilm.display import load_display
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.working_mode import working_mode


def main() -> list[tuple[float, float, float]]:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    found = []
    for thickness in (2.0e-3, 1.5e-3, 1.0e-3):
        mode = working_mode(dataclasses.replace(plate, thickness=thickness))
        found.append((thickness, mode.resonance_frequency, mode.amplitude_per_volt))
        print(
            f"{thickness * 1e3:.1f} mm: {mode.resonance_frequency / 1e3:.2f} kHz, "
            f"{mode.amplitude_per_volt * 1e9:.0f} nm/V ({mode.model})"
        )
    return found


if __name__ == "__main__":
    main()
