"""Print the files of tests of one part of the package, for `make test PART=film`.

    python tools/part_tests.py film

A part is a folder or a module below ``src/squeezefilm``, by its name (`film`) or its path
(`physics/film/planar`); of several with that name those that are outermost. Its tests lie in the
folder of the same path below ``tests/unit``, are named after one of its modules, or stand beside
``tests/unit`` and import nothing else of the package.
"""

from __future__ import annotations

import sys
from pathlib import Path

import import_graph

ROOT = Path(__file__).parents[1]
_EVERYWHERE = ("squeezefilm.core.quantities", "squeezefilm.core.errors")


def part_paths(part: str, package: Path) -> list[Path]:
    """The folders or modules of a part, from the package on. Raises `ValueError` without one."""
    parts = [path for path in package.rglob("*") if path.suffix == ".py" or path.is_dir()]
    paths = [path.relative_to(package).with_suffix("") for path in parts]
    wanted = Path(part).parts
    named = [path for path in paths if path.parts[-len(wanted) :] == wanted]
    if not wanted or not named:
        rooms = sorted(str(path) for path in paths if len(path.parts) == 1 and str(path)[0] != "_")
        raise ValueError(f"src/squeezefilm holds no '{part}'; it has {', '.join(rooms)}")
    outermost = min(len(path.parts) for path in named)
    return sorted(path for path in named if len(path.parts) == outermost)


def tests_of(part: str, root: Path) -> list[str]:
    """The paths of a part's files of tests, from the root on, sorted."""
    source, tests = root / "src", root / "tests"
    paths = part_paths(part, source / import_graph.PACKAGE)
    graph = import_graph.import_graph(source)
    names = tuple(".".join([import_graph.PACKAGE, *path.parts, ""]) for path in paths)
    modules = {module for module in graph if f"{module}.".startswith(names)}

    def belongs(test: Path) -> bool:
        if any(tests / "unit" / path in test.parents for path in paths):
            return True
        if import_graph.modules_in_the_name_of(test, tests, graph) & modules:
            return True
        if test.relative_to(tests).parts[0] in ("unit", "architecture"):
            return False
        named = import_graph.modules_named_by(test, graph)
        own = {module for module in named if not module.startswith(_EVERYWHERE)}
        return bool(own) and own <= modules

    files = filter(belongs, import_graph.test_files(tests))
    return [file.relative_to(root).as_posix() for file in files]


if __name__ == "__main__":
    try:
        print("\n".join(tests_of(sys.argv[1], ROOT)))
    except ValueError as error:
        sys.exit(str(error))
