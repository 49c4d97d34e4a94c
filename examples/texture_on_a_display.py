"""# A texture of your own

A texture of friction, composed, written to a file, and rendered on the paper's plate.
"""

import tempfile
from pathlib import Path

import squeezefilm as sf


def main() -> dict[str, float]:
    p = sf.predict("biet2008-plate")
    least = p.inverse.least_friction
    print(f"friction from {least:.2f} to 1, met within {p.inverse.max_error:.1e}")

    # A grating of 2 mm, then a rough stretch with a bump in it; at rest unless the finger moves.
    fine = sf.RelativeFriction(sf.SquareWave("2 mm"), least, 1.0)
    rough = sf.RelativeFriction(sf.Noise("1 mm", seed=7) | sf.Bump("30 mm", "2 mm"), least, 1.0)
    whole = fine.then(rough, at="20 mm") & sf.Band("1 mm", "40 mm", fade="1 mm")
    texture = whole.when(sf.speed > "5 mm/s")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "texture.toml"
        sf.save_texture(texture, file)
        print(file.read_text())
        assert sf.load_texture(file).texture == texture

    played = sf.render_texture("biet2008-plate", texture, "80 mm/s over 4 cm")
    print(f"{played.counters}")

    # The plate's wave is weaker off its antinodes; making up for it costs amplitude.
    evened = sf.render_texture("biet2008-plate", texture, "80 mm/s over 4 cm", wave="compensated")
    print(f"with the wave made up for, {evened.counters.saturated} ticks want more than there is")
    sf.plot(played).savefig("texture_on_a_display.png")
    return {
        "least_friction": least,
        "inverse_error": p.inverse.max_error,
        "largest_amplitude_m": float(played.stroke.wanted.max()),
        "available_amplitude_m": p.vibration_amplitude,
        "unreachable": played.counters.unreachable,
        "saturated": evened.counters.saturated,
        "ticks": evened.counters.ticks,
    }


if __name__ == "__main__":
    main()
