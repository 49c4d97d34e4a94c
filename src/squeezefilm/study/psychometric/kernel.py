"""The compiled parts of psychometric functions: shapes, likelihood, grids.

A row of parameters θ is threshold m, ln width, lapse rate and guess rate, on the axis on which
the shape is defined (the stimulus or its natural logarithm). A row `beta` holds the two
exponents of the Beta prior of the lapse rate, then those of the guess rate. Priors of the
threshold and of ln width are flat between their bounds.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

LOGISTIC, GAUSSIAN, GUMBEL = range(3)
THRESHOLD, LOG_WIDTH, LAPSE, GUESS = range(4)

# The share of the rise left out on either side of the width.
_TAIL = 0.05
K_LOGISTIC = 2 * math.log(1 / _TAIL - 1)
K_GAUSSIAN = 2 * 1.6448536269514722
K_GUMBEL = math.log(-math.log(_TAIL)) - math.log(-math.log(1 - _TAIL))
LN_LN_2 = math.log(math.log(2.0))
# Probabilities nearer to 0 or 1 than this are not told apart; they occur only where the data
# are impossible under the parameters anyway.
_LEAST = 1e-12


@compiled(error_model="numpy")
def sigmoid(shape: int, z: float) -> tuple[float, float]:
    """S and 1 − S of a shape at z = (x − m)/width; S(0) = ½, from 5 to 95 % over Δz = 1."""
    if shape == 0:
        t = K_LOGISTIC * z
        e = math.exp(-abs(t))
        small, large = e / (1.0 + e), 1.0 / (1.0 + e)
        return (large, small) if t > 0 else (small, large)
    if shape == 1:
        t = K_GAUSSIAN * z
        half = math.sqrt(0.5)
        return 0.5 * math.erfc(-half * t), 0.5 * math.erfc(half * t)
    e = math.exp(min(K_GUMBEL * z + LN_LN_2, 700.0))
    return -math.expm1(-e), math.exp(-e)


@compiled(error_model="numpy")
def probabilities(shape: int, theta: si.FloatArray, x: si.FloatArray) -> si.FloatArray:
    """ψ = γ + (1 − γ − λ) S at the places x, shape of x."""
    out = np.empty(x.size)
    width = math.exp(theta[1])
    for i in range(x.size):
        s, _ = sigmoid(shape, (x[i] - theta[0]) / width)
        out[i] = theta[3] + (1.0 - theta[3] - theta[2]) * s
    return out


@compiled(error_model="numpy")
def log_density(
    shape: int,
    theta: si.FloatArray,
    beta: si.FloatArray,
    x: si.FloatArray,
    k: si.FloatArray,
    n: si.FloatArray,
) -> float:
    """ln likelihood (without binomial coefficients) plus ln prior (not normalised)."""
    width = math.exp(theta[1])
    total = 0.0
    for i in range(x.size):
        s, r = sigmoid(shape, (x[i] - theta[0]) / width)
        rise = 1.0 - theta[3] - theta[2]
        if k[i] > 0:
            total += k[i] * math.log(max(theta[3] + rise * s, _LEAST))
        if n[i] > k[i]:
            total += (n[i] - k[i]) * math.log(max(theta[2] + rise * r, _LEAST))
    for j in range(2):
        a, b, p = beta[2 * j], beta[2 * j + 1], theta[2 + j]
        if a != 1.0:
            total += (a - 1.0) * math.log(max(p, _LEAST))
        if b != 1.0:
            total += (b - 1.0) * math.log(max(1.0 - p, _LEAST))
    return total


@compiled(error_model="numpy")
def grid_log_likelihood(
    shape: int,
    thresholds: si.FloatArray,
    log_widths: si.FloatArray,
    lapses: si.FloatArray,
    guesses: si.FloatArray,
    x: si.FloatArray,
    k: si.FloatArray,
    n: si.FloatArray,
) -> si.FloatArray:
    """ln likelihood at every cell of a grid: (thresholds, widths, lapses, guesses); −inf where
    lapse and guess rate leave no rise."""
    out = np.zeros((thresholds.size, log_widths.size, lapses.size, guesses.size))
    for i in range(thresholds.size):
        for j in range(log_widths.size):
            narrow = math.exp(-log_widths[j])
            for at in range(x.size):
                s, r = sigmoid(shape, (x[at] - thresholds[i]) * narrow)
                right, wrong = k[at], n[at] - k[at]
                for a in range(lapses.size):
                    for b in range(guesses.size):
                        rise = 1.0 - lapses[a] - guesses[b]
                        if rise <= 0.0:
                            out[i, j, a, b] = -math.inf
                            continue
                        if right > 0:
                            out[i, j, a, b] += right * math.log(max(guesses[b] + rise * s, _LEAST))
                        if wrong > 0:
                            out[i, j, a, b] += wrong * math.log(max(lapses[a] + rise * r, _LEAST))
    return out
