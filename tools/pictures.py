"""Draw the three pictures of the README into docs/pictures: the active area, a texture, the lab.

`make pictures` runs it. It needs a Chromium. Few colours keep the files small.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

import squeezefilm as sf

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
PLATE = ROOT / "examples" / "own_plate.toml"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SOLVED = 300_000


def figures() -> None:
    """What the report and the rendering of the tutorial's plate show."""
    sf.plot(sf.analyze(PLATE)).savefig(PICTURES / "plate.png", dpi=90)
    rendered = sf.render_texture(PLATE, "sine-3mm", "60 mm/s over 4 cm")
    sf.plot(rendered).savefig(PICTURES / "texture.png", dpi=90)


def lab() -> None:
    """The lab's first page, once it has solved the plate that it opens with."""
    browser = next(filter(None, map(shutil.which, BROWSERS)))
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        command = [sys.executable, "-m", "squeezefilm", "lab", "--no-browser", "--folder", folder]
        started = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            assert started.stdout is not None
            link = next(filter(None, (re.search(r"http://\S+", line) for line in started.stdout)))
            chromium = playwright.chromium.launch(executable_path=browser, args=["--no-sandbox"])
            page = chromium.new_page(viewport={"width": 1280, "height": 900})
            page.goto(link[0])
            page.get_by_role("button", name="No tour").click()
            page.locator(".quality").filter(has_text="solved:").wait_for(timeout=SOLVED)
            page.screenshot(path=PICTURES / "lab.png")
            chromium.close()
        finally:
            started.terminate()
            started.wait()


def main() -> None:
    """Draw all three anew."""
    PICTURES.mkdir(exist_ok=True)
    figures()
    lab()
    for picture in PICTURES.glob("*.png"):
        Image.open(picture).convert("RGB").quantize(64).save(picture, optimize=True)


if __name__ == "__main__":
    main()
