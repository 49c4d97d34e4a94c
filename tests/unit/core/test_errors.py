"""What only an extra installs: asked for without it, the extra is named; the rest does without."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.unit.design.search.made_up import requirements

from squeezefilm.core.errors import MissingPackageError, optional
from squeezefilm.core.formats.drawing import Drawing, dxf_text
from squeezefilm.core.formats.traces import Table, parquet_bytes
from squeezefilm.design.search.evolution import Proposals
from squeezefilm.design.sweep.workers import workers
from squeezefilm.instruments.bench.markers import Markers
from squeezefilm.instruments.device.wire.streams import SerialStream
from squeezefilm.lab.lan import certificate

EXTRAS = {
    "cluster": ("distributed",),
    "design": ("ezdxf", "meshio", "optuna"),
    "device": ("serial",),
    "lab": ("cryptography", "starlette", "uvicorn", "websockets"),
    "lsl": ("pylsl",),
    "measure": ("emcee", "pyuff"),
    "study": ("pyarrow",),
}


def without(monkeypatch: pytest.MonkeyPatch, extra: str) -> None:
    for package in EXTRAS[extra]:
        for name in [name for name in sys.modules if name.split(".")[0] == package]:
            monkeypatch.delitem(sys.modules, name)
        monkeypatch.setitem(sys.modules, package, None)


def asked_cluster(_: Path) -> None:
    with workers(scheduler="tcp://127.0.0.1:8786"):
        pass


def asked_certificate(folder: Path) -> None:
    certificate("192.168.1.20", folder / "made.pem")


@pytest.mark.parametrize(
    ("extra", "what", "asked"),
    [
        ("cluster", "jobs", asked_cluster),
        ("design", "DXF", lambda _: dxf_text(Drawing({}))),
        ("design", "search of designs", lambda _: Proposals(requirements(), 0, "screened", 1)),
        ("device", "serial port", lambda _: SerialStream("/dev/none")),
        ("lab", "tablets", asked_certificate),
        ("lsl", "stream of markers", lambda _: Markers()),
        ("study", "CSV", lambda _: parquet_bytes(Table({"x_m": np.zeros(1)}))),
    ],
)
def test_what_lacks_a_package_names_the_extra(
    extra: str,
    what: str,
    asked: Callable[[Path], object],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    without(monkeypatch, extra)
    with pytest.raises(MissingPackageError, match=rf"{what}.*squeezefilm\[{extra}\]"):
        asked(tmp_path)


def test_a_package_without_its_library_is_named_too() -> None:
    with (
        pytest.raises(MissingPackageError, match=r"liblsl is not there.*squeezefilm\[lsl\]"),
        optional("lsl", "a stream of markers"),
    ):
        raise RuntimeError("liblsl is not there")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        ("analyze biet2008-plate --out OUT", ""),
        ("friction biet2008-stator", ""),
        ("render sine-3mm --display biet2008-plate --out OUT", ""),
        ("play sine-3mm --display biet2008-stator --duration 1s", "device"),
        ("lab --no-browser", "lab"),
    ],
)
def test_verbs_of_physics_need_no_extra(arguments: str, extra: str, tmp_path: Path) -> None:
    packages = sorted(set().union(*EXTRAS.values()))
    asked = arguments.replace("OUT", str(tmp_path / "out")).split()
    program = (
        f"import sys; sys.modules |= dict.fromkeys({packages}); sys.argv[1:] = {asked}; "
        "from squeezefilm.__main__ import main; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    said = " ".join((done.stdout + done.stderr).split())
    if extra:
        assert done.returncode == 2
        assert f"squeezefilm[{extra}]" in said
    else:
        assert done.returncode == 0, said
