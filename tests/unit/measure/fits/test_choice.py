"""Which circuit a sweep asks for: by which layouts that is found out."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from tests.unit.measure.fits.test_impedance import FREQUENCY, TRUTH, sweep_of

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.circuit import choice
from squeezefilm.measure.fits.circuit.branches import Layout
from squeezefilm.measure.fits.circuit.choice import chosen_circuit
from squeezefilm.measure.recordings.kinds import ImpedanceSweep


def test_a_layout_is_fitted_once_from_the_poles_of_a_sweep(monkeypatch: pytest.MonkeyPatch) -> None:
    fitted, known = choice._fitted, Counter[tuple[Layout, bytes]]()

    def counted(sweep, layout, own, quality):  # type: ignore[no-untyped-def]
        known[layout, own.tobytes()] += 1
        return fitted(sweep, layout, own, quality)

    monkeypatch.setattr(choice, "_fitted", counted)
    (_, layout), rivals = chosen_circuit(sweep_of(Layout(1), TRUTH), None, False)
    assert layout == Layout(1)
    assert rivals == []
    assert max(known.values()) == 1
    assert {layout.branches for layout, _ in known} == {1}


@pytest.mark.slow
def test_a_capacitor_has_no_circuit_with_a_branch() -> None:
    capacitor = ImpedanceSweep(FREQUENCY, 2j * np.pi * FREQUENCY * 3e-9 * (1 - 0.01j))
    with pytest.raises(InputError, match="a resonance could not be found"):
        chosen_circuit(capacitor, None, False)
