"""What a fit leaves is told to be noise or a wrong model, and a person is told which."""

import numpy as np

from squeezefilm.measure.fits.estimate import adequacy_of, correlation_factor, structure_of

X = np.linspace(0, 6, 200)


def place(i: int) -> str:
    return f"at {X[i]:.1f}"


def test_noise_is_structured_as_often_as_chance_has_it() -> None:
    random = np.random.default_rng(3)
    factors = [correlation_factor(random.standard_normal(200)) for _ in range(2000)]
    assert sum(factor > 1 for factor in factors) <= 3


def test_neighbours_that_are_alike_widen_errors_by_what_their_mean_says() -> None:
    random = np.random.default_rng(4)
    alike, noise = 0.7, random.standard_normal(20_000)
    row = np.empty(noise.size)
    row[0] = noise[0]
    for i in range(1, noise.size):
        row[i] = alike * row[i - 1] + np.sqrt(1 - alike**2) * noise[i]
    assert structure_of(row).significance > 4
    # The mean of such a row has (1 + ρ)/(1 − ρ) times the variance of independent points.
    means = row.reshape(-1, 200).mean(axis=1)
    assert 0.7 < correlation_factor(row) / np.sqrt(200) / np.std(means) < 1.3


def test_a_wrong_model_is_said_to_be_wrong_and_where() -> None:
    random = np.random.default_rng(5)
    data = 1 + np.exp(-((X - 4) ** 2) / 0.1)
    said = adequacy_of(
        data, data - 1 + 0.01 * random.standard_normal(200), place, remedy="Do better."
    )
    assert not said.adequate
    assert said.noise < 0.5 * said.residual
    assert "at 4.0" in said.where or "at 3.9" in said.where
    assert "Do better." in said.sentence


def test_noise_however_large_up_to_a_half_is_adequate_and_beyond_is_nothing() -> None:
    random = np.random.default_rng(6)
    noise = random.standard_normal(200)
    assert adequacy_of(np.ones(200), 0.2 * noise, place, remedy="").adequate
    hopeless = adequacy_of(np.ones(200), noise, place, remedy="")
    assert not hopeless.adequate
    assert "mean nothing" in hopeless.sentence


def test_a_slight_misfit_is_tolerated_and_said() -> None:
    random = np.random.default_rng(7)
    residual = 0.004 * np.sin(X) + 0.001 * random.standard_normal(200)
    said = adequacy_of(np.ones(200), residual, place, remedy="")
    assert said.adequate
    assert "intervals are widened" in said.sentence


def test_what_a_few_neighbours_show_is_not_lost_in_a_long_row() -> None:
    """A second mode of 20 points in 2000: 0.2 % of the row on average, 20 % where it is."""
    random = np.random.default_rng(8)
    noise = 0.02 * (random.standard_normal(2000) + 1j * random.standard_normal(2000))
    row = np.arange(2000)
    second = 0.2 * np.exp(-(((row - 700) / 8) ** 2))
    fine = adequacy_of(np.ones(2000), noise, lambda i: f"at {i}", remedy="")
    missed = adequacy_of(np.ones(2000), noise + second, lambda i: f"at {i}", remedy="Look.")
    assert fine.adequate
    assert not missed.adequate
    assert abs(int(missed.where.split()[1]) - 700) < 10
    assert "Look." in missed.sentence


def test_noise_alone_is_hardly_ever_called_a_misfit_and_one_odd_point_is_none() -> None:
    random = np.random.default_rng(9)
    bad = 0
    for _ in range(400):
        noise = 0.15 * random.standard_normal(160)
        bad += not adequacy_of(np.ones(160), noise, lambda i: "", remedy="").adequate
    assert bad <= 2
    odd = 0.01 * random.standard_normal(160)
    odd[40] = 0.2
    assert adequacy_of(np.ones(160), odd, lambda i: "", remedy="").adequate


def test_a_model_that_is_off_by_little_is_good_for_a_first_look_only() -> None:
    random = np.random.default_rng(10)
    residual = 0.03 * np.sin(X) + 0.002 * random.standard_normal(200)
    said = adequacy_of(np.ones(200), residual, place, remedy="", model="The circuit")
    assert not said.adequate
    assert said.sentence.startswith("The circuit describes what was recorded only roughly")
