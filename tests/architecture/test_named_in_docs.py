"""Names of modules, functions and files that the documentation gives exist."""

import inspect
import pkgutil
import re
from pathlib import Path
from typing import Any

import pytest

import squeezefilm as sf

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src" / "squeezefilm"
START = ROOT / "docs" / "development" / "where-to-start.md"
ROOMS = {path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or path.is_dir()}
_CODE = re.compile(r"`([^`\n]+)`")
_DOTTED = re.compile(r"[a-z]\w*(\.\w+)+")
_SUFFIXES = (".py", ".toml", ".json", ".html", ".md", ".csv", ".js")


def _resolved(dotted: str) -> Any:
    """The module, class or function of a name below the package. Raises `AttributeError`."""
    return pkgutil.resolve_name(f"squeezefilm.{dotted}")


def _missing(page: Path) -> list[str]:
    missing = []
    for word in _CODE.findall(page.read_text(encoding="utf-8")):
        if _DOTTED.fullmatch(word) and word.split(".")[0] in ROOMS and not word.endswith(_SUFFIXES):
            try:
                _resolved(word)
            except AttributeError:
                missing.append(word)
    return missing


# Pages of docs/examples are made from programs by the build of the documentation.
WRITTEN = sorted(page for page in (ROOT / "docs").rglob("*.md") if "examples" not in page.parts)


def test_every_name_of_ours_in_a_page_exists() -> None:
    assert {page.name: _missing(page) for page in WRITTEN if _missing(page)} == {}


def test_a_name_that_does_not_exist_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "`physics.film.gap` `physics.film.gap.no_such` `physics.film.no_such.f` "
        "`physics.chain.touch.Touch.kept`"
    )
    assert _missing(page) == ["physics.film.gap.no_such", "physics.film.no_such.f"]


def test_every_path_of_where_to_start_exists() -> None:
    words = _CODE.findall(START.read_text(encoding="utf-8"))
    paths = [
        word for word in words if re.fullmatch(r"[\w./-]+(\.\w+|/)", word) and not _is_name(word)
    ]
    assert len(paths) > 30
    assert [
        path for path in paths if not any((top / path).exists() for top in (PACKAGE, ROOT))
    ] == []


def _is_name(word: str) -> bool:
    return "/" not in word and not word.endswith(_SUFFIXES)


@pytest.mark.parametrize("walk", ["Volts → friction", "Texture → samples"])
def test_each_stop_of_a_walk_is_called_by_one_before_it(walk: str) -> None:
    text = START.read_text(encoding="utf-8").split(f"## {walk}\n")[1].split("\n## ")[0]
    stops = re.findall(r"^\d+\. `([\w.]+)`", text, re.MULTILINE)
    assert len(stops) >= 12
    named = re.findall(r"`([a-z]\w*(?:\.\w+)+)`", text)
    for number, stop in enumerate(stops[1:], 1):
        before = named[: named.index(stop)] if stop in named else stops[:number]
        sources = [inspect.getsource(_module_of(name)) for name in before if name[0].islower()]
        assert any(re.search(rf"\b{stop.rpartition('.')[2]}\(", text) for text in sources), stop


def _module_of(dotted: str) -> Any:
    found = _resolved(dotted)
    return found if inspect.ismodule(found) else inspect.getmodule(found)


def test_the_page_lists_every_room_it_should() -> None:
    """Rooms are named by a stop or in the table, but for those that hold only types."""
    text = START.read_text(encoding="utf-8")
    silent = {"__init__", "__pycache__", "materials", "distributions", "progress", "results"}
    silent |= {"squeezefilm", "__main__"}
    unnamed = {room for room in ROOMS - silent if not re.search(rf"`{room}[./`]", text)}
    assert unnamed == set()


def test_the_library_page_has_every_name_of_the_front_door() -> None:
    page = (ROOT / "docs" / "reference" / "api.md").read_text(encoding="utf-8")
    shown = re.findall(r"^::: squeezefilm\.([\w.]+)$", page, re.MULTILINE)
    assert sorted(name.rsplit(".", 1)[1] for name in shown) == sf.__all__
    for name in shown:
        assert _resolved(name) is getattr(sf, name.rsplit(".", 1)[1])
