"""Who imports whom, read from the source without running it: modules, tests, circles, distances.

Imports inside functions and under ``if TYPE_CHECKING`` count; relative imports are not used here.
"""

from __future__ import annotations

import ast
import atexit
import hashlib
import os
import pickle
import re
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

PACKAGE = "squeezefilm"
KEPT = Path(__file__).parents[1] / "out" / "imports.pickle"
"""The imports of every text read before, by its hash: to parse all files takes ten seconds."""
Graph = Mapping[str, frozenset[str]]
_DOTTED = re.compile(rf"{PACKAGE}(?:\.\w+)+")
_PRIVATE = re.compile(r"\b(\w+)\.(_[a-zA-Z]\w*)")


@dataclass(frozen=True)
class Imports:
    """What one file takes from our package, as dotted names: modules, or names in them."""

    names: frozenset[str]
    private: frozenset[str]  # underscored ones, imported or reached by way of an imported module

    def modules(self, known: Collection[str]) -> frozenset[str]:
        """The modules among `known` that are imported, or from which a name is imported."""
        owners = (name if name in known else name.rpartition(".")[0] for name in self.names)
        return frozenset(owner for owner in owners if owner in known)


@cache
def imports_of(path: Path) -> Imports:
    """The imports of a file, read once."""
    text = path.read_text(encoding="utf-8")
    known, key = _known(), hashlib.sha256(text.encode()).digest()
    if key not in known:
        found = read_imports(text)
        known[key] = found.names, found.private
    return Imports(*known[key])


@cache
def _known() -> dict[bytes, tuple[frozenset[str], frozenset[str]]]:
    """What is kept, by the hash of this file first; what is added is kept when the process ends."""
    ours = hashlib.sha256(Path(__file__).read_bytes()).digest()
    known: dict[bytes, tuple[frozenset[str], frozenset[str]]] = {}
    try:
        of, kept = pickle.loads(KEPT.read_bytes())
        known = kept if of == ours else known
    except (OSError, EOFError, pickle.UnpicklingError, ValueError):
        pass
    before = len(known)

    def keep() -> None:
        if len(known) > before:
            KEPT.parent.mkdir(exist_ok=True)
            written = KEPT.with_suffix(f".{os.getpid()}")
            written.write_bytes(pickle.dumps((ours, known)))
            written.replace(KEPT)

    atexit.register(keep)
    return known


def read_imports(source: str) -> Imports:
    """The imports of a module's source text."""
    names: set[str] = set()
    bound: dict[str, str] = {}
    for node in _statements(ast.parse(source).body):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
            bound |= {alias.asname: alias.name for alias in node.names if alias.asname}
        elif isinstance(node, ast.ImportFrom):
            full = {item.asname or item.name: f"{node.module}.{item.name}" for item in node.names}
            names |= set(full.values())
            bound |= full
    names = {name for name in names if name.split(".")[0] == PACKAGE}
    reached = {f"{bound.get(owner)}.{name}" for owner, name in _PRIVATE.findall(source)}
    private = {name for name in names | reached if _is_private(name)}
    return Imports(frozenset(names), frozenset(private))


def _statements(body: Iterable[ast.AST]) -> Iterator[ast.AST]:
    """Statements and those inside them; expressions, which are most of a tree, hold none."""
    for node in body:
        yield node
        for field in ("body", "orelse", "finalbody", "handlers", "cases"):
            yield from _statements(getattr(node, field, ()))


def _is_private(name: str) -> bool:
    first, *parts = name.split(".")
    return first == PACKAGE and any(part[0] == "_" and part[:2] != "__" for part in parts)


def module_paths(source: Path) -> dict[str, Path]:
    """The dotted name of every module below `source` (the folder that holds the package)."""
    found = {}
    for path in sorted((source / PACKAGE).rglob("*.py")):
        parts = path.relative_to(source).with_suffix("").parts
        found[".".join(parts).removesuffix(".__init__")] = path
    return found


def import_graph(source: Path) -> dict[str, frozenset[str]]:
    """For every module below `source`, the modules that it imports by name."""
    paths = module_paths(source)
    return {name: imports_of(path).modules(paths) - {name} for name, path in paths.items()}


def distances(start: Iterable[str], graph: Graph) -> dict[str, int]:
    """How many imports lie between `start` (at 0) and each module that can be reached from it."""
    found = dict.fromkeys(start, 0)
    todo = deque(found)
    while todo:
        name = todo.popleft()
        for following in sorted(graph.get(name, frozenset())):
            if following not in found:
                found[following] = found[name] + 1
                todo.append(following)
    return found


def circles(graph: Graph) -> list[frozenset[str]]:
    """Groups of modules each of which reaches every other by imports."""
    left = dict(graph)
    while ends := [name for name, imports in left.items() if not imports & left.keys()]:
        for name in ends:
            del left[name]
    reached = {name: set(distances(left[name], left)) for name in left}
    groups = {
        frozenset(o for o in reached[name] if name in reached.get(o, ()))
        for name in left
        if name in reached[name]
    }
    return sorted(groups, key=sorted)


def parts(graph: Graph) -> dict[str, frozenset[str]]:
    """For every part, which is a folder of the package, the other parts that its modules import."""
    within = {name.split(".")[1] for name in graph if name.count(".") > 1}
    folders = {name: name.split(".")[1] for name in graph if name.partition(".")[2]}
    folders = {name: part for name, part in folders.items() if part in within}
    found: dict[str, frozenset[str]] = {}
    for name, part in folders.items():
        taken = {folders[other] for other in graph[name] if other in folders}
        found[part] = found.get(part, frozenset()) | (taken - {part})
    return found


def parts_drawing(graph: Graph) -> str:
    """The parts and what each imports, one a line, the highest first."""
    found = parts(graph)
    order = sorted(found, key=lambda part: (-len(distances([part], found)), part))
    lines = (
        f"    {part:<12} → {' '.join(other for other in order if other in found[part])}".rstrip()
        for part in order
    )
    return "\n".join(line.removesuffix(" →") for line in lines)


def test_files(tests: Path) -> list[Path]:
    """Every file of tests below a folder, sorted."""
    return sorted(tests.rglob("test_*.py"))


def modules_in_the_name_of(test: Path, tests: Path, modules: Iterable[str]) -> frozenset[str]:
    """The module that a file of tests is named after, if there is one.

    ``test_name.py`` below ``tests/<kind>/`` belongs to the module ``name`` of the same folders, or
    to the only one of that name.
    """
    name = test.stem.removeprefix("test_")
    namesakes = [module for module in modules if module.rpartition(".")[2] == name]
    mirrored = ".".join([PACKAGE, *test.relative_to(tests).parts[1:-1], name])
    if mirrored in namesakes:
        return frozenset([mirrored])
    return frozenset(namesakes if len(namesakes) == 1 else [])


def modules_named_by(test: Path, modules: Collection[str]) -> frozenset[str]:
    """The modules that a test's file imports, or whose dotted name stands in it as text."""
    texts = _DOTTED.findall(test.read_text(encoding="utf-8"))
    return imports_of(test).modules(modules) | (frozenset(texts) & frozenset(modules))


if __name__ == "__main__":
    print(parts_drawing(import_graph(Path(__file__).parents[1] / "src")))
