"""# A threshold of friction

The least drop of friction that a (simulated) person tells from none, in two intervals.
"""

from statistics import NormalDist

import numpy as np

import squeezefilm as sf


def main() -> dict[str, float]:
    # Relative drops of friction from 1 to 60 %; the axis is logarithmic.
    drops = tuple(np.geomspace(0.01, 0.6, 25))
    prior = sf.PsychometricPrior(threshold=(0.01, 0.5), width=(0.2, 4.0))
    design = sf.AdaptiveDesign(drops, prior, shape="weibull", axis="log", most_trials=150)

    # Who answers: half way from chance to the best at a drop of 11 %, 2 % lapses (assumed).
    person = sf.PsychometricFunction("weibull", 0.11, 1.2, 0.5, 0.02, "log")
    chance = np.random.default_rng(7)

    method = sf.BayesianAdaptive(design)
    while not method.finished:
        drop = method.next_stimulus()
        method.update(drop, bool(chance.random() < person(drop)))
        if len(method.trials) == 75:  # stopped and resumed: the answers are played again
            answered, method = method.trials, sf.BayesianAdaptive(design)
            for trial in answered:
                method.update(trial.intensity, trial.positive)

    fit = sf.fit_psychometric(
        [trial.intensity for trial in method.trials],
        [trial.positive for trial in method.trials],
        shape="weibull",
        axis="log",
        prior=prior,
    )
    threshold = fit.function.threshold
    low, high = fit.posterior_interval["threshold"]
    print(f"threshold {threshold:.3f} ({low:.3f} to {high:.3f})")
    for note in fit.notes:
        print(f"note: {note}")
    d_prime = 2**0.5 * NormalDist().inv_cdf(float(fit.function(threshold)))
    print(f"d' at the threshold is {d_prime:.2f}")
    sf.plot(fit).savefig("friction_threshold.png")
    return {"threshold": threshold, "low": low, "high": high, "d_prime": d_prime}


if __name__ == "__main__":
    main()
