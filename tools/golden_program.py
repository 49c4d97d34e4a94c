"""Append a case to the golden programs, which say for good what an instruction means.

    python tools/golden_program.py "a triangle wave" triangle.toml

The file's texture, whose levels are amplitudes, is lowered and rendered at the samples of the first
case. Cases that are there are never made anew: stored programs would mean something else.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.program.renderer import render
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.texture_files.texture_file import load_texture

STORED = Path(__file__).parents[1] / "tests" / "properties" / "golden_programs.json"
LARGEST_AMPLITUDE = 4e-6  # m


def golden_case(name: str, texture: Composable, samples: list[list[Any]]) -> dict[str, Any]:
    """The program of a texture, and what it gives at samples (x, y in m, v in m/s, t in s)."""
    if texture.quantity != "amplitude":
        raise InputError(f"a golden program's levels are amplitudes, not {texture.quantity}")
    program = lower(texture, largest_amplitude=LARGEST_AMPLITUDE)
    where = np.array([[float(number) for number in sample] for sample in samples]).T
    found = render(program, *where)
    return {
        "name": name,
        "program": program.array.tolist(),
        "samples": samples,
        "amplitude": found.amplitude.tolist(),
        "flags": found.flags.tolist(),
    }


def main() -> None:
    """Append the case that the command line names."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("name", help="what the case is of")
    parser.add_argument("texture", type=Path, help="a texture file")
    arguments = parser.parse_args()
    stored = json.loads(STORED.read_text("utf-8"))
    cases = stored["cases"]
    if any(case["name"] == arguments.name for case in cases):
        parser.error(f"there is a case of the name {arguments.name!r}")
    try:
        texture = load_texture(arguments.texture).texture
        cases.append(golden_case(arguments.name, texture, cases[0]["samples"]))
    except InputError as error:
        parser.error(str(error))
    STORED.write_text(json.dumps(stored, separators=(",", ":")), "utf-8")


if __name__ == "__main__":
    main()
