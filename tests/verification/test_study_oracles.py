"""Fits, placements and population models against other people's programs, on twenty data sets each
(five of those that take seconds, twenty at night).

psignifit and questplus are GPL, and oracles of these tests only. Each test prints the largest
difference that it found.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from tests.recovery import task_people
from tests.recovery.task_people import DESIGNS, Person, answered, somebody
from tests.task_models import (
    Placement,
    magnitude_model,
    match_to_sample_model,
    same_different_model,
    two_interval_model,
)
from tests.verification.test_psychometric import posterior_mean

from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.design.tasks.surfaces import QUARTILE
from squeezefilm.study.psychometric.fit import fit_psychometric
from squeezefilm.study.psychometric.function import PsychometricFunction, PsychometricPrior
from squeezefilm.study.tasks.scales import exponents
from squeezefilm.study.tasks.thresholds import on_grid

SETS = range(20)
FEW = pytest.mark.parametrize(
    "seeds", [SETS[:5], pytest.param(SETS, marks=pytest.mark.nightly)], ids=["five", "twenty"]
)
LEVELS = np.arange(1.0, 9.0)
NORMAL_TAIL = 1.6448536269514722


@pytest.mark.nightly
# psignifit takes logarithms of rounding.
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_twenty_fits_agree_with_psignifit() -> None:
    psignifit = pytest.importorskip("psignifit", reason="psignifit is not installed (GPL oracle)")
    worst = {"mean": 0.0, "interval": 0.0}
    for seed in SETS:
        random = np.random.default_rng(seed)
        truth = PsychometricFunction(
            "logistic", random.uniform(3.5, 5.5), random.uniform(2.0, 4.0), 0.5, 0.02
        )
        trials = np.full(LEVELS.size, 40)
        right = random.binomial(trials, truth(LEVELS))
        fit = fit_psychometric(LEVELS, right, trials)
        (low, high), (least, most) = fit.prior.threshold, fit.prior.width
        other = psignifit.psignifit(
            np.column_stack([LEVELS, right, trials]),
            sigmoid="logistic",
            experiment_type="2AFC",
            fixed_parameters={"eta": 1e-8},
            bounds={"threshold": (low, high), "width": (least, most), "lambda": (1e-6, 0.5)},
            priors={
                "threshold": np.ones_like,
                "width": lambda width: 1 / width,
                "lambda": lambda rate: (1 - rate) ** 9,
            },
            grid_steps={"threshold": 90, "width": 90, "lambda": 50, "gamma": 1, "eta": 1},
            stimulus_range=(1, 8),
            verbose=False,
        )
        for ours, theirs in (("threshold", "threshold"), ("width", "width")):
            interval = np.array(fit.posterior_interval[ours])
            size = float(np.ptp(interval))
            mean = other.parameter_estimate_mean[theirs]
            apart = abs(posterior_mean(fit.posterior, ours) - mean) / size
            ends = np.abs(interval - other.confidence_intervals[theirs]["0.95"]).max() / size
            worst = {
                "mean": max(worst["mean"], apart),
                "interval": max(worst["interval"], float(ends)),
            }
    print("psignifit, largest difference over the interval's length:", worst)
    assert worst["mean"] < 0.02
    # psignifit reads its intervals off the nodes of its grid.
    assert worst["interval"] < 0.08


@pytest.mark.slow
@FEW
def test_runs_choose_as_questplus_does(seeds: range) -> None:
    questplus = pytest.importorskip("questplus", reason="questplus is not installed (GPL oracle)")
    stimuli = tuple(np.linspace(0.0, 10.0, 21).tolist())
    prior = PsychometricPrior((1.0, 9.0), (0.5, 12.0))
    cells = (15, 9, 4)
    choices, same, worst = 0, 0, 0.0
    for seed in seeds:
        random = np.random.default_rng(seed)
        truth = PsychometricFunction(
            "gaussian", random.uniform(3, 7), random.uniform(1.5, 6), 0.5, 0.02
        )
        ours = BayesianAdaptive(
            AdaptiveDesign(stimuli, prior, "gaussian", cells=cells, interest="all", most_trials=40)
        )
        nodes = [
            prior.quantile(at, (np.arange(size) + 0.5) / size, "linear")
            for at, size in enumerate(cells)
        ]
        theirs = questplus.QuestPlus(
            stim_domain={"intensity": np.array(stimuli)},
            param_domain={
                "mean": nodes[0],
                "sd": np.exp(nodes[1]) / (2 * NORMAL_TAIL),
                "lower_asymptote": [0.5],
                "lapse_rate": nodes[2],
            },
            outcome_domain={"response": ["yes", "no"]},
            func="norm_cdf",
            stim_scale="linear",
        )
        for _ in range(40):
            mine, other = ours.next_stimulus(), float(theirs.next_stim["intensity"])
            choices += 1
            same += mine == other
            if mine != other:
                # Two stimuli whose answers tell as much, to rounding.
                told = ours.expected_information()
                gap = told[stimuli.index(mine)] - told[stimuli.index(other)]
                assert abs(gap) < 1e-9
            right = bool(random.random() < truth(mine))
            ours.update(mine, right)
            theirs.update(stim={"intensity": mine}, outcome={"response": "yes" if right else "no"})
        posterior = theirs.posterior.transpose(
            "mean", "sd", "lower_asymptote", "lapse_rate"
        ).values[:, :, 0, :]
        worst = max(worst, float(np.abs(posterior - ours.probability).max()))
    print(f"questplus: {same} of {choices} choices alike, posteriors differ by {worst:.1e}")
    assert same >= 0.99 * choices
    assert worst < 1e-6


WEBER = np.geomspace(0.05, 0.6, 12)
STEPS = np.linspace(0.0, 0.8, 9)
MODELS = {
    "two-interval": two_interval_model(
        np.concatenate([-STEPS[:0:-1], STEPS]), WEBER, np.array([-0.1, 0.0, 0.1])
    ),
    "same-different": same_different_model(STEPS, WEBER, np.array([0.7, 1.4, 2.1])),
    "match-to-sample": match_to_sample_model(np.geomspace(1.0, 3.0, 6), WEBER),
    "magnitude-estimation": magnitude_model(
        np.geomspace(1.0, 10.0, 6), np.linspace(0.3, 1.5, 9), np.array([5.0, 10.0, 20.0]),
        np.array([0.15, 0.3]), np.geomspace(1.0, 100.0, 9),
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    "sets",
    [pytest.param(SETS[:5], marks=pytest.mark.slow), pytest.param(SETS, marks=pytest.mark.nightly)],
    ids=len,
)
@pytest.mark.parametrize("task", MODELS)
def test_runs_of_each_task_choose_as_questplus_does(task: str, sets: range) -> None:
    questplus = pytest.importorskip("questplus", reason="questplus is not installed (GPL oracle)")
    xarray = pytest.importorskip("xarray")
    # questplus integrates nothing out before it takes the entropy: all parameters are of interest.
    model = dataclasses.replace(MODELS[task], interest=3 if task != "match-to-sample" else 2)
    domain = {name.replace(" ", "_"): values for name, values in model.parameters.items()}
    outcomes, stimuli = list(model.answers), list(range(len(model.stimuli)))

    class Theirs(questplus.QuestPlus):  # type: ignore[misc, name-defined]
        """Its choice and its posterior, with answers of another model."""

        def _gen_likelihoods(self):  # type: ignore[no-untyped-def]
            table = model.chances.reshape(len(outcomes), *model.sizes, len(stimuli))
            return xarray.DataArray(
                table,
                dims=("response", *domain, "stimulus"),
                coords={"response": outcomes, **domain, "stimulus": stimuli},
            )

    first = model.first_weights()
    choices, same, tied, worst = 0, 0, 0, 0.0
    for seed in sets:
        random = np.random.default_rng([8, seed])
        truth = random.choice(first.size, p=first)
        ours = Placement(model, 25)
        theirs = Theirs(
            stim_domain={"stimulus": stimuli},
            param_domain=domain,
            outcome_domain={"response": outcomes},
            prior={name.replace(" ", "_"): np.array(one) for name, one in model.prior.items()}
            or None,
            func="norm_cdf",
            stim_scale="linear",
        )
        while not ours.finished:
            mine, other = ours.next_stimulus(), int(theirs.next_stim["stimulus"])
            choices += 1
            same += mine == other
            # Presented in either order, or as far apart elsewhere, a pair tells as much: which of
            # them a processor's rounding puts first says nothing.
            told = ours.expected_information()
            assert told[other] > told.max() - 1e-9
            tied += int(np.sum(told > told.max() - 1e-9))
            answer = random.choice(len(outcomes), p=model.chances[:, truth, mine])
            ours.update(mine, int(answer))
            theirs.update(stim={"stimulus": mine}, outcome={"response": outcomes[answer]})
        posterior = theirs.posterior.transpose(*domain).values
        worst = max(worst, float(np.abs(posterior - ours.probability).max()))
    print(
        f"questplus, {task}: {same} of {choices} choices alike, all others ties; on average "
        f"{tied / choices:.1f} of {len(stimuli)} tie; posteriors within {worst:.1e}"
    )
    # Information that is the same everywhere would agree with any choice.
    assert tied < 0.5 * choices * len(stimuli)
    assert worst < 1e-12


@pytest.mark.slow
def test_twenty_people_without_lapses_agree_with_a_probit_model(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(task_people, "LAPSE", 0.0)
    api = pytest.importorskip("statsmodels.api")
    apart = []
    for seed in SETS:
        random = np.random.default_rng([5, seed])
        person = Person(random.uniform(0.08, 0.15), 0.9, random.normal(0.0, 0.03))
        main = answered(DESIGNS["constant"], [person] * 4, random).main(0)
        x, y = main.differences, (main.choice == 0).astype(float)
        model = api.GLM(
            y,
            api.add_constant(x),
            family=api.families.Binomial(api.families.links.Probit()),
        ).fit()
        # Its model has no lapses. Ours holds them possible: where the answers could be a sharp
        # person's who lapses, its interval is wider, and lies lower.
        theirs = math.expm1(QUARTILE / model.params[1])
        error = model.bse[1] / model.params[1]
        whole = answered_as_one(main)
        (mine,) = on_grid(whole, str).estimates(0.95)
        apart.append(abs(math.log(mine.estimate.value / theirs)) / error)
        assert mine.estimate.low < theirs < mine.estimate.high * 1.1
    print(
        f"statsmodels, probit: Weber fractions differ by {np.median(apart):.2f} of their standard "
        f"error in the middle, {max(apart):.2f} at most"
    )
    assert np.median(apart) < 0.5


def answered_as_one(main):  # type: ignore[no-untyped-def]
    """Everybody's trials as one person's."""
    return dataclasses.replace(main, people=("all",), participant=np.zeros_like(main.participant))


@pytest.mark.slow
# It says so where the spread over people of the slope is next to none.
@pytest.mark.filterwarnings("ignore::UserWarning")
@FEW
def test_exponents_agree_with_a_linear_mixed_model(seeds: range) -> None:
    pandas = pytest.importorskip("pandas")
    formula = pytest.importorskip("statsmodels.formula.api")
    worst, ratios = 0.0, []
    for seed in seeds:
        random = np.random.default_rng([6, seed])
        main = answered(DESIGNS["magnitude"], [somebody(random) for _ in range(10)], random).main(0)
        _, pooled, _ = exponents(main, 0.95)
        assert pooled is not None
        data = pandas.DataFrame(
            {
                "y": np.log(main.estimate),
                "x": np.log(main.values[main.presented[0]]),
                "who": main.participant,
            }
        )
        data["x"] -= data["x"].mean()
        model = formula.mixedlm("y ~ x", data, groups="who", re_formula="~x").fit(reml=True)
        theirs, error = model.params["x"], model.bse["x"]
        half = 0.5 * (pooled.high - pooled.low)
        worst = max(worst, abs(pooled.value - theirs))
        # Ours is Student's t of 9 degrees of freedom over people.
        if model.converged:
            ratios.append(half / 2.262 / error)
    print(
        f"statsmodels, mixed model: exponents differ by {worst:.1e}; our standard errors are "
        f"{min(ratios):.2f} to {max(ratios):.2f} of its, {np.median(ratios):.3f} in the middle"
    )
    # People have judged the same stimuli equally often: the two are the same estimate.
    assert worst < 1e-4
    assert np.median(ratios) == pytest.approx(1.0, abs=0.05)
