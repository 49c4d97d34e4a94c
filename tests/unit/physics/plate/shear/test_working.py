"""The shear plate's working mode beside the solved one's, and what it refuses."""

from __future__ import annotations

from dataclasses import replace

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.shear.working import shear_working
from squeezefilm.physics.plate.working_mode import working_mode


def _plate(name: str) -> RectangularPlate:
    actuator = load_display(name).actuator
    assert isinstance(actuator, RectangularPlate)
    return actuator


def test_it_stands_beside_the_solved_plate() -> None:
    plate = _plate("biet2008-plate")
    screened, solved = working_mode(plate, "shear"), working_mode(plate)
    assert screened.resonance_frequency == pytest.approx(solved.resonance_frequency, rel=0.025)
    assert screened.amplitude_per_volt == pytest.approx(solved.amplitude_per_volt, rel=0.15)
    assert screened.half_wavelength == pytest.approx(solved.half_wavelength, rel=0.03)
    assert screened.line is not None
    assert solved.modal_mass is not None
    assert screened.modal_mass == pytest.approx(solved.modal_mass, rel=0.25)
    assert len(screened.line.nodal_positions) == plate.nodal_lines


def test_strips_along_the_edges_drive_lines_across_the_width() -> None:
    """A beam bends what lies side by side together, which is right to 2 %. Glue and gasket are left
    out."""
    plate = _plate("touchpad-glass")
    bare = replace(plate, supports=(), glue=None)
    screened, beam = working_mode(bare, "shear"), working_mode(bare, "timoshenko")
    found = shear_working(bare, screened.resonance_frequency)
    assert found.mode.nodal_lines == (0, plate.nodal_lines)
    assert len(screened.line.nodal_positions) == plate.nodal_lines  # type: ignore[union-attr]
    assert beam.resonance_frequency == pytest.approx(screened.resonance_frequency, rel=0.02)


def test_ceramics_on_the_touched_face_are_refused() -> None:
    plate = _plate("biet2008-plate")
    above = replace(plate, patches=tuple(replace(one, face="top") for one in plate.patches))
    with pytest.raises(InputError, match="lower face only"):
        shear_working(above, 34e3)
