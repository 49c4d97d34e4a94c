"""Circuits of several branches: their admittance with all derivatives, and starts for a fit.

Y = (1 + a s) [iω C0 (1 − i tan δ) + (1 − iθ)² Σ iω C_k / (1 − (f/f_k)² + i f/(f_k Q_k))], with s
from −½ to ½ along the sweep. A branch is the R, L, C of Butterworth and Van Dyke: C_k = C,
f_k = 1/(2π √(LC)), Q_k = √(L/C)/R. Leads in series with all of it, of resistance R_l and inductance
L_l, make it Y/(1 + Y (R_l + iω L_l)). Beyond their circuit, and 0 unless fitted: θ, the loss of the
piezoelectric coupling itself (a complex charge coefficient, which turns the circle of the
admittance); a, complex, a drift of the analyser's gain; and softening, by which f_k and Q_k are
those at the largest motion of the sweep, u = 1, while at less motion the stiffness is larger by
the share g (1 − u²) and the loss 1/Q_k smaller by h (1 − u²).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.polynomial import chebyshev, polyutils

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

_SANATHANAN_KOERNER = 12
_LARGEST = np.array([30.0, 30.0, 0.0])


@dataclass(frozen=True)
class Layout:
    """Order of the parameters: ln C0 and tan δ, then ln f, ln Q, ln C of each branch, then
    the coupling's loss, g and h of softening, R_l (Ω) and L_l (H) of leads, real and imaginary part
    of a drift."""

    branches: int
    coupling_loss: bool = False
    softening: bool = False
    leads: bool = False
    drift: bool = False

    @property
    def size(self) -> int:
        """Number of parameters."""
        return self.lead + 2 * self.leads + 2 * self.drift

    @property
    def loss(self) -> int:
        """Index of the coupling's loss, if it is fitted."""
        return 2 + 3 * self.branches

    @property
    def soft(self) -> int:
        """Index of g and h of softening, if it is fitted."""
        return self.loss + self.coupling_loss

    @property
    def lead(self) -> int:
        """Index of the leads' resistance and inductance, if they are fitted."""
        return self.soft + 2 * self.softening

    def branch(self, k: int) -> slice:
        """Indices of ln f, ln Q and ln C of branch k."""
        return slice(2 + 3 * k, 5 + 3 * k)


def circuit_curve(
    layout: Layout,
    p: si.FloatArray,
    frequency: si.HertzArray,
    motion: si.DimensionlessArray | None = None,
) -> tuple[si.ComplexArray, si.ComplexArray]:
    """The admittance (points,) and its derivatives (parameters, points) at parameters `p`.

    `motion` (points,), from 0 to 1, is that of a layout with softening at these frequencies.
    """
    omega = 2 * np.pi * frequency
    stiller = np.zeros(frequency.size) if motion is None else 1 - motion**2
    stiffer, sharper = p[layout.soft : layout.soft + 2] if layout.softening else (0.0, 0.0)
    slopes = np.zeros((layout.size, frequency.size), dtype=complex)
    static = np.exp(min(p[0], 0.0))
    slopes[0] = 1j * omega * static * (1 - 1j * p[1])
    slopes[1] = omega * static
    loss = p[layout.loss] if layout.coupling_loss else 0.0
    turn = (1 - 1j * loss) ** 2
    total = slopes[0].copy()
    for k in range(layout.branches):
        # A fit on its way may try anything; what it may end at is far inside of these.
        log_frequency, log_quality, log_capacitance = np.clip(p[layout.branch(k)], -60, _LARGEST)
        ratio = frequency * np.exp(-log_frequency)
        full = 1j * ratio * np.exp(-log_quality)
        lag = full * (1 - sharper * stiller)
        below = 1 - ratio**2 + lag + stiffer * stiller
        term = turn * 1j * omega * np.exp(log_capacitance) / below
        total += term
        first = 2 + 3 * k
        slopes[first] = -term / below * (2 * ratio**2 - lag)
        slopes[first + 1] = term / below * lag
        slopes[first + 2] = term
        if layout.softening:
            slopes[layout.soft] -= term / below * stiller
            slopes[layout.soft + 1] += term / below * full * stiller
    if layout.coupling_loss:
        slopes[layout.loss] = (total - slopes[0]) * -2j / (1 - 1j * loss)
    if layout.leads:
        through = 1 / (1 + total * (p[layout.lead] + 1j * omega * p[layout.lead + 1]))
        slopes *= through**2
        slopes[layout.lead] = -((total * through) ** 2)
        slopes[layout.lead + 1] = 1j * omega * slopes[layout.lead]
        total = total * through
    if layout.drift:
        place = np.linspace(-0.5, 0.5, frequency.size)
        gain = 1 + complex(p[-2], p[-1]) * place
        slopes[:-2] *= gain
        slopes[-2], slopes[-1] = total * place, 1j * total * place
        total = total * gain
    return total, slopes


def relative_motion(
    static: si.ComplexArray, frequency: si.HertzArray, admittance: si.ComplexArray
) -> si.DimensionlessArray:
    """Motion of a body at each frequency under one voltage, over the farthest (points,): the
    motional current by its frequency. `static` is the admittance of the held body."""
    size = np.abs(admittance - static) / frequency
    return np.asarray(size / size.max())


@si.checked_numbers
def poles(
    frequency: si.HertzArray, response: si.ComplexArray, count: Annotated[int, si.AtLeast(1)]
) -> tuple[si.HertzArray, si.DimensionlessArray]:
    """Frequencies (Hz) and Q of `count` poles by linear least squares of a rational function,
    iterated (Sanathanan and Koerner 1963, 10.1109/TAC.1963.1105517), rising in frequency.

    Numerator and denominator are Chebyshev series over the band; the numerator has one degree more,
    for a capacitance. Poles at negative frequency are far away and part of that. For sweeps
    whose band is not wider than some octaves. A Q that is not positive says that there is no
    such pole. Raises `InputError` for series that are not alike, no band of frequencies, or a
    response of zero.
    """
    si.require_alike(frequency=frequency, response=response)
    if frequency[-1] == frequency[0]:
        raise InputError("the frequencies must span a band", quantity="frequency")
    if not np.all(response):
        raise InputError("a response of exactly zero has no phase", quantity="response")
    ends = polyutils.getdomain(frequency)
    x = polyutils.mapdomain(frequency, ends, chebyshev.chebdomain)
    over = chebyshev.chebvander(x, count + 1)
    under = chebyshev.chebvander(x, count)
    weight = 1 / np.abs(response)
    bottom = np.ones(x.size, dtype=complex)
    coefficients = np.zeros(count + 1, dtype=complex)
    for _ in range(_SANATHANAN_KOERNER):
        scale = (weight / np.abs(bottom))[:, None]
        rows = np.hstack([over, -response[:, None] * under[:, :-1]]) * scale
        answer = np.linalg.lstsq(rows, response * under[:, -1] * scale[:, 0], rcond=None)[0]
        coefficients = np.append(answer[count + 2 :], 1.0)
        bottom = under @ coefficients
        # A pole right on the axis would weigh its neighbours without bound.
        bottom = np.where(np.abs(bottom) < 1e-9, 1e-9, bottom)
    unit = chebyshev.chebroots(coefficients)
    roots = np.asarray(polyutils.mapdomain(unit, chebyshev.chebdomain, ends), dtype=complex)
    roots = roots[np.argsort(roots.real)]
    imaginary = np.where(roots.imag == 0, 1e-30, roots.imag)
    return roots.real, roots.real / (2 * imaginary)


def start_at(
    layout: Layout,
    frequency: si.HertzArray,
    admittance: si.ComplexArray,
    own: si.HertzArray,
    quality: si.DimensionlessArray,
) -> si.FloatArray:
    """Parameters to start from, with branches at frequencies `own` of these Q: capacitances by
    linear least squares, kept positive."""
    omega = 2 * np.pi * frequency
    shapes = [1j * omega, omega.astype(complex)]
    for f, q in zip(own, quality, strict=True):
        shapes.append(1j * omega / (1 - (frequency / f) ** 2 + 1j * frequency / (f * q)))
    columns = np.array(shapes) / np.abs(admittance)
    rows = np.concatenate([columns.real, columns.imag], axis=1).T
    data = admittance / np.abs(admittance)
    size = np.linalg.norm(rows, axis=0)
    answer = np.linalg.lstsq(rows / size, np.concatenate([data.real, data.imag]), rcond=None)[0]
    answer = answer / size
    typical = float(np.median(np.abs(admittance) / omega))
    static = max(answer[0], 0.05 * typical)
    p = np.zeros(layout.size)
    p[:2] = np.log(static), np.clip(answer[1] / static, -0.05, 0.3)
    for k in range(layout.branches):
        branch = max(answer[2 + k], 1e-4 * typical)
        p[layout.branch(k)] = np.log(own[k]), np.log(quality[k]), np.log(branch)
    return p
