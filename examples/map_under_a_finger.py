"""A map drawn in NumPy, saved as PNG and TOML, felt along a slanted stroke on a display."""

import tempfile
from pathlib import Path

import numpy as np

from squeezefilm.chain.rendered_texture import render_texture
from squeezefilm.display import load_display
from squeezefilm.formats.hjif import ReferenceDevice, hjif_of
from squeezefilm.formats.hjif_read import texture_of_hjif
from squeezefilm.formats.pictures import picture_bytes
from squeezefilm.formats.trajectories import motion_from
from squeezefilm.texture_file import load_texture

TOML = """
title = "Rings"

[texture]
type = "relative_friction"
low = 0.4
high = 1.0
pattern = { type = "image_file", file = "rings.png", pixel = "0.1 mm" }
"""


def main() -> dict[str, float]:
    y, x = np.mgrid[0:200, 0:200] * 0.1e-3
    rings = 0.5 + 0.5 * np.sin(2 * np.pi * np.hypot(x - 0.01, y - 0.01) / 2.5e-3)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "rings.png").write_bytes(picture_bytes(rings, bits=16))
        (Path(folder) / "rings.toml").write_text(TOML)
        texture = load_texture(Path(folder) / "rings.toml")

    display = load_display("winfield2007-tpad")
    stroke = motion_from("40 mm/s over 20 mm, 2 passes, from 2 mm, y 5 mm, at 30 deg")
    found = {}
    for compensation in ("none", "inverse"):
        result = render_texture(display, texture, stroke, compensation=compensation)
        found[compensation] = result.rms_error
        print(f"{compensation:8}: friction within {result.rms_error:.4f} RMS of what was asked for")

    device = ReferenceDevice(display.name, result.prediction.frequency, 20.0, 3.8e-6)
    export = hjif_of(texture.texture, 0.0, 0.02, device=device, title="Rings")
    back = texture_of_hjif(export.document)
    print("as MPEG haptics, lost:", *export.lost, sep="\n  ")
    at = np.linspace(0.0, 0.02, 1000)
    error = back.texture(at, 0.0, 0.04, 0.0) - texture.texture(at, 0.0, 0.04, 0.0)
    return {
        **found,
        "largest_error_through_hjif": float(np.max(np.abs(error))),
        "things_lost": len(export.lost),
    }


if __name__ == "__main__":
    main()
