"""The figure of a sliding finger: labelled with units, sticking shaded, the same every time."""

from __future__ import annotations

import pytest

from squeezefilm.chain.stroke_force import StrokeForce, stroke_force
from squeezefilm.contact.finger.fingerpad import FingerpadDynamics
from squeezefilm.contact.sliding.dry_friction import DryFriction
from squeezefilm.render.fidelity.trace import friction_trace
from squeezefilm.render.motion.stroke import Stroke
from squeezefilm.render.texture.levels import Amplitude
from squeezefilm.render.texture.shapes import SquareWave
from squeezefilm.report.kit import style
from squeezefilm.report.textures.figures import tangential_force


@pytest.fixture(scope="module")
def stick_slip() -> StrokeForce:
    """A lightly damped pad that sticks and slips over a grating."""
    trace = friction_trace(
        Amplitude(SquareWave(2e-3), 0.0, 2e-6), Stroke(0.03, 0.02), 5e-4, lambda a, v: 1 - a / 3e-6
    )
    return stroke_force(trace, 0.6, 0.5, FingerpadDynamics(damping=0.1), DryFriction(1.5))


def test_title_model_and_axes_say_what_is_shown(stick_slip: StrokeForce) -> None:
    figure = tangential_force(stick_slip)
    title = figure.get_suptitle().replace("\u00a0", " ").replace("\n", " ")
    assert title.startswith("At 30 mm/s the tangential force swings by ")
    assert title.endswith("at 15 Hz")
    assert "unverified defaults" in figure.get_supxlabel().replace("\n", " ")
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes]
    assert labels == [
        ("time (ms)", "tangential force (N)"),
        ("frequency (Hz)", "skin displacement (µm/√Hz)"),
    ]


def test_every_stick_is_shaded(stick_slip: StrokeForce) -> None:
    axes = tangential_force(stick_slip).axes[0]
    shades = axes.collections[0].get_paths()
    motion = stick_slip.motion
    seen = motion.sticking[motion.time <= 1e-3 * axes.get_xlim()[1]]
    runs = int(seen[0]) + int((~seen[:-1] & seen[1:]).sum())
    assert runs > 20
    assert len(shades) == runs


def test_drawn_twice_it_is_the_same(stick_slip: StrokeForce) -> None:
    one, other = (style.svg(tangential_force(stick_slip), "force", "label") for _ in range(2))
    assert one == other
