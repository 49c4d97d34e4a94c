"""Where the constants of a ceramic are from that a calibration moved by shares."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

from squeezefilm.measure.calibration.priors import SHARES
from squeezefilm.measure.calibration.written_display import _ceramic_sources
from squeezefilm.physics.display import load_display

PLATE: Any = load_display("biet2008-plate")
STIFF, CHARGE, _ = SHARES


def calibration(*paths: str, actuator: Any = None) -> Any:
    values = [
        SimpleNamespace(path=path, median=1.0 + 0.01 * k, interval=(0.9, 1.1))
        for k, path in enumerate(paths)
    ]
    display = SimpleNamespace(actuator=PLATE.actuator if actuator is None else actuator)
    return SimpleNamespace(display=display, values=values)


def test_constants_that_moved_together_name_the_shares() -> None:
    found = _ceramic_sources(calibration("actuator.thickness", STIFF, CHARGE), "the bench")
    stiffness = found["actuator.ceramic.in_plane_stiffness"]
    assert stiffness.evidence == "measured"
    assert stiffness.source == (
        f"the bench. Moved together by shares: {SHARES[STIFF]}: 1.010 (0.900 to 1.100); "
        f"{SHARES[CHARGE]}: 1.020 (0.900 to 1.100)"
    )
    for name in ("charge_coefficient", "relative_permittivity"):
        assert found[f"actuator.ceramic.{name}"].source == "with in_plane_stiffness: the bench"
    full = PLATE.actuator.ceramic.constants
    known = {
        f"actuator.ceramic.constants.{field.name}"
        for field in (dataclasses.fields(full) if full is not None else ())
        if getattr(full, field.name) is not None
    }
    assert {path for path in found if ".constants." in path} == known
    assert len(found) == 3 + len(known)


def test_a_ceramic_that_was_not_moved_keeps_its_sources() -> None:
    assert _ceramic_sources(calibration("actuator.thickness"), "the bench") == {}
    stator: Any = load_display("biet2008-stator").actuator
    assert _ceramic_sources(calibration(STIFF, actuator=stator), "the bench") == {}
