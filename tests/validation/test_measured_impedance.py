"""The real sweeps: what is known of each is found again, and what is wrong with one is noticed.

The files are no part of the project; `SOURCE.md` beside them says where they come from and what
was known of them before: the expectations here are from there.
"""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

from predict_disc import DISC, FILE, PREDICTED
from radial_mode import predict_radial_mode
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.ceramic.constants import bar_constants, disc_constants
from squeezefilm.measure.fits.circuit.impedance import fit_impedance
from squeezefilm.measure.fits.complex_fit import sweep_peaks
from squeezefilm.measure.recordings.kinds import CeramicBar, ImpedanceSweep

from .measured_data import measured_file, traces_4294a


def piezo_28khz(turned: bool) -> ImpedanceSweep:
    frequency, impedance = traces_4294a(measured_file("impedance/piezo-28kHz.txt"))
    return ImpedanceSweep(frequency, (-1 if turned else 1) / impedance)


def bar_sweep() -> ImpedanceSweep:
    path = measured_file("impedance/pzt-bar-k31.txt")
    frequency, conductance, susceptance = np.loadtxt(path, skiprows=1).T
    return ImpedanceSweep(frequency, conductance + 1j * susceptance)


def disc_sweep() -> ImpedanceSweep:
    path = measured_file("impedance/pzt-disc-35mm-first-radial.csv")
    frequency, size, phase = np.loadtxt(path, delimiter=",", skiprows=1).T
    return ImpedanceSweep(frequency, np.exp(-1j * np.radians(phase)) / size)


def test_a_phase_that_is_off_by_180_degrees_is_noticed() -> None:
    with pytest.raises(InputError, match=r"negative at 801 of 801 points.*180°"):
        fit_impedance(piezo_28khz(turned=False))


@pytest.mark.slow
def test_the_transducer_of_28_khz() -> None:
    fit = fit_impedance(piezo_28khz(turned=True))
    branch = fit.strongest
    assert len(fit.branches) == 1
    assert branch.series_resonance.value == pytest.approx(28098, rel=3e-3)
    assert branch.parallel_resonance.value == pytest.approx(30045, rel=3e-3)
    assert branch.coupling_coefficient.value == pytest.approx(0.354, abs=0.01)
    assert 3.1e-9 * 0.94 < fit.static_capacitance.value < 3.3e-9 * 1.06
    assert branch.motional_capacitance.value == pytest.approx(455e-12, rel=0.06)
    assert branch.motional_inductance.value == pytest.approx(70e-3, rel=0.06)
    assert 70 * 0.85 < branch.quality_factor.value < 78 * 1.15
    assert 160 * 0.85 < branch.motional_resistance.value < 178 * 1.15
    # A linear circuit is 7 % off: the transducer softens under half a volt, and that is said.
    assert fit.softening is not None
    assert fit.adequacy.residual < 0.015
    assert "28.1" in fit.adequacy.where
    peaks = sweep_peaks(piezo_28khz(turned=True))
    assert peaks.resistance_frequency == pytest.approx(30045, rel=1e-3)


def test_the_bar() -> None:
    found = bar_constants(bar_sweep(), CeramicBar(12e-3, 3e-3, 1e-3, 7850.0))
    assert found.compliance_11.value == pytest.approx(1.348e-11, rel=0.01)
    assert found.coupling_31.value == pytest.approx(0.346, abs=0.01)
    assert found.quality_factor.value == pytest.approx(90, rel=0.15)


def test_the_disc() -> None:
    """Compared with what a thin disc's formula gave, where the first mode tells it."""
    found = disc_constants(disc_sweep(), DISC)
    assert found.adequacy.residual < 0.02
    low, high = found.compliance_11.interval
    assert low < 16.31e-12 < high
    assert found.charge_coefficient_31.value == pytest.approx(-201e-12, rel=0.02)
    assert found.free_permittivity_33.value == pytest.approx(1819, rel=0.02)
    assert found.quality_factor.value == pytest.approx(84, rel=0.15)
    # Poisson's ratio is what the prior said: one radial mode does not tell it.
    assert found.from_data["-s12/s11"] > 0.9


@pytest.mark.slow
def test_the_committed_prediction_is_what_the_fit_to_the_first_mode_gives() -> None:
    """With fewer draws than the committed one has, so only to a third of its half intervals."""
    old = tomllib.loads(FILE.read_text(encoding="utf-8"))
    constants = disc_constants(disc_sweep(), DISC)
    again = predict_radial_mode(constants, disc_sweep(), seed=3, draws=160)
    for name in PREDICTED:
        before, now = old["prediction"][name], getattr(again, name)
        low, high = before["interval_95"]
        assert abs(now.value - before["value"]) < (high - low) / 6, name
        assert now.interval == pytest.approx((low, high), abs=(high - low) / 5), name


@pytest.mark.slow
def test_the_disc_as_a_circuit() -> None:
    fit = fit_impedance(disc_sweep())
    branch = fit.strongest
    assert branch.series_resonance.value == pytest.approx(55.61e3, rel=3e-3)
    assert branch.parallel_resonance.value == pytest.approx(69.03e3, rel=3e-3)
    # The coupling itself loses: without that the circuit is 2 % off.
    assert fit.coupling_loss is not None
    assert fit.adequacy.residual < 0.01
