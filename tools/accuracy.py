# ruff: noqa: E402 (threads are set before NumPy is imported)
"""Write docs/reference/accuracy.md: how far the numbers are off, each measured by this run.

`make accuracy`, some minutes. Solvers are set beside scikit-fem (where it is installed) and closed
forms, their times in one thread; the chain beside every measured number, curve and threshold that
comes with the package, the same ones and by the same code as `squeezefilm reproduce`.
"""

from __future__ import annotations

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import importlib.util
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

from plate import CONVERGED, _peers
from tests.verification import test_plate_annular as discs

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.kit.folder import markdown_table
from squeezefilm.measure.recordings.kinds import FrictionCurve
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL
from squeezefilm.physics.display import load_display
from squeezefilm.physics.film.closed import relative_stiffness
from squeezefilm.physics.film.periodic.film import solve_uniform
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.ring.modes import bending_mode
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.validation.command import ClaimResult, reproduce
from squeezefilm.validation.published_friction import (
    FolderComparison,
    compare_folder,
)

PAGE = ROOT / "docs" / "reference" / "accuracy.md"
Row = tuple[str, ...]


def timed(what: str, run: Callable[[], float], true: float, note: str = "") -> Row:
    """The value of a run beside the true one, with its error and the second run's time (s)."""
    run()
    began = time.perf_counter()
    value = run()
    took = time.perf_counter() - began
    return what, f"{value:.6g}", f"{true:.6g}", f"{value / true - 1:+.2%}", f"{took:.3g} s", note


def plate_rows() -> Iterator[Row]:
    """The paper's plate in its mode (8,0), by us and by scikit-fem on an even and a graded mesh,
    against the converged value."""
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    ours = partial(solve_modes, plate, mode=(8, 0))
    value = CONVERGED[plate.ceramic.data_set]
    yield timed("squeezefilm", lambda: float(ours().frequencies[0]), value, plate.ceramic.data_set)
    if importlib.util.find_spec("skfem") is None:
        return
    for peer, settings in _peers().items():
        for setting, run in settings if peer.startswith("scikit-fem") else ():
            # The finest takes minutes and is no more than the converged value.
            if not setting.startswith("3 layers"):
                yield timed(f"{peer}, {setting}", run, CONVERGED["printed_e31"], "printed_e31")


def closed_rows() -> Iterator[Row]:
    """Thin discs against Kirchhoff's plate, and films that hardly move against the linear one."""
    radius, thickness = 0.05, 0.25e-3
    for label, diameters, circles, low, high in (
        ("2 nodal diameters", 2, 0, 1.5, 3),
        ("1 nodal circle", 0, 1, 2, 4),
    ):
        root = discs._kirchhoff_root(diameters, 0.3, 0, low, high)
        kirchhoff = discs._kirchhoff_frequency(root, radius, thickness, discs.STEEL)
        section = discs.plain(0, radius, thickness)

        def solved(n: int = diameters, p: int = circles, section: object = section) -> float:
            return float(bending_mode(section, n, p, quality_factor=100).frequency)  # type: ignore[arg-type]

        name = f"disc of h/R = {thickness / radius:.3g}, {label} (Hz)"
        yield timed(name, solved, kirchhoff, "Kirchhoff has no shear and no rotary inertia")
    for sigma in (1.0, 10.0, 100.0):

        def stiffness(sigma: float = sigma) -> float:
            return float(solve_uniform(sigma, 0.01, tolerance=1e-5).stiffness_relative)

        exact = float(relative_stiffness(sigma))
        yield timed(f"film's stiffness at σ = {sigma:g}, ε = 0.01", stiffness, exact, "linear film")


def claim_rows(results: tuple[ClaimResult, ...]) -> Iterator[Row]:
    """Every number that somebody measured on a plate, beside ours."""
    for result in results:
        claim = result.claim
        if "measured" not in claim.statement or claim.relation != "equals":
            continue
        unit = si.Unit(claim.unit)
        for printed, value in zip(claim.printed, result.found.value, strict=True):
            said = (si.format_quantity(one, unit, 4) for one in (printed, value))
            yield claim.statement, *said, f"{value / printed - 1:+.0%}"


def curve_rows(compared: FolderComparison) -> Iterator[Row]:
    """Every published curve of friction beside the default model."""
    for one in compared.curves:
        curve: FrictionCurve = one.curve
        default = next(score for score in one.models if score.model == DEFAULT_MODEL)
        inside = [flag for flag in one.inside if flag is not None]
        off = "–" if default.difference is None else f"{default.difference:.3f}"
        points = f"{curve.friction.size}"
        yield curve.told.name, curve.told.who, points, off, f"{np.mean(inside):.0%}"


def people_rows(compared: FolderComparison) -> Iterator[Row]:
    """Published numbers of many people: their median beside the default model's."""
    for one in compared.populations:
        median = float(np.median(one.measured))
        value = dict(one.models).get(DEFAULT_MODEL)
        if value is not None:
            unit = si.Unit(one.unit)
            said = (si.format_quantity(number, unit, 3) for number in (median, value))
            share = f"{one.share_below(value):.0%} of {one.measured.size} below ours"
            yield f"{one.told.name}: {one.quantity}", *said, f"{value / median - 1:+.0%}", share


def threshold_rows(compared: FolderComparison) -> Iterator[Row]:
    """Published thresholds of a friction that changes along a surface, beside our observer's."""
    for one in compared.detections:
        name, ours = one.rivals[0]
        for period, measured, value in zip(
            one.measured.period, one.measured.amplitude, ours, strict=True
        ):
            what = f"{one.told.name}, {si.format_quantity(float(period), si.Unit('m'), 3)}"
            yield what, f"{measured:.4f}", f"{value:.4f}", f"{value / measured:.2f}", name


def page(tables: dict[str, tuple[Row, list[Row]]]) -> str:
    """The page of tables by their headings."""
    lines = [
        "# Accuracy",
        "",
        "Written by `make accuracy`; do not edit. Errors of the solvers are against converged "
        "values and closed forms, with times of one thread on the machine that wrote this page: "
        "compare them with each other only. Errors of the chain are against what was measured. "
        "[Validation](validation.md) says why a number differs, "
        "[Published friction](published-friction.md) has every model beside every curve.",
    ]
    for heading, table in tables.items():
        lines += ["", f"## {heading}", "", *markdown_table(table)]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure everything and write the page."""
    solver = ("what", "computed", "true", "error", "time", "remark")
    say = partial(print, file=sys.stderr, flush=True)
    say("solvers")
    plates, closed = list(plate_rows()), list(closed_rows())
    say("claims")
    claims = list(claim_rows(reproduce(progress=say).results))
    compared = compare_folder(presets.friction_folder(), say)
    tables = {
        "The paper's plate, mode (8,0), in Hz": (solver, plates),
        "Closed forms": (solver, closed),
        "Measured on plates": (("what", "measured", "computed", "error"), claims),
        "Measured curves of friction": (
            ("curve", "who", "points", "µ′/µ off by, rms", "points in the 90 % interval"),
            list(curve_rows(compared)),
        ),
        "Measured of many people": (
            ("what", "median", "computed", "error", "share"),
            list(people_rows(compared)),
        ),
        "Measured thresholds": (
            ("recording, period", "measured µ", "computed µ", "ratio", "by"),
            list(threshold_rows(compared)),
        ),
    }
    PAGE.write_text(page(tables), encoding="utf-8")
    say(f"wrote {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
