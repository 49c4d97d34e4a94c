"""The house's own rules: layers, docstrings, licences, and what is never committed."""

import ast
import importlib
import importlib.metadata
import inspect
import pkgutil
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.specifiers import SpecifierSet

import squeezefilm
from squeezefilm.core.quantities import CLOSED_FORMS

ROOT = Path(__file__).parents[2]


def _modules() -> list[str]:
    found = pkgutil.walk_packages(squeezefilm.__path__, "squeezefilm.")
    return sorted(module.name for module in found)


def test_layers_hold() -> None:
    program = Path(sys.executable).parent / "lint-imports"
    done = subprocess.run([program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert " 0 broken" in done.stdout


def _without_docstring(name: str) -> list[str]:
    """What is public in a module, itself included, and has no docstring."""
    module = importlib.import_module(name)
    missing = [] if module.__doc__ else [name]
    for key, item in vars(module).items():
        if key.startswith("_") or getattr(item, "__module__", None) != name:
            continue
        if inspect.isclass(item) or inspect.isfunction(item):
            if not inspect.getdoc(item):
                missing.append(f"{name}.{key}")
            if inspect.isclass(item):
                missing += [
                    f"{name}.{key}.{method}"
                    for method, body in vars(item).items()
                    if not method.startswith("_")
                    and (inspect.isfunction(body) or isinstance(body, property))
                    and not inspect.getdoc(body)
                ]
    return missing


def test_everything_public_has_a_docstring() -> None:
    modules = _modules()
    assert len(modules) > 500
    assert [name for module in modules for name in _without_docstring(module)] == []


def test_every_closed_form_documents_its_source_or_its_equation() -> None:
    for module in _modules():
        importlib.import_module(module)
    words = re.compile(r"eq|10\.\d{4}|source|Source|=|→|/")
    assert [key for key, f in CLOSED_FORMS.items() if not words.search(f.__doc__ or "")] == []


ALLOWED = re.compile(
    r"BSD|MIT|Apache|PSF|Python Software|MPL|Mozilla|ISC|HPND|Zlib|0BSD|CC0|Unlicense|"
    r"LLVM-exception|CNRI|Public Domain|matplotlib",
    re.IGNORECASE,
)
REFUSED = re.compile(r"\b[AL]?GPL|GNU (Lesser |Affero )?General Public", re.IGNORECASE)


def _licence(distribution: importlib.metadata.Distribution) -> str:
    meta = distribution.metadata
    classifiers = [c for c in meta.get_all("Classifier") or [] if c.startswith("License ::")]
    # Some packages put the whole text of several bundled licences here; its head says which.
    stated = (meta.get("License-Expression") or meta.get("License") or "")[:200]
    return " ".join([stated, *classifiers])


def _runtime_closure() -> set[str]:
    todo, seen = ["squeezefilm"], set()
    while todo:
        name = todo.pop()
        key = re.sub(r"[-_.]+", "-", name).lower()
        if key in seen:
            continue
        seen.add(key)
        try:
            requires = importlib.metadata.requires(name) or []
        except importlib.metadata.PackageNotFoundError:
            continue  # a requirement of another platform
        todo += [
            re.split(r"[\s<>=!~;\[(]", r, maxsplit=1)[0] for r in requires if "extra ==" not in r
        ]
    return seen - {"squeezefilm"}


def test_every_runtime_dependency_has_a_permissive_licence() -> None:
    closure = _runtime_closure()
    assert {"numpy", "scipy", "numba", "pydantic", "typer", "rich", "matplotlib"} <= closure
    bad = {}
    for name in closure:
        try:
            licence = _licence(importlib.metadata.distribution(name))
        except importlib.metadata.PackageNotFoundError:
            continue
        if REFUSED.search(licence) or not ALLOWED.search(licence):
            bad[name] = licence
    assert bad == {}


@pytest.mark.parametrize(
    ("name", "extra"),
    [("unicorn", "firmware-test"), ("psignifit", "oracles"), ("questplus", "oracles")],
)
def test_what_is_under_the_gpl_is_for_tests_alone(name: str, extra: str) -> None:
    # The emulator's package calls itself BSD, which its Python is; the engine within is GPL-2.
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    asking = [key for key, parts in extras.items() if any(name in part for part in parts)]
    assert asking == [extra]
    assert not any(name in part for part in project["dependencies"])
    for folder in ("src", "examples", "benchmarks"):
        for file in (ROOT / folder).rglob("*.py"):
            text = file.read_text("utf-8")
            assert not re.search(rf"import {name}|from {name}", text), file


def test_constraints_pin_and_hold_no_address() -> None:
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = [line for line in lines if line and not line.startswith("#")]
    assert all(re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.+!-]+", pin) for pin in pins)
    names = {re.sub(r"[-_.]+", "-", pin.split("==")[0]).lower() for pin in pins}
    # Asked for on other platforms, or by Pythons before ours, only.
    elsewhere = {"tzdata", "colorama", "exceptiongroup", "importlib-metadata", "tomli"}
    assert _runtime_closure() - names <= elsewhere


def test_pins_are_of_versions_that_every_python_from_3_11_0_on_takes() -> None:
    """A pin that asks for a later one leaves older ones without what they could install."""
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pinned = {re.sub(r"[-_.]+", "-", line.split("==")[0]).lower() for line in lines}
    later = [
        f"{found.name} {found.version}: {found.metadata.json.get('requires_python')}"
        for found in importlib.metadata.distributions()
        if re.sub(r"[-_.]+", "-", found.name).lower() in pinned
        and not SpecifierSet(str(found.metadata.json.get("requires_python", ""))).contains("3.11.0")
    ]
    assert not later


def test_messages_of_the_library_speak_of_arguments_not_of_options() -> None:
    """An error is read in a notebook and in the browser too, where there is no `--place`."""
    package = ROOT / "src" / "squeezefilm"
    speaking = []
    for file in sorted(package.rglob("*.py")):
        if file.is_relative_to(package / "cli"):
            continue
        text = file.read_text("utf-8")
        if not re.search("--[a-z]", text):
            continue
        for raised in ast.walk(ast.parse(text)):
            if isinstance(raised, ast.Raise):
                parts = [one.value for one in ast.walk(raised) if isinstance(one, ast.Constant)]
                options = [part for part in parts if re.search(r"(^|[ (`])--[a-z]", str(part))]
                speaking += [(str(file.relative_to(package)), part) for part in options]
    # What Dask's own program and a command line given whole are called is another matter.
    assert [one for one in speaking if not re.search("--nworkers|squeezefilm ", one[1])] == []
