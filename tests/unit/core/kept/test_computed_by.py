"""Whatever computes an answer is in the one hash: source, data, libraries."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import squeezefilm
from squeezefilm.core.kept import computed_by as module
from squeezefilm.core.kept.computed_by import computed_by, hash_of_source

PACKAGE = Path(squeezefilm.__file__).parent
NEVER = float("inf")

SOLVE = """
import squeezefilm
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.solid.working import solid_mode
glass = ElasticMaterial("glass", 72e9, 0.22, 2480)
ceramic = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)
patch = CeramicPatch(2e-3, 0, 20e-3, 14e-3, 0.5e-3)
plate = RectangularPlate(
    24e-3, 14e-3, 1.2e-3, 3, 60, glass, ceramic, (patch,), lines_across="length"
)
print(solid_mode(plate, (2, 0)).frequency)
"""


@pytest.fixture
def source(tmp_path: Path) -> Path:
    """A package of two files of code, one of data, and what Python made of them."""
    folder = tmp_path / "package"
    (folder / "presets" / "__pycache__").mkdir(parents=True)
    (folder / "materials.py").write_text("SHARE = 1.0\n")
    (folder / "presets" / "__init__.py").write_text("")
    (folder / "presets" / "glass.toml").write_text("young_modulus = 72e9\n")
    (folder / "presets" / "__pycache__" / "made.pyc").write_bytes(b"one")
    return folder


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: (folder / "materials.py").write_text("SHARE = 1.2\n"),
        lambda folder: (folder / "presets" / "glass.toml").write_text("young_modulus = 73e9\n"),
        lambda folder: (folder / "presets" / "more.toml").write_text(""),
        lambda folder: (folder / "materials.py").rename(folder / "presets" / "materials.py"),
        lambda folder: (folder / "materials.py").unlink(),
    ],
    ids=["code", "data", "new file", "moved file", "deleted file"],
)
def test_any_change_of_the_package_changes_the_hash(
    source: Path, change: Callable[[Path], object]
) -> None:
    before = hash_of_source(source, changed_before=NEVER)
    change(source)
    assert hash_of_source(source, changed_before=NEVER) != before


@pytest.mark.parametrize("library", ["numpy", "scipy", "numba"])
def test_another_version_of_a_library_changes_it(
    source: Path, library: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, versions = hash_of_source(source, changed_before=NEVER), module.version
    monkeypatch.setattr(
        module, "version", lambda name: "99.9" if name == library else versions(name)
    )
    assert hash_of_source(source, changed_before=NEVER) != before


def test_a_copy_elsewhere_has_the_same_and_what_python_made_does_not_count(
    source: Path, tmp_path: Path
) -> None:
    copy = Path(shutil.copytree(source, tmp_path / "installed"))
    (copy / "presets" / "__pycache__" / "made.pyc").write_bytes(b"two")
    hashes = {hash_of_source(place, changed_before=NEVER) for place in (source, copy)}
    assert len(hashes) == 1


def test_source_that_changed_under_a_running_process_is_not_what_computes(source: Path) -> None:
    os.utime(source / "materials.py", (2e9, 2e9))
    with pytest.raises(OSError, match=r"materials\.py changed while it was in use"):
        hash_of_source(source, changed_before=1e9)


def test_without_source_the_hash_is_of_this_process_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_SOURCE", tmp_path / "gone")
    own = [computed_by.__wrapped__() for _ in range(2)]
    assert own[0] != own[1]


@pytest.mark.slow
def test_another_young_modulus_in_the_source_is_another_answer(tmp_path: Path) -> None:
    """What failed: the plates that one version solved were returned by the next."""

    def frequency(source: Path, cache: str) -> float:
        environment = os.environ | {"PYTHONPATH": str(source), "SQUEEZEFILM_CACHE": cache}
        command = [sys.executable, "-c", SOLVE]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        return float(done.stdout)

    kept, copy = str(tmp_path / "kept"), tmp_path / "copy" / "squeezefilm"
    unchanged = frequency(PACKAGE.parent, kept)
    assert frequency(PACKAGE.parent, kept) == unchanged
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    materials = copy / "core" / "materials.py"
    text, begin = materials.read_text("utf-8"), "\n    s = np.zeros((6, 6))\n"
    assert text.count(begin) == 1
    stiffer = f"\n    young_modulus = 1.2 * young_modulus{begin}"
    materials.write_text(text.replace(begin, stiffer), "utf-8")
    changed = frequency(copy.parent, kept)
    assert changed == frequency(copy.parent, "off")
    assert changed > 1.02 * unchanged
