"""Every Python snippet of the README and of the docs runs; those of one part share their names."""

import re
import textwrap
from pathlib import Path
from typing import Any

import pytest

from .pages import Part, parts

FENCED = re.compile(
    r"^(?P<heavy><!-- nightly -->\n)?```python\n(?P<code>.*?)^```", re.MULTILINE | re.DOTALL
)


def _snippets(part: Part) -> list[tuple[int, bool, str]]:
    """Line in the page, whether it is heavy, and code of every fenced Python block of a part."""
    return [
        (
            part.line + part.text[: block.start("code")].count("\n"),
            block["heavy"] is not None,
            block["code"],
        )
        for block in FENCED.finditer(part.text)
    ]


WITH_SNIPPETS = [part for part in parts() if _snippets(part)]
LONG = ("front-door", "actuators", "a-bench-at-home")
# Those that play in real time.
PLAYED = ("front-door", "psychopy", "twin")


def _run(part: Part, folder: Path, monkeypatch: pytest.MonkeyPatch, *, heavy: bool) -> None:
    monkeypatch.chdir(folder)
    names: dict[str, Any] = {"__name__": "snippet"}
    for line, nightly, code in _snippets(part):
        if nightly and not heavy:
            continue
        # Blank lines before it, so that an error names the page's own line.
        exec(compile("\n" * line + code, part.page.name, "exec"), names)


@pytest.mark.parametrize(
    "part",
    [
        pytest.param(part, id=part.name, marks=[pytest.mark.slow] * (part.name in LONG))
        for part in WITH_SNIPPETS
    ],
)
def test_the_snippets_of_a_part_run(
    part: Part, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _run(part, tmp_path, monkeypatch, heavy=False)


@pytest.mark.nightly
@pytest.mark.parametrize(
    "part",
    [
        pytest.param(part, id=part.name, marks=[pytest.mark.realtime] * (part.name in PLAYED))
        for part in WITH_SNIPPETS
        if any(heavy for _, heavy, _ in _snippets(part))
    ],
)
def test_the_heavy_snippets_run_too(
    part: Part, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _run(part, tmp_path, monkeypatch, heavy=True)


def test_thirty_tasks_are_each_five_lines_at_most_with_one_import_of_ours() -> None:
    (tasks,) = (part for part in parts() if part.name == "front-door")
    codes = [code for _, _, code in _snippets(tasks)]
    assert len(codes) == 30
    for code in codes:
        assert len(code.strip().splitlines()) <= 5, textwrap.shorten(code, 80)
    ours = [line for code in codes for line in code.splitlines() if "import squeezefilm" in line]
    assert ours == ["import squeezefilm as sf"]
    assert not any("from squeezefilm" in code for code in codes)
