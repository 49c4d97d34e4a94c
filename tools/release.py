"""Build what is released, look at it, and use it as a stranger would.

    python tools/release.py dist

Makes sdist and wheel (the wheel from the sdist, so that nothing is missing there), compares their
metadata and files with the tree, installs the wheel into a clean virtual environment without our
constraints, and there runs ``squeezefilm --version``, ``squeezefilm presets`` and the README's
snippet. Nothing is uploaded.
"""

from __future__ import annotations

import argparse
import email
import os
import re
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import venv
import zipfile
from collections.abc import Sequence
from email.message import Message
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = "squeezefilm"


def version_of(source: str) -> str:
    """The version that a module's text states. Raises `ValueError` if it states none or several."""
    found = re.findall(r'^__version__ = "([^"]+)"$', source, re.MULTILINE)
    if len(found) != 1:
        raise ValueError(f"the version is stated {len(found)} times, not once")
    return str(found[0])


def changelog_complaints(changelog: str, version: str) -> list[str]:
    """What is wrong with a changelog for a version: a final one has a dated section."""
    heads = re.findall(r"^## (.+)$", changelog, re.MULTILINE)
    complaints = [] if heads[:1] == ["Unreleased"] else ["the first section is not 'Unreleased'"]
    dated = re.compile(rf"{re.escape(version)} \(\d{{4}}-\d\d-\d\d\)")
    if "dev" not in version and not any(map(dated.fullmatch, heads)):
        complaints.append(f"no section '## {version} (year-month-day)'")
    return complaints


def metadata_complaints(metadata: Message, project: dict[str, object], version: str) -> list[str]:
    """Where a distribution's metadata differ from ``pyproject.toml`` or say too little."""
    wanted = {
        "Name": project["name"],
        "Version": version,
        "Summary": project["description"],
        "License-Expression": project["license"],
        "Requires-Python": project["requires-python"],
        "Description-Content-Type": "text/markdown",
    }
    complaints = [
        f"{key} is {metadata[key]!r}, not {value!r}"
        for key, value in wanted.items()
        if metadata[key] != value
    ]
    if not str(metadata.get_payload()).startswith(f"# {PACKAGE}"):
        complaints.append("the description is not the README")
    return complaints


def _run(command: Sequence[str | Path], folder: Path, **environment: str) -> str:
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        sys.exit(f"failed: {' '.join(map(str, command))}\n{done.stdout}")
    return done.stdout


def build(out: Path, version: str) -> tuple[Path, Path]:
    """The sdist and the wheel, made anew in a folder."""
    out.mkdir(parents=True, exist_ok=True)
    _run([sys.executable, "-m", "build", "--no-isolation", "--outdir", out.resolve()], ROOT)
    return (
        out / f"{PACKAGE}-{version}.tar.gz",
        out / f"{PACKAGE}-{version}-py3-none-any.whl",
    )


def complaints_about(sdist: Path, wheel: Path, version: str) -> list[str]:
    """What is wrong with what was built: metadata, and files that are missing or too many."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    complaints = changelog_complaints(changelog, version)
    tracked = set(_run(["git", "ls-files", "src", "tests"], ROOT).split())
    with tarfile.open(sdist) as archive:
        top = f"{PACKAGE}-{version}/"
        held = {name.removeprefix(top) for name in archive.getnames()}
        stated = archive.extractfile(f"{top}PKG-INFO")
        assert stated is not None
        about = email.message_from_bytes(stated.read())
    complaints += [f"sdist: {text}" for text in metadata_complaints(about, project, version)]
    complaints += [f"sdist: {name} is missing" for name in sorted(tracked - held)]
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        folder = f"{PACKAGE}-{version}.dist-info/"
        about = email.message_from_bytes(archive.read(f"{folder}METADATA"))
    complaints += [f"wheel: {text}" for text in metadata_complaints(about, project, version)]
    wanted = {name.removeprefix("src/") for name in tracked if name.startswith("src/")}
    complaints += [f"wheel: {name} is missing" for name in sorted(wanted - names)]
    held = {name for name in names if not name.startswith(folder)}
    complaints += [f"wheel: {name} does not belong there" for name in sorted(held - wanted)]
    if f"{folder}licenses/LICENSE" not in names:
        complaints.append("wheel: the licence is missing")
    return complaints


def try_out(wheel: Path, version: str) -> None:
    """Install a wheel into a clean environment, without constraints, and use it away from here."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    snippet = re.search(r"^```python\n(.*?)^```", readme, re.MULTILINE | re.DOTALL)
    assert snippet is not None
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        venv.create(folder / "clean", with_pip=True)
        programs = folder / "clean" / ("Scripts" if os.name == "nt" else "bin")
        python = programs / "python"
        quiet = ["--quiet", "--disable-pip-version-check"]
        # Nothing of ours may be found by another way than by the wheel.
        alone = {"PYTHONPATH": "", "PIP_CONSTRAINT": ""}
        _run([python, "-m", "pip", "install", *quiet, wheel.resolve()], folder, **alone)
        said = _run([programs / PACKAGE, "--version"], folder, **alone).strip()
        if said != version:
            sys.exit(f"the installed version says {said!r}, not {version!r}")
        presets = _run([programs / PACKAGE, "presets"], folder, **alone)
        if "biet2008-plate" not in presets:
            sys.exit(f"the presets are not there:\n{presets}")
        print(_run([python, "-W", "error", "-c", snippet[1]], folder, **alone), end="")


def main() -> None:
    """Build, look, try; say what was made."""
    parser = argparse.ArgumentParser(description="Build and try what is released.")
    parser.add_argument("out", type=Path, help="folder for sdist and wheel")
    out = parser.parse_args().out
    version = version_of((ROOT / "src" / PACKAGE / "__init__.py").read_text(encoding="utf-8"))
    sdist, wheel = build(out, version)
    complaints = complaints_about(sdist, wheel, version)
    if complaints:
        sys.exit("\n".join(complaints))
    print(f"{sdist} and {wheel} are complete; now in a clean environment:")
    try_out(wheel, version)
    print(f"{PACKAGE} {version} can be released")


if __name__ == "__main__":
    main()
