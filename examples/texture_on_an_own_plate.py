"""# A texture on a plate of one's own

A sine grating of 3 mm on an aluminium plate, under a finger that slides at 60 mm/s: what was
asked for, what the plate renders, and how much of the contrast is left.
"""

import squeezefilm as sf


def main() -> dict[str, float]:
    rendered = sf.render_texture("own_plate.toml", "sine-3mm", "60 mm/s over 4 cm")
    kept = float(rendered.fidelity.contrast_kept[0])
    print(f"{100 * kept:.0f} % of the contrast kept, {1e6 * rendered.fidelity.lag:.0f} µm behind")
    sf.plot(rendered).savefig("texture_on_an_own_plate.png")
    return {"contrast_kept": kept, "lag": rendered.fidelity.lag, "rms_error": rendered.rms_error}


if __name__ == "__main__":
    main()
