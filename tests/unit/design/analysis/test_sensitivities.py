"""What each value of a display does to it, against the display with that value predicted anew."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.distributions import Uniform
from squeezefilm.core.errors import InputError
from squeezefilm.design.analysis.sensitivities import (
    DisplaySensitivities,
    DisplaySensitivity,
    display_sensitivities,
)
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display
from squeezefilm.physics.uncertainty.parameters import replaced


def _row(found: DisplaySensitivities, path: str) -> DisplaySensitivity:
    return next(one for one in found.rows if one.path == path)


@pytest.fixture(scope="module")
def disc() -> DisplaySensitivities:
    display = load_display("winfield2007-tpad")
    return display_sensitivities(display, predict(display))


@pytest.mark.slow
def test_a_row_is_the_prediction_of_the_changed_display() -> None:
    display = load_display("winfield2007-tpad")
    p = predict(display)
    found = display_sensitivities(display, p, "solved")
    assert found.relative_friction == pytest.approx(p.relative_friction)
    for path in ("actuator.thickness", "actuator.glue.thickness", "actuator.quality_factor"):
        row = _row(found, path)
        for end in (row.low, row.high):
            there = predict(replaced(display, {path: end.value}))
            f = there.mode.resonance_frequency / p.mode.resonance_frequency - 1
            a = there.mode.amplitude_per_volt / p.mode.amplitude_per_volt - 1
            assert (end.frequency_shift, end.amplitude_shift) == pytest.approx((f, a), abs=1e-9)
            # Another plate's shape differs a little from the described one's, which stands in.
            assert end.relative_friction == pytest.approx(there.relative_friction, abs=2e-4)
    for path in ("finger.plateau_width", "finger.contact_decay_length"):
        row = _row(found, path)
        for end in (row.low, row.high):
            there = predict(replaced(display, {path: end.value}))
            assert end.relative_friction == pytest.approx(there.relative_friction, abs=1e-6)
            assert (end.frequency_shift, end.amplitude_shift) == (0.0, 0.0)


@pytest.mark.slow
def test_a_glued_body_has_rows_of_its_glue(disc: DisplaySensitivities) -> None:
    thick, stiff = (_row(disc, f"actuator.glue.{one}") for one in ("thickness", "young_modulus"))
    assert thick.low.frequency_shift is not None
    assert stiff.low.frequency_shift is not None
    # A softer one lowers the frequency. (A thicker one need not: it moves the ceramic outwards.)
    assert stiff.low.frequency_shift < 0 < stiff.high.frequency_shift  # type: ignore[operator]
    assert thick.origin == "assumed"
    assert "assumed" in thick.source


def test_the_most_telling_stand_first_and_ranges_that_are_given_count() -> None:
    display = load_display("biet2008-stator")
    p = predict(display)
    found = display_sensitivities(display, p)
    changes = [one.friction_change for one in found.rows]
    assert changes == sorted(changes, reverse=True)
    path = "finger.contact_decay_length"
    known = {**display.provenance, path: Provenance("me", "measured", Uniform(9.5e-6, 9.7e-6))}
    narrow = display_sensitivities(dataclasses.replace(display, provenance=known), p)
    row = _row(narrow, path)
    assert (row.origin, row.source) == ("given", "me")
    assert row.friction_change < 0.05 * _row(found, path).friction_change
    said = found.summary()
    assert len(said["rows"]) == len(found.rows)
    with pytest.raises(InputError, match="effort"):
        display_sensitivities(display, p, "hard")  # type: ignore[arg-type]


def test_a_beam_stands_in_for_a_plate_where_that_is_quick() -> None:
    """Theory: f ∝ h of a free plate, amplitude ∝ Q and d31; the ceramics share in it."""
    display = load_display("biet2008-plate")
    p = predict(display, theory="timoshenko")
    found = display_sensitivities(display, p)
    assert found.plate_model.startswith("timoshenko")
    quality = _row(found, "actuator.quality_factor")
    for end in (quality.low, quality.high):
        share = end.value / quality.nominal
        assert end.amplitude_shift == pytest.approx(share - 1, rel=1e-2)
        assert end.frequency_shift == pytest.approx(0.0, abs=1e-12)
    charge = _row(found, "actuator.ceramic.charge_coefficient")
    share = charge.low.value / charge.nominal
    assert charge.low.amplitude_shift == pytest.approx(share - 1, rel=1e-6)
    # f ∝ 1/length², but for the end that then lies bare.
    length = _row(found, "actuator.length")
    assert length.high.frequency_shift == pytest.approx(
        -2 * (length.high.value / length.nominal - 1), rel=0.15
    )
    both = [_row(found, f"actuator.substrate.{one}") for one in ("young_modulus", "density")]
    assert np.sign([one.high.frequency_shift or 0.0 for one in both]).tolist() == [1.0, -1.0]


@pytest.mark.slow
def test_quick_rows_know_the_glue_of_a_plate() -> None:
    """Theory knows the sign; the display predicted with the other glue has the same friction."""
    display = load_display("basdogan2020-glass")
    p = predict(display)
    found = display_sensitivities(display, p)
    assert "coarse mesh" in found.plate_model
    stiff = _row(found, "actuator.glue.young_modulus")
    assert stiff.low.frequency_shift < 0 < stiff.high.frequency_shift  # type: ignore[operator]
    for end in (stiff.low, stiff.high):
        there = predict(replaced(display, {stiff.path: end.value}))
        assert end.relative_friction == pytest.approx(there.relative_friction, abs=3e-3)


def test_what_is_not_known_stands_last() -> None:
    """Who asks for the beam gets no rows of the glue, which it does not know."""
    display = load_display("basdogan2020-glass")
    found = display_sensitivities(display, predict(display, theory="timoshenko"))
    row = _row(found, "actuator.glue.thickness")
    assert (row.low.frequency_shift, row.low.relative_friction) == (None, None)
    assert "leave the theory out" in row.low.why_not
    known = [one.known for one in found.rows]
    assert known == sorted(known, reverse=True)
    assert not all(known)


def test_ceramics_with_full_constants_have_rows_of_both_their_kinds() -> None:
    """Amplitude ∝ d31, and a stiffer ceramic raises the frequency."""
    display = load_display("touchpad-glass")
    found = display_sensitivities(display, predict(display, theory="timoshenko"))
    charge = _row(found, "actuator.ceramic.charge_coefficient")
    for end in (charge.low, charge.high):
        assert end.amplitude_shift == pytest.approx(end.value / charge.nominal - 1, rel=1e-6)
    assert "APC International" in charge.source
    stiff = _row(found, "actuator.ceramic.in_plane_stiffness")
    assert stiff.low.frequency_shift < 0 < stiff.high.frequency_shift  # type: ignore[operator]


def test_an_amplitude_that_is_given_leaves_the_plate_out() -> None:
    display = load_display("biet2008-stator")
    found = display_sensitivities(display, predict(display, vibration_amplitude=2e-6))
    assert not any(one.path.startswith("actuator.") for one in found.rows)


@pytest.mark.nightly
def test_the_beam_moves_as_the_solved_plate_does() -> None:
    """On the paper's plate the quick shifts are within a third of the solved ones, or 0.2 %."""
    display = load_display("biet2008-plate")
    p = predict(display)
    quick, solved = (display_sensitivities(display, p, one) for one in ("quick", "solved"))  # type: ignore[arg-type]
    for row in solved.rows:
        if not row.path.startswith("actuator."):
            continue
        beam = _row(quick, row.path)
        for mine, its in ((beam.low, row.low), (beam.high, row.high)):
            assert mine.frequency_shift == pytest.approx(its.frequency_shift, rel=1 / 3, abs=2e-3)
            assert mine.relative_friction == pytest.approx(its.relative_friction, abs=0.02)
