"""Mutants: small faults put into the source one at a time, to see whether a test notices.

A mutant replaces one span of the text and keeps every line where it is, so that tracebacks, line
numbers and the caches of compiled code stay comparable.
"""

from __future__ import annotations

import ast
import hashlib
import random
import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from mutation_sites import KINDS, Site, sites


@dataclass(frozen=True)
class Mutant:
    """One small fault in one source file, and what stood `before` in its place."""

    id: str  # the same as long as the line and its function keep their text
    path: str  # below the folder of sources
    line: int
    before: str
    site: Site

    @property
    def room(self) -> str:
        """The room, or the module of its own, in which the mutant lies."""
        return self.path.split("/")[1].removesuffix(".py")

    @property
    def module(self) -> str:
        """The dotted name of the mutated module."""
        return self.path.removesuffix(".py").replace("/", ".").removesuffix(".__init__")

    def applied(self, source: bytes) -> bytes:
        """The mutated source, with as many lines as before."""
        lost = self.before.count("\n") - self.site.after.count("\n")
        after = self.site.after.encode() + b"\n" * lost
        return source[: self.site.start] + after + source[self.site.end :]

    def is_valid(self, source: bytes) -> bool:
        """Whether the mutated source parses, and says something else."""
        try:
            mutated = ast.parse(self.applied(source))
        except SyntaxError:
            return False
        return ast.dump(mutated) != ast.dump(ast.parse(source))


def mutants_of(source: bytes, path: str, quantities: Iterable[str] = ()) -> list[Mutant]:
    """Every mutant of one module. `quantities` are names of types that are floats."""
    lines = source.decode().split("\n")
    seen: Counter[str] = Counter()
    found = []
    for site in sites(source, quantities, not {"report", "kit"}.isdisjoint(path.split("/"))):
        before = source[site.start : site.end].decode()
        line = source.count(b"\n", 0, site.start) + 1
        # Nothing that an edit elsewhere in the file would change.
        key = "\0".join(
            [path, site.function, site.kind, lines[line - 1].strip(), before, site.after]
        )
        seen[key] += 1
        name = hashlib.sha1(f"{key}\0{seen[key]}".encode()).hexdigest()[:10]
        found.append(Mutant(name, path, line, before, site))
    return found


def quantity_names(source: bytes) -> list[str]:
    """The names that a module gives to floats with a unit: ``Metre = Annotated[float, …]``."""
    return re.findall(r"^(\w+)(?:: TypeAlias)? = Annotated\[float", source.decode(), re.MULTILINE)


def sample(mutants: Iterable[Mutant], seed: int) -> Iterator[Mutant]:
    """All mutants in a random order that depends on the seed, the kinds taking turns.

    A longer sample of the same seed and tree begins with the shorter one.
    """
    kinds: dict[str, list[Mutant]] = defaultdict(list)
    for mutant in sorted(mutants, key=lambda mutant: mutant.id):
        kinds[mutant.site.kind].append(mutant)
    for kind, members in kinds.items():
        random.Random(f"{seed} {kind}").shuffle(members)
    while any(kinds.values()):
        for kind in KINDS:
            if kinds[kind]:
                yield kinds[kind].pop()


def all_mutants(source: Path, rooms: Iterable[str] = ()) -> list[Mutant]:
    """Every mutant of the package below a folder of sources, of all rooms or of those named."""
    quantities = quantity_names(
        (source / "squeezefilm" / "core" / "quantities" / "units.py").read_bytes()
    )
    wanted = set(rooms)
    found: list[Mutant] = []
    for path in sorted((source / "squeezefilm").rglob("*.py")):
        name = path.relative_to(source).as_posix()
        if not wanted or name.split("/")[1].removesuffix(".py") in wanted:
            found += mutants_of(path.read_bytes(), name, quantities)
    return found
