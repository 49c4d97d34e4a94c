"""Pictures of the preset textures for the documentation; run by `make gallery`.

Each texture seen from above at an exploring speed, and the friction along a line through it. Run
without arguments in a checkout it rewrites docs/gallery.md and docs/gallery/*.png; with ``--check``
it only says whether they are current (exit code 1 if not).
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np

from squeezefilm.core import presets
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit import style
from squeezefilm.design.report.texture_figures import picture
from squeezefilm.physics.texture_files.texture_file import load_texture


def gallery_files() -> dict[str, bytes]:
    """Every file of the gallery by its path below docs/."""
    files: dict[str, bytes] = {}
    parts = [
        "# Gallery of textures\n",
        "The textures that come with the package, for `squeezefilm render NAME --display …`, each",
        "from above and along the dashed line. [Textures](reference/textures.md) says what they "
        "are made of,",
        "[Describe](reference/describe.md) how to write your own. Page and pictures: "
        "`make gallery`.\n",
    ]
    for name in presets.texture_names():
        texture = load_texture(name)
        files[f"gallery/{name}.png"] = style.png(picture(texture), dots_per_inch=80)
        text = presets.resolve(name, "texture").read_text(encoding="utf-8").strip()
        body = re.sub(r'\Atitle = ".*"\n+', "", text)
        parts.append(f"## {texture.title}: `{name}`\n")
        parts.append(f"![{texture.title}, from above and along a line](gallery/{name}.png)\n")
        parts.append(f"```toml\n{body}\n```\n")
    files["gallery.md"] = ("\n".join(parts).strip() + "\n").encode()
    return files


def main(arguments: list[str]) -> int:
    """Write the gallery into docs/ of the checkout, or with ``--check`` compare; the exit code."""
    docs = Path(__file__).parents[1] / "docs"
    if not docs.is_dir():
        raise InputError("there is no docs folder beside tools; run this in a checkout")
    stale = [
        name
        for name, data in gallery_files().items()
        if not (docs / name).is_file() or not _same(docs / name, data)
    ]
    if "--check" in arguments:
        for name in stale:
            print(f"docs/{name} is not current; run: make gallery")
        return 1 if stale else 0
    (docs / "gallery").mkdir(exist_ok=True)
    for name, data in gallery_files().items():
        (docs / name).write_bytes(data)
    for path in (docs / "gallery").glob("*.png"):
        if path.stem not in presets.texture_names():
            path.unlink()
    return 0


def _same(path: Path, data: bytes) -> bool:
    """Equal text, or pictures that differ by no more than another machine's rounding."""
    if path.suffix != ".png":
        return path.read_bytes() == data
    import io

    from PIL import Image

    with Image.open(path) as one, Image.open(io.BytesIO(data)) as other:
        if one.size != other.size:
            return False
        difference = np.abs(
            np.asarray(one.convert("RGB"), dtype=float)
            - np.asarray(other.convert("RGB"), dtype=float)
        )
    return float(np.mean(difference)) < 0.5


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
