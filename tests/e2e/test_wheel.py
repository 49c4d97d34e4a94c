"""The wheel carries all it needs: presets, claims, types; its commands run away from a checkout."""

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "--target", "wheel"]
    done = subprocess.run(
        [*build, "--directory", str(folder)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    wheel = next(folder.glob("*.whl"))
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


def _run(site: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    code = (
        "import squeezefilm, sys; from squeezefilm.cli import main; "
        f"assert squeezefilm.__file__.startswith({str(site)!r}), squeezefilm.__file__; main()"
    )
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        capture_output=True,
        text=True,
        cwd=site.parent,
        env={**os.environ, "PYTHONPATH": str(site)},
        check=False,
    )


@pytest.mark.slow
def test_the_wheel_has_data_licence_and_types(unpacked: Path) -> None:
    files = {str(path.relative_to(unpacked)) for path in unpacked.rglob("*") if path.is_file()}
    assert {
        "squeezefilm/core/presets/claims.toml",
        "squeezefilm/core/presets/biet2008-plate.toml",
        "squeezefilm/core/presets/biet2008-stator.toml",
        "squeezefilm/py.typed",
        "squeezefilm/physics/render/static/renderer.js",
    } <= files
    assert any(name.endswith("licenses/LICENSE") for name in files)
    assert not any(name.startswith(("tests", "docs")) for name in files)


@pytest.mark.nightly
def test_its_commands_run(unpacked: Path) -> None:
    claims = json.loads(_run(unpacked, "reproduce", "--json").stdout)
    assert claims["changed"] == []
    found = _run(
        unpacked, "analyze", "biet2008-stator", "--json", "--samples", "0", "--model", "paper2008"
    )
    assert json.loads(found.stdout)["relative_friction"] == pytest.approx(0.702, abs=5e-4)


@pytest.mark.slow
def test_documents_are_written_in_a_checkout_only(unpacked: Path) -> None:
    done = _run(unpacked, "reproduce", "--write-docs")
    assert done.returncode == 2
    assert "checkout" in done.stderr
