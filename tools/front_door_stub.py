"""Write `squeezefilm/__init__.pyi`: the front door for type checkers, who do not run `reads_text`.

    python tools/front_door_stub.py

Where a parameter may be text ("2 mm", a display's name), its type says so; all else is as its
module says. A test compares.
"""

from __future__ import annotations

import ast
import builtins
import importlib
import inspect
import subprocess
import sys
import typing
from collections import defaultdict
from pathlib import Path
from typing import Annotated, Any

import squeezefilm
from squeezefilm.core.arguments import ReadBy
from squeezefilm.core.quantities import unit_of

HEAD = '''"""The front door for type checkers; `tools/front_door_stub.py` writes it."""

from typing import TYPE_CHECKING

# Every module depends on this one: so marked, a checker reads it last and meets no circle.
if TYPE_CHECKING:
'''


def text_of(hint: Any) -> str:
    """What may stand in place of a value of this type, as an annotation; "" for nothing."""
    if typing.get_origin(hint) is Annotated:
        if unit_of(hint) is not None:
            return "str"
        if any(isinstance(mark, ReadBy) for mark in hint.__metadata__):
            return "str | Path"
        return text_of(hint.__origin__)
    parts = typing.get_args(hint)
    if typing.get_origin(hint) is tuple and parts and all(unit_of(part) for part in parts):
        return f"tuple[{', '.join(['str'] * len(parts))}]"
    return next((text for text in map(text_of, parts) if text), "")


def imported_from(module: Any, name: str) -> str:
    """The module from which another one has a name: itself, or as its source says."""
    for node in ast.walk(ast.parse(inspect.getsource(module))):
        if isinstance(node, ast.ImportFrom) and name in {alias.name for alias in node.names}:
            assert node.module is not None
            return node.module
    return str(module.__name__)


def home_of(subject: Any, parameter: str, module: Any) -> Any:
    """The module in whose names a parameter's annotation is: that of the record that declares it,
    where the subject is called with the fields of one."""
    for record in getattr(getattr(subject, "record", None), "__mro__", ()):
        if parameter in vars(record).get("__annotations__", {}):
            return sys.modules[record.__module__]
    return module


class _WithoutMarks(ast.NodeTransformer):
    """A type's bounds are not for those who check types."""

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        if isinstance(node.value, ast.Name) and node.value.id == "Annotated":
            assert isinstance(node.slice, ast.Tuple)
            return self.generic_visit(node.slice.elts[0])
        return self.generic_visit(node)


class _WithoutModules(ast.NodeTransformer):
    """What is named through its module (``si.Metre``) is imported from it (``Metre``)."""

    def __init__(self, module: Any, imports: dict[str, set[str]]) -> None:
        self._module, self._imports = module, imports

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        assert isinstance(node.value, ast.Name)
        self._imports[vars(self._module)[node.value.id].__name__].add(node.attr)
        return ast.Name(node.attr, node.ctx)


class Stub:
    """The stub's text as it grows: what is imported, and what is written out."""

    def __init__(self) -> None:
        self.imports: dict[str, set[str]] = defaultdict(set)
        self.bodies: list[str] = []

    def add(self, name: str, place: str) -> None:
        """Write a name out where text may stand in it, and import it as it is elsewhere."""
        module = importlib.import_module(place)
        subject = getattr(module, name)
        parameters = self._parameters(subject, module)
        if not any(text for _, text in parameters.values()):
            self.imports[place].add(f"{name} as {name}")
            return
        said = []
        for key, (parameter, text) in parameters.items():
            if parameter.kind is parameter.KEYWORD_ONLY and "*" not in said:
                said.append("*")
            plain = self._plain(parameter.annotation, home_of(subject, key, module))
            first, none, _ = plain.partition(" | None")
            widened = f"{first} | {text}{none}" if text else plain
            given = "" if parameter.default is parameter.empty else " = ..."
            said.append(f"{key}: {widened}{given}")
        summary = f'    """{str(inspect.getdoc(subject)).splitlines()[0]}"""'
        if inspect.isclass(subject):
            self.imports[place].add(f"{name} as _{name}")
            self.bodies.append(f"class {name}(_{name}):")
            self.bodies.append(summary)
            self.bodies.append(f"    def __init__(self, {', '.join(said)}) -> None: ...")
        else:
            back = self._plain(subject.__annotations__["return"], module)
            self.bodies.append(f"def {name}({', '.join(said)}) -> {back}:")
            self.bodies.append(summary)

    def _parameters(self, subject: Any, module: Any) -> dict[str, tuple[inspect.Parameter, str]]:
        called = subject.__init__ if inspect.isclass(subject) else subject
        if not hasattr(called, "__wrapped__"):
            return {}  # it reads no text
        hints = typing.get_type_hints(getattr(subject, "record", subject), include_extras=True)
        given = inspect.signature(subject).parameters
        return {name: (given[name], text_of(hints.get(name))) for name in given}

    def _plain(self, annotation: Any, module: Any) -> str:
        """The annotation without its marks; what it names is imported."""
        if not isinstance(annotation, str):
            # The kind of a part of a texture, which its decorator adds.
            self.imports["typing"].add("Literal")
            return inspect.formatannotation(annotation)
        tree = _WithoutMarks().visit(ast.parse(annotation, mode="eval"))
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and not (
                hasattr(builtins, node.id) or inspect.ismodule(vars(module).get(node.id))
            ):
                self.imports[imported_from(module, node.id)].add(node.id)
        return ast.unparse(_WithoutModules(module, self.imports).visit(tree))

    def text(self) -> str:
        """The whole stub."""
        self.imports["pathlib"].add("Path")
        for names in self.imports.values():
            names -= {name for name in names if f"{name} as {name}" in names}
        lines = [
            f"    from {place} import {', '.join(sorted(names))}"
            for place, names in sorted(self.imports.items())
        ]
        bodies = [f"    {line}" for line in self.bodies]
        return "\n".join([HEAD.rstrip(), *lines, *bodies, "__version__: str", ""])


def stub() -> str:
    """The text of the stub; its order and layout are the linter's, as `main` leaves them."""
    made = Stub()
    # What the stub does not say, and this is written from.
    for name, place in vars(squeezefilm)["_NAMES"].items():
        made.add(name, f"squeezefilm.{place}")
    return made.text()


def main() -> None:
    """Write the stub, its imports sorted and its lines laid out as all code here is."""
    assert squeezefilm.__file__ is not None
    path = Path(squeezefilm.__file__).with_suffix(".pyi")
    path.write_text(stub(), encoding="utf-8")
    # Sorted first: the layout of unsorted imports would stay.
    for command in (["check", "--fix", "--quiet"], ["format", "--quiet"]):
        subprocess.run([sys.executable, "-m", "ruff", *command, str(path)], check=True)


if __name__ == "__main__":
    main()
