"""A line scan: of an even wave by the wave, of a plate with ceramics by its points."""

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.vibration.line_points import LinePoints
from squeezefilm.measure.fits.vibration.line_scan import fit_line_scan
from squeezefilm.measure.recordings.kinds import LineScan
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.working_mode import working_mode

X = np.linspace(0, 83e-3, 120)


def test_a_free_beam_needs_no_more_than_the_wave_and_its_ends() -> None:
    # A free-free Euler-Bernoulli beam with 8 nodal lines: kL = 7.5 π but for 1e-9.
    k = 7.5 * np.pi / 83e-3

    def shape(x):
        return np.cos(k * x) - np.sin(k * x) + np.exp(-k * x) + np.exp(-k * (83e-3 - x))

    dense = np.linspace(0, 83e-3, 200_001)
    nodes = dense[1:][np.signbit(shape(dense[1:])) != np.signbit(shape(dense[:-1]))]
    w = -1e-6j * shape(X)
    random = np.random.default_rng(1)
    w = w + 1e-8 * (random.standard_normal(120) + 1j * random.standard_normal(120))
    fit = fit_line_scan(LineScan(X, w, 33e3, 10.0))
    assert fit.adequacy.adequate
    low, high = fit.half_wavelength.interval
    assert low < 83e-3 / 7.5 < high
    for node, own in zip(fit.nodal_lines, nodes, strict=True):
        assert node.value == pytest.approx(own, abs=4 * node.standard_error)
    assert fit.phase is not None
    assert abs(fit.phase.value) == pytest.approx(np.pi / 2, abs=0.05)
    assert {one.answer for one in fit.observations} == {"half_wavelength", "amplitude_per_volt"}


@pytest.mark.slow
def test_the_papers_plate_is_no_even_wave_and_is_read_by_its_points() -> None:
    mode = working_mode(load_display("biet2008-plate").actuator)
    assert mode.solid is not None
    assert mode.line is not None
    response, at = mode.solid.driven_at()
    w = 15 * response.motion(at, X, np.array([mode.lobe[1]]))[:, 0]
    random = np.random.default_rng(2)
    w = w + 1e-8 * (random.standard_normal(120) + 1j * random.standard_normal(120))
    fit = fit_line_scan(LineScan(X, w, mode.resonance_frequency, 15.0))
    assert not fit.adequacy.adequate
    assert fit.by_points
    assert fit.loss_factor is None
    assert "points around" in fit.adequacy.sentence
    assert len(fit.observations) == 2
    for node, own in zip(fit.nodal_lines, mode.line.nodal_positions, strict=True):
        assert node.value == pytest.approx(own, abs=0.1e-3)
    assert fit.antinode_amplitude.value == pytest.approx(15 * mode.amplitude_per_volt, rel=0.01)
    assert fit.half_wavelength.value == pytest.approx(mode.half_wavelength, rel=0.01)


def test_a_phase_of_the_other_sign_would_make_waves_grow() -> None:
    k, middle = np.pi / 11e-3, X.mean()
    turn = (1j * k + k * 0.05 / 4) * (X - middle)
    w = 1e-6 * (np.exp(-turn) + 0.8 * np.exp(turn))
    random = np.random.default_rng(4)
    w = w + 5e-9 * (random.standard_normal(120) + 1j * random.standard_normal(120))
    good, bad = (fit_line_scan(LineScan(X, one, 33e3)) for one in (w, w.conj()))
    assert (good.phase_reversed, bad.phase_reversed) == (False, True)
    assert bad.loss_factor is not None
    assert bad.loss_factor.value == pytest.approx(0.05, rel=0.1)
    assert "other sign" in bad.adequacy.sentence


def test_a_size_gets_its_sign_back_at_every_node() -> None:
    w = np.abs(1e-6 * np.cos(np.pi * X / 11e-3))
    fit = fit_line_scan(LineScan(X, w, 33e3), free_ends=False)
    assert fit.half_wavelength.value == pytest.approx(11e-3, rel=1e-3)
    assert fit.loss_factor is None
    assert fit.standing_wave_ratio is None
    assert fit.phase is None


def test_points_find_nodes_and_antinode_of_a_wave_that_is_not_even() -> None:
    # A wave whose wave number rises along the line, and whose size falls.
    turned = np.pi * (X / 12e-3 + (X / 60e-3) ** 2) + 0.4
    w = np.exp(-X / 0.2) * np.cos(turned)
    found = LinePoints(X, w, 10.5e-3)
    dense = np.linspace(0, 83e-3, 100_001)
    exact = np.cos(np.pi * (dense / 12e-3 + (dense / 60e-3) ** 2) + 0.4)
    nodes = dense[1:][np.signbit(exact[1:]) != np.signbit(exact[:-1])]
    assert [one.value for one in found.nodes] == pytest.approx(nodes.tolist(), abs=0.05e-3)
    assert found.spacing is not None
    assert found.spacing.value == pytest.approx(np.diff(nodes[1:-1]).mean(), rel=0.01)
    assert found.antinode is not None
    assert found.antinode[0] == pytest.approx((nodes[0] + nodes[1]) / 2, abs=1e-3)
    still = LinePoints(X, np.ones(120), 10e-3)
    assert (still.nodes, still.spacing, still.antinode) == ((), None, None)


@pytest.mark.parametrize(
    ("x", "w", "words"),
    [
        (X[:8], np.ones(8) + 0j, "at least 12"),
        (np.zeros(20), np.ones(20) + 0j, "one place"),
        (X, np.zeros(120) + 0j, "zero everywhere"),
    ],
)
def test_what_is_no_wave_is_refused(x, w, words: str) -> None:
    with pytest.raises(InputError, match=words):
        fit_line_scan(LineScan(x, w, 33e3))


def test_the_error_of_the_ratio_of_waves_is_half_its_interval() -> None:
    k, noise = np.pi / 11e-3, np.random.default_rng(5).standard_normal((2, X.size))
    waves = 1e-6 * (np.exp(-1j * k * X) + 0.6 * np.exp(1j * k * X))
    fit = fit_line_scan(LineScan(X, waves + 1e-8 * (noise[0] + 1j * noise[1]), 33e3))
    ratio = fit.standing_wave_ratio
    assert ratio is not None
    low, high = ratio.interval
    assert low < 1.6 / 0.4 < high
    assert ratio.standard_error == pytest.approx((high - low) / (2 * 1.96), rel=0.05)
