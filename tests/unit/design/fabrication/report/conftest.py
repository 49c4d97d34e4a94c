"""Displays made ready for a workshop without solving a plate: as beams, without intervals."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterator
from unittest import mock

import pytest

import squeezefilm as sf
from squeezefilm.design.fabrication.fabricate import Fabrication, fabricate
from squeezefilm.design.fabrication.wiring import bill_of, electrodes_of
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate
from squeezefilm.physics.plate.parts import parts_of


@functools.cache
def made_ready(name: str) -> Fabrication:
    """A preset."""
    display = sf.load_display(name)
    plate = isinstance(display.actuator, RectangularPlate)
    prediction = predict(display, theory="timoshenko" if plate else None)
    return fabricate(display, prediction=prediction, intervals=False)


def another(made: Fabrication, actuator: Actuator, **display: object) -> Fabrication:
    """The same with another body in its place; what was predicted stays that of the first."""
    parts = parts_of(actuator)
    electrodes = electrodes_of(actuator, parts)
    changed: Display = dataclasses.replace(made.display, actuator=actuator, **display)  # type: ignore[arg-type] # fields
    return dataclasses.replace(
        made,
        display=changed,
        parts=parts,
        electrodes=electrodes,
        bill=bill_of(actuator, parts, electrodes),
    )


@pytest.fixture(scope="session")
def preset() -> Callable[[str], Fabrication]:
    return made_ready


@pytest.fixture(scope="session")
def with_body() -> Callable[..., Fabrication]:
    return another


@pytest.fixture
def undrawn(undrawn: None) -> Iterator[None]:
    """Nor are there drawings for a workshop."""
    drawings = {"pdf": b"%PDF", "dxf_text": "", "sheet_figure": None, "views_figure": None}
    stand_ins = {name: mock.Mock(return_value=value) for name, value in drawings.items()}
    with mock.patch.multiple("squeezefilm.design.fabrication.report.page", **stand_ins):
        yield
