"""What the tutorial and the how-tos tell to type is typed, and what they tell to write is written.

Commands stand in blocks fenced as `sh`, files in blocks with a title, or taken from the examples
by `--8<--`. All of one part share a folder. Nothing is compared with what a page shows of the
output: that it works is checked here. Samples, points, designs and people are few.
"""

import re
import shlex
from pathlib import Path

import pytest

from .pages import ROOT, Part, parts
from .program import run

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
    return text if taken is None else (ROOT / taken[1]).read_text(encoding="utf-8")


WITH_COMMANDS = [
    part
    for part in parts()
    if part.page.parent.name in ("how-to", "tutorial")
    and any(block["kind"] == "sh" for block in BLOCK.finditer(part.text))
]


# Parts whose commands take more than a minute where the machine is slow: at night.
LONG = (
    "design-a-plate",
    "glue-tolerance",
    "have-it-built",
    "how-many-participants",
    "sweep-a-value",
    "thickness-for-a-frequency",
    "threshold-on-your-plate",
    "your-own-plate",
)
FEW = {
    "analyze": ("--samples", "8"),
    "friction": ("--samples", "8"),
    "sweep": ("--jobs", "1"),
}
"""What is added to a verb where the page does not say it."""
COUNTS = {"--participants": "3", "--screened": "40", "--solved": "3", "--sample": "6"}
"""What stands after an option instead of the page's own number."""


def _small(words: list[str]) -> list[str]:
    """The same command with few samples, points or people, in one process."""
    option, count = FEW.get(words[0], ("", ""))
    added = [option, count] if option and option not in words else []
    few = [
        COUNTS.get(before, re.sub(r":\d+$", ":2", word))
        for before, word in zip(["", *words], words, strict=False)
    ]
    return [*few, *added]


@pytest.mark.parametrize(
    "part",
    [
        pytest.param(
            part, id=part.name, marks=pytest.mark.nightly if part.name in LONG else pytest.mark.slow
        )
        for part in WITH_COMMANDS
    ],
)
def test_what_a_page_tells_to_type_works(part: Part, tmp_path: Path) -> None:
    for block in BLOCK.finditer(part.text):
        if block["file"]:
            (tmp_path / block["file"]).write_text(_included(block["text"]), encoding="utf-8")
            continue
        for name, *words in _commands(block["text"]):
            assert name == "squeezefilm", f"{part.page.name} tells to type {name}"
            ran = run(*_small(words), cwd=tmp_path)
            assert ran.returncode == 0, (words, ran.stderr)
            assert "Traceback" not in ran.stderr


def test_a_command_is_typed_with_few_samples_designs_and_people() -> None:
    assert _small(shlex.split("analyze a --out b")) == shlex.split("analyze a --out b --samples 8")
    assert _small(shlex.split("analyze a --samples 0")) == shlex.split("analyze a --samples 0")
    typed = "study simulate a --participants 12 --seed 7"
    assert _small(shlex.split(typed)) == shlex.split(typed.replace("12", "3"))
    searched = "design a --screened {} --solved {}"
    assert _small(shlex.split(searched.format(200, 12))) == shlex.split(searched.format(40, 3))
    swept = "sweep a --vary 'voltage=1 V..2 V:{}' --jobs 1"
    assert _small(shlex.split(swept.format(5))) == shlex.split(swept.format(2))


def test_remarks_and_lines_that_go_on_are_understood() -> None:
    assert _commands('squeezefilm show a.toml  # all\nsqueezefilm new \\\n  b --from "c d"\n') == [
        ["squeezefilm", "show", "a.toml"],
        ["squeezefilm", "new", "b", "--from", "c d"],
    ]
