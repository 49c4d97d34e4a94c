"""What must hold for every load balance, not only for the tabulated ones."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from tests.plateau import mean_pressure

from squeezefilm.core.materials import Gas
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.sharing.balance import share_load, share_load_tied
from squeezefilm.physics.contact.sharing.gas_table import film_table
from squeezefilm.physics.film.periodic.film import solve_uniform

GAS = Gas(1.85e-5, 1e5, 1.2, 67e-9)

amplitudes = st.floats(0.05e-6, 6e-6)
pressures = st.floats(500.0, 3e4)
# Few of them, since each makes a table of its own.
frequencies = st.sampled_from([20e3, 33e3, 60e3])
widths = st.sampled_from([150e-6, 250e-6, 350e-6])
laws = st.builds(
    AsperityLaw,
    st.floats(1e3, 2e4),
    st.floats(1e-6, 4e-6),
    st.floats(0.2e-6, 0.8e-6),
    st.sampled_from(["exponential", "gaussian"]),
    # Gaussian heights are tabulated to 20 deviations; scaled, a law at the very end is beyond it.
).filter(lambda law: law.reference_gap < 19.9 * law.decay_length)
exponential = st.builds(
    AsperityLaw, st.floats(1e3, 2e4), st.floats(1e-6, 4e-6), st.floats(0.2e-6, 0.8e-6)
)


def assume_open(law: AsperityLaw, pressure: float) -> None:
    """Asperities alone carry the load at rest, and most do not touch: there the law holds.

    Gaussian asperities refuse a load so light that only heights beyond 20 deviations carry it.
    """
    assume(0.999 * law.largest_pressure > pressure)
    if law.heights == "gaussian":
        assume(law.pressure(19.99 * law.decay_length) < pressure)


# The first call compiles or loads compiled code.
calm = settings(settings.get_profile("dear"))


@calm
@example(2.842846438862323e-07, 500.0, 20e3, 150e-6, AsperityLaw(1e3, 3.93e-6, 2e-7, "gaussian"))
@given(amplitudes, pressures, frequencies, widths, laws)
def test_gas_and_asperities_carry_the_load(a, pressure, frequency, width, law):
    assume_open(law, pressure)
    table = film_table(frequency, width, GAS)
    shared = share_load(table, law, a, pressure)
    carried = float(shared.gas_pressure + shared.asperity_pressure)
    assert abs(carried / pressure - 1) < 1e-8
    assert float(shared.mean_gap) > a
    # Zero where Gaussian asperities end below the gap: full levitation.
    assert 0 <= float(shared.relative_friction) <= 1
    # Independent of the table and of the compiled code: the same film and asperities, afresh.
    u = float(shared.mean_gap)
    film = solve_uniform(
        (table.length / u) ** 2, a / u, knudsen_number=GAS.mean_free_path / u, tolerance=1e-4
    )
    gas = GAS.ambient_pressure * film.over_pressure
    assert abs(gas / float(shared.gas_pressure) - 1) < table.relative_error + 2e-4
    assert np.isclose(
        float(mean_pressure(law, u, a)), float(shared.asperity_pressure), rtol=1e-6, atol=1e-9
    )


@calm
@given(pressures, frequencies, widths, exponential)
def test_friction_falls_with_amplitude(pressure, frequency, width, law):
    # Where asperities end abruptly (Gaussian heights), friction below a hundredth may rise again:
    # the gap has grown, and the film with it has weakened.
    assume_open(law, pressure)
    table = film_table(frequency, width, GAS)
    curve = share_load(table, law, np.linspace(0.0, 5e-6, 21), pressure).relative_friction
    assert np.all(np.diff(curve) < 1e-9)


@calm
@given(amplitudes, pressures, widths, laws)
def test_friction_falls_with_frequency(a, pressure, width, law):
    assume_open(law, pressure)
    values = [
        float(share_load(film_table(f, width, GAS), law, a, pressure).relative_friction)
        for f in (20e3, 33e3, 60e3)
    ]
    # Equal only where nothing is left to lose: full levitation to rounding.
    assert values[0] >= values[1] >= values[2]
    assert values[0] > values[2] or values[0] < 1e-12


@calm
# A load that only heights beyond 20 deviations would carry: refused, and so no example.
@example(1e-6, 500.0, 33e3, AsperityLaw(2e4, 3.9e-6, 0.2e-6, "gaussian"))
@given(amplitudes, pressures, frequencies, laws)
def test_friction_rises_with_roughness(a, pressure, frequency, law):
    assume_open(law.scaled(0.9), pressure)
    table = film_table(frequency, 250e-6, GAS)
    values = [
        float(share_load(table, law.scaled(s), a, pressure).relative_friction)
        for s in (0.9, 1.0, 1.1)
    ]
    assert values[0] < values[1] + 1e-9
    assert values[1] < values[2] + 1e-9


@calm
@given(amplitudes, pressures, laws)
def test_tied_ridges_that_are_alike_are_as_one(a, pressure, law):
    assume_open(law, pressure)
    table = film_table(33e3, 250e-6, GAS)
    alone = float(share_load(table, law, a, pressure).relative_friction)
    tied = share_load_tied(table, law, np.full(5, a), pressure)
    assert np.isclose(tied.relative_friction, alone, rtol=1e-7)
    assert abs(tied.residual) < 1e-8
