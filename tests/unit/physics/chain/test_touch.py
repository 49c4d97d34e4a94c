"""A finger on a mode: which amplitude it settles on, with its load given as a function."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.chain import touch as module
from squeezefilm.physics.chain.friction import friction_law
from squeezefilm.physics.chain.touch import Touch, kept_at, load_ratios, touch
from squeezefilm.physics.contact.rough_contact import RoughContact
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.loaded_mode import LoadedMode

F, Q = 30e3, 60.0
LAW: Any = SimpleNamespace(
    frequency=1.001 * F,
    model="partial-levitation",
    place=None,
    mean_square_even=0.5,
    mean_square=0.5,
    sharing=lambda amplitude: (amplitude, "shared"),
)


def mode(modal_mass: float | None = 4e-3) -> Any:
    return SimpleNamespace(resonance_frequency=F, quality_factor=Q, modal_mass=modal_mass)


@pytest.fixture
def loads(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Takes the finger's modal load over the mode's own, as a function of the amplitude."""

    def take(ratio: Callable[[float], complex]) -> None:
        def carried(pad: Any, amplitude: float) -> SimpleNamespace:
            load = ratio(amplitude)
            return SimpleNamespace(load=load, impedance=lambda frequency: load / frequency)

        def loaded(mode: Any, mass: float, felt: SimpleNamespace) -> LoadedMode:
            assert mass == 4e-3
            return LoadedMode(F, Q, felt.load)

        monkeypatch.setattr(module, "_carried", carried)
        monkeypatch.setattr(module, "_loaded", loaded)

    return take


def kept(load: complex) -> float:
    """Of the amplitude at the frequency of the law, by the mode's equation."""
    x = 1 + 1j / Q - 1.001**2
    return abs(x) / abs(x + load)


@pytest.mark.parametrize(
    "ratio",
    [
        lambda a: 0.02j,
        lambda a: (0.01 + 0.03j) / (1 + a / 1e-6),  # lets go as it vibrates
        lambda a: 0.08j / (1 + (a / 1e-6) ** 2),
        lambda a: 0.05j * a / 1e-6,  # takes more and more
    ],
)
@pytest.mark.parametrize("free", [0.3e-6, 2e-6, 5e-6])
def test_the_amplitude_left_is_that_under_its_own_load(
    loads: Callable[..., None], ratio: Callable[[float], complex], free: float
) -> None:
    loads(ratio)
    found = touch(mode(), LAW, free)
    assert found.free_amplitude == free
    assert found.amplitude == pytest.approx(free * kept(ratio(found.amplitude)), rel=1e-7)
    assert found.kept == pytest.approx(found.amplitude / free)
    assert found.mode is not None
    assert found.mode.load_ratio == pytest.approx(ratio(found.amplitude), rel=1e-6)
    assert found.sharing is not None
    assert found.impedance == pytest.approx(ratio(found.amplitude) / LAW.frequency, rel=1e-6)
    # The way back: where the amplitude with the finger is known.
    assert kept_at(mode(), LAW, found.amplitude) == pytest.approx(found.kept, rel=1e-6)


def test_a_secant_settles_where_finger_and_mode_chase_each_other(
    loads: Callable[..., None],
) -> None:
    # An answer that falls by 0.95 for each 1 of amplitude: to 1e-8 that is 360 turns on its own.
    def ratio(a: float) -> complex:
        wanted = (1.95e-6 - 0.95 * a) / 1e-6
        return complex((1 + 1j / Q - 1.001**2) * (1 / max(wanted, 0.05) - 1))

    loads(ratio)
    assert touch(mode(), LAW, 1e-6).amplitude == pytest.approx(1e-6, rel=1e-6)


def test_what_never_settles_says_so(loads: Callable[..., None]) -> None:
    # A finger that lets go all at once: what is made jumps over what it lies on.
    loads(lambda a: 0.05j if a > 0.4e-6 else 0.005j)
    with pytest.raises(ConvergenceError, match="did not settle") as caught:
        touch(mode(), LAW, 1e-6)
    assert caught.value.iterations == 40 + 160
    assert caught.value.residual > 0.1


def test_two_amplitudes_about_to_become_one_are_still_told_apart(
    loads: Callable[..., None],
) -> None:
    """Made is a + c − (a − 1 µm)²/µm, which is a at 1 µm ± √c µm: secants crawl there."""
    rest = 1e-3

    def ratio(a: float) -> complex:
        x = a / 1e-6
        made = x + rest - (x - 1.0) ** 2
        return complex((1 + 1j / Q - 1.001**2) * (1.5 / made - 1))

    loads(ratio)
    found = touch(mode(), LAW, 1.5e-6)
    assert found.amplitude == pytest.approx(1e-6 * (1 + rest**0.5), rel=1e-6)
    # What is made there is what lies there, to the tolerance.
    assert found.mode is not None
    assert abs(1.5e-6 * kept(found.mode.load_ratio) - found.amplitude) < 1.5e-14


def test_a_finger_that_brings_the_mode_to_the_drive_adds_amplitude(
    loads: Callable[..., None],
) -> None:
    loads(lambda a: 1.001**2 - 1 + 0.0j)
    found = touch(mode(), LAW, 1e-6)
    assert found.amplitude == pytest.approx(1e-6 * abs(1 + 1j / Q - 1.001**2) * Q)
    assert found.kept > 1


def test_a_still_surface_and_a_mode_of_unknown_mass_are_left_alone(
    loads: Callable[..., None],
) -> None:
    loads(lambda a: 0.1j)
    still = touch(mode(), LAW, 0.0)
    assert (still.amplitude, still.mode, still.sharing, still.kept) == (0.0, None, None, 1.0)
    assert touch(mode(), LAW, 0.9e-12).sharing is None
    given = touch(mode(None), LAW, 1e-6)
    assert (given.amplitude, given.mode, given.kept) == (1e-6, None, 1.0)
    assert given.sharing is not None
    assert given.impedance == pytest.approx(0.1j / LAW.frequency)
    assert still.impedance is None
    assert kept_at(mode(None), LAW, 1e-6) == 1.0
    assert kept_at(mode(), LAW, 0.9e-12) == 1.0
    assert kept_at(mode(), LAW, 1.1e-12) == pytest.approx(kept(0.1j))
    assert Touch(4e-6, 1e-6, None, None).kept == 0.25


def test_loads_are_found_at_each_amplitude(loads: Callable[..., None]) -> None:
    loads(lambda a: complex(a / 1e-6, 2.0))
    found = load_ratios(mode(), LAW, np.array([1e-6, 3e-6]))
    assert found == pytest.approx([1 + 2j, 3 + 2j])
    assert load_ratios(mode(None), LAW, np.array([1e-6, 3e-6])) == pytest.approx([0j, 0j])


def test_a_firm_finger_off_the_antinode_is_felt_within_its_contact_s_law() -> None:
    """Its plateaus swing less than the antinode, and so may lie closer than that swings."""
    half = 9.35e-3
    law = friction_law(
        load_display("biet2008-stator"), half, F, normal_force=25.0, position=half / 2
    )
    asperities = law.finger.asperity_law(law.surface.roughness)
    assert isinstance(asperities, RoughContact)
    assert float(law.sharing(0.5e-6).mean_gap[0]) < 0.5 * asperities.roughness
    found = load_ratios(mode(), law, np.array([0.5e-6]))
    assert np.all(np.isfinite(found))
    assert np.all(found.imag > 0)
