"""What the tutorial and the how-tos tell to type is typed, and what they tell to write is written.

Commands stand in blocks fenced as `sh`, files in blocks with a title, or taken from the examples
by `--8<--`. All of one page share a folder. Nothing is compared with what a page shows of the
output: that it works is checked here.
"""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted([*DOCS.glob("how-to/*.md"), *DOCS.glob("tutorial/*.md")])
BLOCK = re.compile(
    r'^```(?P<kind>sh|[a-z]+ title="(?P<file>[^"]+)")\n(?P<text>.*?)^```', re.MULTILINE | re.DOTALL
)


def _commands(text: str) -> list[list[str]]:
    """What a block tells to type, without remarks; a line ending in a backslash goes on."""
    lines = text.replace("\\\n", " ").splitlines()
    return [shlex.split(line, comments=True) for line in lines if line.strip()]


def _included(text: str) -> str:
    """A file that stands in the checkout once, and on the page by the name of it."""
    taken = re.fullmatch(r'--8<-- "([^"]+)"\n', text)
    return text if taken is None else (DOCS.parent / taken[1]).read_text(encoding="utf-8")


WITH_COMMANDS = [
    page
    for page in PAGES
    if any(found["kind"] == "sh" for found in BLOCK.finditer(page.read_text(encoding="utf-8")))
]


# Pages whose commands take more than a minute where the machine is slow.
LONG = (
    "design-a-plate",
    "how-many-participants",
    "sweep",
    "thickness-for-a-frequency",
    "threshold-on-your-plate",
)


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(
            page, id=page.stem, marks=pytest.mark.nightly if page.stem in LONG else pytest.mark.slow
        )
        for page in WITH_COMMANDS
    ],
)
def test_what_a_page_tells_to_type_works(page: Path, tmp_path: Path) -> None:
    for found in BLOCK.finditer(page.read_text(encoding="utf-8")):
        if found["file"]:
            (tmp_path / found["file"]).write_text(_included(found["text"]), encoding="utf-8")
            continue
        for name, *words in _commands(found["text"]):
            assert name == "squeezefilm", f"{page.name} tells to type {name}"
            command = [sys.executable, "-m", "squeezefilm", *words]
            ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
            assert ran.returncode == 0, (words, ran.stderr)
            assert "Traceback" not in ran.stderr


def test_remarks_and_lines_that_go_on_are_understood() -> None:
    assert _commands('squeezefilm show a.toml  # all\nsqueezefilm new \\\n  b --from "c d"\n') == [
        ["squeezefilm", "show", "a.toml"],
        ["squeezefilm", "new", "b", "--from", "c d"],
    ]
