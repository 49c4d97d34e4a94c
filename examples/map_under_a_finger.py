"""# A map under a finger

A map drawn in NumPy, saved as PNG and TOML, felt along a slanted stroke on a display.
"""

import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

import squeezefilm as sf

TOML = """
title = "Rings"

[texture]
type = "relative_friction"
low = 0.4
high = 1.0
pattern = { type = "image_file", file = "rings.png", pixel = "0.1 mm" }
"""
STROKE = "40 mm/s over 20 mm, 2 passes, from 2 mm, y 5 mm, at 30 deg"


def main() -> dict[str, float]:
    y, x = np.mgrid[0:200, 0:200] * 0.1e-3
    rings = 0.5 + 0.5 * np.sin(2 * np.pi * np.hypot(x - 0.01, y - 0.01) / 2.5e-3)
    found: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        Image.fromarray(np.uint8(255 * rings)).save(Path(folder) / "rings.png")
        (Path(folder) / "rings.toml").write_text(TOML)
        texture = sf.load_texture(Path(folder) / "rings.toml")
        sf.plot(texture).savefig("map_under_a_finger.png")
        for compensation in ("none", "inverse"):
            result = sf.render_texture(
                "winfield2007-tpad", texture, STROKE, compensation=compensation
            )
            found[compensation] = result.rms_error
            print(f"{compensation:8}: friction within {result.rms_error:.4f} RMS of what was asked")
        sf.write_report(result, Path(folder) / "out", hjif=True)
        written = sorted(one.name for one in (Path(folder) / "out").iterdir())
        print("written:", *written)
        return {**found, "mpeg_haptics_bytes": (Path(folder) / "out/texture.hjif").stat().st_size}


if __name__ == "__main__":
    main()
