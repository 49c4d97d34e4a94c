"""Analyses to draw: both presets, and displays that are odd but allowed. Each computed once."""

from __future__ import annotations

import dataclasses
import functools
import os
from collections.abc import Callable, Iterator
from itertools import starmap
from pathlib import Path
from unittest import mock

import pytest
from tests.unit.described import Descriptions, described, drawn_figures

from squeezefilm.core.kit import style
from squeezefilm.design.analysis.analysis import Analysis
from squeezefilm.design.analysis.analyze import analyze as whole_analysis
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import AnnularStator, RectangularPlate

HOSTILE = '<script>alert("x")</script> $\\frac{1}{0}$ [bold]漢字 \x1b[31m\u202e & more'

PRESETS = ("biet2008-plate", "biet2008-stator", "winfield2007-tpad")


# The fewest samples that have an interval: what is tested is how it is shown.
analyze = functools.partial(whole_analysis, samples=8)


def plate(display: Display, **changes: object) -> Display:
    """The display with its plate changed."""
    assert isinstance(display.actuator, RectangularPlate)
    return dataclasses.replace(
        display,
        actuator=dataclasses.replace(display.actuator, **changes),  # type: ignore[arg-type]
    )


@functools.cache
def analysis_named(name: str) -> Analysis:
    """The analysis of a preset or of an odd display by its name here."""
    if name in PRESETS:
        return analyze(load_display(name))
    base = load_display("biet2008-plate")
    assert isinstance(base.actuator, RectangularPlate)
    patches = base.actuator.patches
    if name == "one-ceramic":
        return analyze(plate(base, patches=patches[3:4]))
    if name == "hostile-names":
        surfaces = tuple(
            dataclasses.replace(item, name=f"{HOSTILE} {number}" * 3)
            for number, item in enumerate(base.surfaces)
        )
        substrate = dataclasses.replace(base.actuator.substrate, name=HOSTILE)
        changed = plate(base, substrate=substrate)
        return analyze(
            dataclasses.replace(changed, name=HOSTILE, title=HOSTILE * 20, surfaces=surfaces)
        )
    if name == "no-voltage":
        return analyze(base, voltage=0.0)
    if name == "floating":
        return analyze(base, voltage=150.0)
    if name == "not-driven":
        # Two ceramics in mirrored places and of one sign cannot drive an odd mode.
        pair = tuple(dataclasses.replace(item, polarity=1) for item in (patches[0], patches[6]))
        return analyze(plate(base, nodal_lines=7, patches=pair))
    if name == "off-resonance":
        return analyze(base, frequency=34.0e3)
    if name == "amplitude-given":
        return analyze(base, vibration_amplitude=3e-6)
    if name == "many-nodes":
        return analyze(plate(base, nodal_lines=30, length=0.4, patches=patches[:1]))
    if name == "square":
        return analyze(plate(base, width=0.083))
    if name == "five-surfaces":
        surfaces = tuple(
            dataclasses.replace(base.surfaces[0], name=f"surface {n}", roughness=n * 0.2e-6)
            for n in range(1, 6)
        )
        return analyze(dataclasses.replace(base, surfaces=surfaces))
    if name == "small-ring":
        ring = load_display("biet2008-stator")
        assert isinstance(ring.actuator, AnnularStator)
        actuator = dataclasses.replace(
            ring.actuator, mean_diameter=2 * 18.7e-3 / 3.14159265, radial_width=4e-3
        )
        return analyze(dataclasses.replace(ring, actuator=actuator))
    assert name == "printed-model"
    return analyze(base, model="paper2008-printed")


@pytest.fixture(scope="session")
def analysis_of() -> Callable[[str], Analysis]:
    """The function that gives the analysis of a preset or of an odd display by its name here."""
    return analysis_named


@pytest.fixture(scope="session")
def stator() -> Display:
    """The paper's stator: measured, so that nothing of it is solved."""
    return load_display("biet2008-stator")


@pytest.fixture
def plate_analysis() -> Analysis:
    """The paper's plate."""
    return analysis_named("biet2008-plate")


@pytest.fixture
def hostile_analysis() -> Analysis:
    """A display whose names try to be markup, escape codes, mathematics and Chinese."""
    return analysis_named("hostile-names")


@pytest.fixture
def figures_as_described(request: pytest.FixtureRequest) -> Iterator[None]:
    """Every figure that a quick test draws must be as described in the text beside the file of
    tests; `make figures` writes that anew."""
    if any(request.node.get_closest_marker(name) for name in ("slow", "nightly")):
        yield
        return
    with drawn_figures() as figures:
        yield
    descriptions = Descriptions(request.path.with_suffix(".txt"))
    for now in starmap(described, figures):
        if os.environ.get("SQUEEZEFILM_DESCRIBE") == "anew":
            descriptions.add(now)
        changed = descriptions.difference(now)
        assert not changed, f"{changed}\nIf this is meant, run `make figures` and read its diff."


@pytest.fixture
def undrawn() -> Iterator[None]:
    """Pages get no drawings but stand-ins: for tests of what a page says beside them."""
    drawings = {"png": b"\x89PNG", "svg": '<svg viewBox="0 0 1 1" role="img"></svg>'}
    with mock.patch.multiple(style, **{k: mock.Mock(return_value=v) for k, v in drawings.items()}):
        yield


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder that does not exist yet."""
    return tmp_path / "deep" / "report"


@pytest.fixture
def printed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[[], str]:
    """The function that gives what was printed, where nobody looks and lines have 80 columns."""
    for name in ("FORCE_COLOR", "COLUMNS", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
        monkeypatch.delenv(name, raising=False)

    def read() -> str:
        captured = capsys.readouterr()
        assert captured.err == ""
        assert "\x1b" not in captured.out
        assert all(len(line) <= 80 for line in captured.out.splitlines())
        return captured.out

    return read
