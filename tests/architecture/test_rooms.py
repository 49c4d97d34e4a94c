"""Rooms that one person can own: small folders, no circles, no private doors, tested modules."""

import re
from collections import Counter
from pathlib import Path

import pytest

import import_graph

ROOT = Path(__file__).parents[2]
SOURCE, TESTS = ROOT / "src", ROOT / "tests"


@pytest.fixture(scope="module")
def graph() -> dict[str, frozenset[str]]:
    return import_graph.import_graph(SOURCE)


def test_no_folder_holds_more_than_twenty_modules() -> None:
    paths = import_graph.module_paths(SOURCE).values()
    sizes = Counter(path.parent for path in paths if path.name != "__init__.py")
    large = {str(folder.relative_to(SOURCE)): n for folder, n in sizes.items() if n > 20}
    assert large == {}


def test_no_module_reaches_itself_by_imports(graph: dict[str, frozenset[str]]) -> None:
    # The front door names every room and opens lazily; nobody inside may take more from it than
    # the version, so it closes no circle.
    within = {name: imports for name, imports in graph.items() if name != "squeezefilm"}
    assert import_graph.circles(within) == []


def test_the_drawing_of_the_parts_is_todays(graph: dict[str, frozenset[str]]) -> None:
    """Run `python tools/import_graph.py` and put what it prints into architecture.md."""
    text = (ROOT / "docs" / "development" / "architecture.md").read_text("utf-8")
    assert import_graph.parts_drawing(graph) in text


def test_each_part_has_a_page_that_says_what_it_imports(graph: dict[str, frozenset[str]]) -> None:
    for part, imports in import_graph.parts(graph).items():
        page = (SOURCE / "squeezefilm" / part / "README.md").read_text("utf-8")
        line = next(line for line in page.splitlines() if line.startswith("Imports: "))
        assert set(re.findall(r"`(\w+)`", line)) == imports, part
        assert f"make test PART={part}" in page
        assert len(page.splitlines()) < 40, part


def test_nobody_inside_comes_in_by_the_front_door() -> None:
    modules = import_graph.module_paths(SOURCE)
    taken = {}
    for name, path in modules.items():
        names = import_graph.imports_of(path).names
        through = {n for n in names if n.count(".") <= 1} - modules.keys()
        if name != "squeezefilm" and through - {"squeezefilm.__version__"}:
            taken[name] = through
    assert taken == {}


def test_nobody_imports_a_private_name_of_another_module() -> None:
    taken = {
        name: import_graph.imports_of(path).private
        for name, path in import_graph.module_paths(SOURCE).items()
    }
    assert {name: private for name, private in taken.items() if private} == {}


def test_private_names_are_seen_however_they_are_reached() -> None:
    source = """
from squeezefilm import __version__
from squeezefilm.core import presets
from squeezefilm.physics.film.gap import _hidden
import squeezefilm.physics.film.gas as slip
presets._resolved, slip._law, self._mine, presets.names
"""
    assert import_graph.read_imports(source).private == {
        "squeezefilm.physics.film.gap._hidden",
        "squeezefilm.core.presets._resolved",
        "squeezefilm.physics.film.gas._law",
    }


def test_every_module_has_a_test_named_after_it_or_one_that_names_it(
    graph: dict[str, frozenset[str]],
) -> None:
    tests = import_graph.test_files(TESTS)
    named: set[str] = set()
    for test in tests:
        named |= import_graph.modules_named_by(test, graph)
        named |= import_graph.modules_in_the_name_of(test, TESTS, graph)
    paths = import_graph.module_paths(SOURCE)
    lacking = {name for name in graph if paths[name].name != "__init__.py"} - named
    assert sorted(lacking) == [], "modules without a test: write one"
