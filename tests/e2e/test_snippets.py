"""Every Python snippet of the README and of the docs runs; those of one page share their names."""

import re
import textwrap
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
# Pages of docs/examples are made from programs by the build of the documentation.
WRITTEN = sorted(page for page in (ROOT / "docs").rglob("*.md") if "examples" not in page.parts)
PAGES = [ROOT / "README.md", *WRITTEN]
FENCED = re.compile(
    r"^(?P<heavy><!-- nightly -->\n)?```python\n(?P<code>.*?)^```", re.MULTILINE | re.DOTALL
)


def _snippets(page: Path) -> list[tuple[int, bool, str]]:
    """Line, whether it is heavy, and code of every fenced Python block of a page."""
    text = page.read_text(encoding="utf-8")
    return [
        (text[: found.start("code")].count("\n"), found["heavy"] is not None, found["code"])
        for found in FENCED.finditer(text)
    ]


WITH_SNIPPETS = [page for page in PAGES if _snippets(page)]
# Those that play in real time.
PLAYED = ("front-door.md", "psychopy.md", "twin.md")


def _run(page: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, *, heavy: bool) -> None:
    monkeypatch.chdir(folder)
    names: dict[str, Any] = {"__name__": "snippet"}
    for line, nightly, code in _snippets(page):
        if nightly and not heavy:
            continue
        # Blank lines before it, so that an error names the page's own line.
        exec(compile("\n" * line + code, page.name, "exec"), names)


@pytest.mark.parametrize("page", WITH_SNIPPETS, ids=lambda page: page.name)
def test_the_snippets_of_a_page_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _run(page, tmp_path, monkeypatch, heavy=False)


@pytest.mark.nightly
@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, id=page.name, marks=[pytest.mark.realtime] * (page.name in PLAYED))
        for page in WITH_SNIPPETS
        if any(heavy for _, heavy, _ in _snippets(page))
    ],
)
def test_the_heavy_snippets_run_too(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _run(page, tmp_path, monkeypatch, heavy=True)


def test_thirty_tasks_are_each_five_lines_at_most_with_one_import_of_ours() -> None:
    page = ROOT / "docs" / "how-to" / "front-door.md"
    codes = [code for _, _, code in _snippets(page)]
    assert len(codes) == 30
    for code in codes:
        assert len(code.strip().splitlines()) <= 5, textwrap.shorten(code, 80)
    ours = [line for code in codes for line in code.splitlines() if "import squeezefilm" in line]
    assert ours == ["import squeezefilm as sf"]
    assert not any("from squeezefilm" in code for code in codes)
