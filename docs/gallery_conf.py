"""How the build of the documentation finds the pictures of the examples: the PNG that they save."""

from pathlib import Path
from typing import Any


class SavedPictures:
    """Moves what a program saved beside itself onto its page."""

    def __repr__(self) -> str:
        """The same in every build: the gallery tells settings apart by it."""
        return "SavedPictures"

    def __call__(self, block: Any, script: Any) -> str:
        """The Markdown of the pictures that are there now."""
        lines = []
        saved = sorted(Path.cwd().glob("*.png"))
        for picture, place in zip(saved, script.run_vars.image_path_iterator, strict=False):
            picture.replace(place)
            lines.append(f"![{picture.stem.replace('_', ' ')}](./images/{Path(place).name})")
        return "\n\n".join(lines)


conf = {"image_scrapers": (SavedPictures(),)}
