"""From an impedance sweep to resonances, coupling and a circuit of one or more branches."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from scipy import optimize

from squeezefilm import quantities as si
from squeezefilm.errors import ConvergenceError, InputError
from squeezefilm.measure.fits.branches import Layout, circuit_curve, poles, start_at
from squeezefilm.measure.fits.complex_fit import ComplexFit, adequacy_of, fit_complex
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, Observation
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.plate.circuit import EquivalentCircuit

MOST_BRANCHES = 8
# So many richer circuits in a row that are no better, and no more are tried: two modes of five that
# are told only together take three steps.
_PATIENCE = 6
_FEWEST_POINTS = 16
# A branch that is flatter than this is no resonance but what a band shows of other things.
_LEAST_QUALITY = 4.0
_LEAST_RISE = 1e-3
# A further branch must lower the Bayesian information criterion by this: "very strong" evidence
# (Kass and Raftery 1995, 10.1080/01621459.1995.10476572), and take a fifth of what was left.
_EVIDENCE, _LESS_LEFT = 10.0, 0.8
# ... and be told from the others: to that standard error of ln Q and ln C.
_TOLD_APART = 0.35


@dataclass(frozen=True)
class Branch:
    """One motional branch: its series resonance (Hz), Q, and R (Ω), L (H), C (F), and the parallel
    resonance (Hz) above it with the coupling k = √(1 − fs²/fp²) that goes with the two."""

    series_resonance: Estimate
    parallel_resonance: Estimate
    coupling_coefficient: Estimate
    quality_factor: Estimate
    motional_resistance: Estimate
    motional_inductance: Estimate
    motional_capacitance: Estimate


@dataclass(frozen=True)
class SweepPeaks:
    """What can be read off a sweep without any model: the largest conductance (S) and the largest
    resistance (Ω), the real parts of Y and of 1/Y, and the frequencies (Hz) of both."""

    conductance_frequency: si.Hertz
    conductance: si.Siemens
    resistance_frequency: si.Hertz
    resistance: si.Ohm


@dataclass(frozen=True, eq=False)
class ImpedanceFit:
    """A circuit fitted to a sweep: `static_capacitance` C0 (F) with its `loss_tangent`, and
    `branches` rising in frequency, of which `main` is the number of the strongest.

    `coupling_loss` is the loss tangent θ of the piezoelectric coupling itself (motional currents
    are turned by (1 − iθ)²), None where the sweep does not ask for one. `drift` is the change of
    the analyser's complex gain from the first to the last point where it
    was fitted too. `layout` and `fit` are what was fitted, for `admittance`.
    """

    static_capacitance: Estimate
    loss_tangent: Estimate
    branches: tuple[Branch, ...]
    main: int
    coupling_loss: Estimate | None
    drift: complex | None
    adequacy: Adequacy
    layout: Layout
    fit: ComplexFit

    @property
    def strongest(self) -> Branch:
        """The branch with the largest motional capacitance."""
        return self.branches[self.main]

    @property
    def circuit(self) -> EquivalentCircuit:
        """C0 without its loss, and the strongest branch."""
        branch = self.strongest
        return EquivalentCircuit(
            frequency=branch.series_resonance.value,
            quality_factor=branch.quality_factor.value,
            static_capacitance=self.static_capacitance.value,
            motional_resistance=branch.motional_resistance.value,
            motional_inductance=branch.motional_inductance.value,
            motional_capacitance=branch.motional_capacitance.value,
        )

    @si.checked_numbers
    def admittance(self, frequency: Annotated[si.HertzArray, si.Above(0.0)]) -> si.ComplexArray:
        """The circuit's admittance (S) at frequencies (Hz), without the analyser's drift."""
        layout = replace(self.layout, drift=False)
        return circuit_curve(layout, self.fit.parameters[: layout.size], frequency)[0]

    @property
    def observations(self) -> tuple[Observation, ...]:
        """What a calibration may use of the strongest branch."""
        branch = self.strongest
        return tuple(
            Observation(answer, estimate.value, estimate.standard_error)
            for answer, estimate in (
                ("resonance_frequency", branch.series_resonance),
                ("parallel_resonance_frequency", branch.parallel_resonance),
                ("coupling_coefficient", branch.coupling_coefficient),
                ("quality_factor", branch.quality_factor),
                ("static_capacitance", self.static_capacitance),
            )
        )


def fit_impedance(
    sweep: ImpedanceSweep, *, branches: int | None = None, drift: bool = False
) -> ImpedanceFit:
    """Fit a circuit of Butterworth and Van Dyke, with as many `branches` as the sweep asks for.

    Without `branches`: one more as long as what is left is smoother than noise and the Bayesian
    information criterion falls by more than 10, at most 8; a loss of the coupling itself is asked
    for in the same way. `drift` fits a complex gain that changes
    in proportion to the point's number too; a resonance that drifts during the sweep cannot be
    told from another Q. All points have the same relative noise, which is estimated from the data;
    missing points do no harm. Intervals are of 95 %, to first order in the noise; where the circuit
    misses something they are widened by how alike neighbouring residuals are, which is no bound.
    Raises `InputError` for a sweep that no passive capacitive body has (a phase that is off by 180°
    or has the wrong sign), that holds no resonance, or is too short.
    """
    require_passive(sweep)
    if branches is not None:
        si.require("branches", branches, at_least=1, at_most=MOST_BRANCHES)
    fit, layout = _chosen(sweep, branches, drift)
    return _told(sweep, fit, layout)


def require_passive(sweep: ImpedanceSweep) -> None:
    """Refuse what is no sweep of a passive, capacitive body. Raises `InputError`.

    Off resonance, here the tenth of the points at either end, a body is a capacitor: its
    admittance leads by nearly 90°. Resonances and noise leave a real part that is positive on
    average.
    """
    y, f = sweep.admittance, sweep.frequency
    if y.ndim != 1 or f.shape != y.shape or y.size < _FEWEST_POINTS:
        raise InputError(
            f"the sweep has {y.size} points; a fit needs at least {_FEWEST_POINTS}, on both sides "
            "of a resonance",
            quantity="admittance",
        )
    if not (np.all(np.isfinite(y)) and np.all(np.isfinite(f)) and np.all(y != 0)):
        raise InputError(
            "the sweep has points that are not finite or have no admittance at all; leave them "
            "out, missing points do no harm",
            quantity="admittance",
        )
    if f[0] <= 0 or np.any(np.diff(f) <= 0):
        raise InputError(
            "the frequencies do not rise; sort the points and join those at one frequency",
            quantity="frequency",
        )
    unit = y / np.abs(y)
    rim = max(2, y.size // 10)
    ends = np.concatenate([unit[:rim], unit[-rim:]])
    lead = math.degrees(math.atan2(float(np.median(ends.imag)), float(np.median(ends.real))))
    if float(np.mean(unit.real)) < 0:
        raise InputError(
            f"the sweep gives out power: the real part of its admittance is negative at "
            f"{int(np.sum(y.real < 0))} of {y.size} points, and away from resonance the admittance "
            f"leads by {lead:.0f}° where a capacitor's leads by up to 90°. The phase was probably "
            "recorded with an offset of 180°; look at it, and if so write correct = "
            '"phase 180 deg" in the TOML beside the recording',
            quantity="admittance",
        )
    if lead < 0:
        raise InputError(
            f"away from resonance the admittance leads by {lead:.0f}°, as that of a coil; a "
            "ceramic is a capacitor there and leads by up to 90°. The phase was probably recorded "
            "with the wrong sign, or as that of the admittance; look at it, and if so write "
            'correct = "phase sign" in the TOML beside the recording',
            quantity="admittance",
        )


def sweep_peaks(sweep: ImpedanceSweep) -> SweepPeaks:
    """The largest conductance and resistance, by a parabola through the three highest points of
    the inverse of each, which is one near a resonance. Noise makes them too large by some of it.
    Raises `InputError` as `fit_impedance` does.
    """
    require_passive(sweep)
    at_series = _peak(sweep.frequency, sweep.admittance.real)
    at_parallel = _peak(sweep.frequency, (1 / sweep.admittance).real)
    return SweepPeaks(*at_series, *at_parallel)


def _peak(frequency: si.HertzArray, values: si.FloatArray) -> tuple[float, float]:
    top = int(np.argmax(values))
    near = slice(max(top - 1, 0), top + 2)
    if values[near].size < 3 or np.any(values[near] <= 0):
        return float(frequency[top]), float(values[top])
    x = frequency[near] - frequency[top]
    a, b, c = np.polyfit(x, 1 / values[near], 2)
    if a <= 0 or not x[0] <= -b / (2 * a) <= x[-1]:
        return float(frequency[top]), float(values[top])
    return float(frequency[top] - b / (2 * a)), float(1 / (c - b**2 / (4 * a)))


def _chosen(sweep: ImpedanceSweep, branches: int | None, drift: bool) -> tuple[ComplexFit, Layout]:
    """The fit of as many branches as were asked for, or as the sweep asks for."""
    counts = range(1, MOST_BRANCHES + 1) if branches is None else (branches,)
    best: tuple[ComplexFit, Layout] | None = None
    since = 0
    for count in counts:
        for lossy in (False, True):
            if best is not None and (best[0].correlation == 1.0 or since == _PATIENCE):
                return best
            more = _fitted(sweep, Layout(count, lossy, drift))
            if more is not None and (best is None or _better(more, best)):
                best, since = more, 0
            else:
                since += 1
    if best is None:
        raise _no_resonance(sweep, branches or 1)
    return best


def _better(more: tuple[ComplexFit, Layout], best: tuple[ComplexFit, Layout]) -> bool:
    """Whether the richer circuit is asked for by the data, and each of its branches is told."""
    fit, layout = more
    for k in range(layout.branches):
        if np.any(np.sqrt(np.diag(fit.covariance)[layout.branch(k)]) > _TOLD_APART):
            return False
    rows = 2 * more[0].residual.size
    fall = rows * math.log(best[0].spread ** 2 / more[0].spread ** 2)
    fall -= (more[1].size - best[1].size) * math.log(rows)
    return fall > _EVIDENCE and more[0].spread < _LESS_LEFT * best[0].spread


def _no_resonance(sweep: ImpedanceSweep, branches: int) -> InputError:
    f = sweep.frequency
    wanted = "a resonance" if branches == 1 else f"{branches} resonances"
    return InputError(
        f"{wanted} could not be found between {f[0] / 1e3:.5g} and {f[-1] / 1e3:.5g} kHz; give a "
        "sweep that holds the conductance's maximum and the parallel resonance above it, with "
        "some points within the maximum's width",
        quantity="admittance",
    )


def _fitted(sweep: ImpedanceSweep, layout: Layout) -> tuple[ComplexFit, Layout] | None:
    """The fit of a layout, branches rising in frequency; None where there are not so many."""
    f, y, count = sweep.frequency, sweep.admittance, layout.branches
    if 2 * y.size < layout.size + 8:
        return None
    own, quality = _starts(f, y, count)
    if own is None:
        return None
    try:
        fit = fit_complex(
            lambda p: circuit_curve(layout, p, f), start_at(layout, f, y, own, quality), y
        )
    except ConvergenceError:
        return None
    logs = np.array([fit.parameters[layout.branch(k)] for k in range(count)])
    frequency, quality = np.exp(np.clip(logs[:, :2], -30, 30)).T
    inside = (frequency > f[0]) & (frequency < f[-1])
    # Narrower than the points are apart is no resonance but a point that is off.
    step = np.interp(frequency, f, np.gradient(f))
    sharp = (quality > _LEAST_QUALITY) & (frequency / quality > 0.5 * step)
    # How far the branch rises above the static capacitance, at its resonance.
    strong = quality * np.exp(np.clip(logs[:, 2] - fit.parameters[0], -60, 30)) > _LEAST_RISE
    if not np.all(inside & sharp & strong) or not np.all(np.diag(fit.covariance) > 0):
        return None
    return _in_order(fit, layout, frequency), layout


def _starts(
    f: si.HertzArray, y: si.ComplexArray, count: int
) -> tuple[si.HertzArray | None, si.DimensionlessArray]:
    """Where to begin: poles of a rational function with one or more too many, of which those with
    the strongest residues inside the band are kept."""
    for spare in (0, 1, 2):
        own, quality = poles(f, y, count + spare)
        good = (own > f[0]) & (own < f[-1]) & (quality > _LEAST_QUALITY)
        own, quality = own[good], quality[good]
        if own.size < count:
            continue
        strength = start_at(Layout(own.size), f, y, own, quality)[4::3]
        keep = np.sort(np.argsort(strength)[-count:])
        return own[keep], quality[keep]
    if count == 1:
        peak = int(np.argmax(y.real))
        return f[peak : peak + 1], np.array([30.0])
    return None, np.zeros(0)


def _in_order(fit: ComplexFit, layout: Layout, frequency: si.HertzArray) -> ComplexFit:
    """The same fit with its branches rising in frequency."""
    order = np.arange(layout.size)
    for k, at in enumerate(np.argsort(frequency)):
        order[layout.branch(k)] = np.arange(layout.size)[layout.branch(int(at))]
    both = np.ix_(order, order)
    return ComplexFit(
        fit.parameters[order],
        fit.covariance[both],
        fit.information[both],
        fit.residual,
        fit.noise,
        fit.spread,
        fit.correlation,
        fit.degrees_of_freedom,
    )


def _told(sweep: ImpedanceSweep, fit: ComplexFit, layout: Layout) -> ImpedanceFit:
    p = fit.parameters
    capacitances = [p[layout.branch(k)][2] for k in range(layout.branches)]
    count = f"the circuit of {layout.branches} branches"
    if layout.branches == 1:
        count = "the circuit of one branch"
    return ImpedanceFit(
        static_capacitance=fit.estimate(lambda p: math.exp(p[0]), "F"),
        loss_tangent=fit.estimate(lambda p: float(p[1]), "1"),
        branches=tuple(_branch(fit, layout, k) for k in range(layout.branches)),
        main=int(np.argmax(capacitances)),
        coupling_loss=(
            fit.estimate(lambda p: float(p[layout.loss]), "1") if layout.coupling_loss else None
        ),
        drift=complex(p[-2], p[-1]) if layout.drift else None,
        adequacy=adequacy_of(fit, sweep.frequency, count[0].upper() + count[1:]),
        layout=layout,
        fit=fit,
    )


def _branch(fit: ComplexFit, layout: Layout, k: int) -> Branch:
    at = layout.branch(k)

    def own(p: si.FloatArray) -> tuple[float, float, float]:
        log_frequency, log_quality, log_capacitance = p[at]
        return math.exp(log_frequency), math.exp(log_quality), math.exp(log_capacitance)

    def resistance(p: si.FloatArray) -> float:
        f, quality, capacitance = own(p)
        return 1 / (2 * math.pi * f * capacitance * quality)

    def inductance(p: si.FloatArray) -> float:
        f, _, capacitance = own(p)
        return 1 / ((2 * math.pi * f) ** 2 * capacitance)

    def coupling(p: si.FloatArray) -> float:
        return math.sqrt(1 - (own(p)[0] / parallel_resonance(layout, p, k)) ** 2)

    return Branch(
        series_resonance=fit.estimate(lambda p: own(p)[0], "Hz"),
        parallel_resonance=fit.estimate(lambda p: parallel_resonance(layout, p, k), "Hz"),
        coupling_coefficient=fit.estimate(coupling, "1"),
        quality_factor=fit.estimate(lambda p: own(p)[1], "1"),
        motional_resistance=fit.estimate(resistance, "ohm"),
        motional_inductance=fit.estimate(inductance, "H"),
        motional_capacitance=fit.estimate(lambda p: own(p)[2], "F"),
    )


def parallel_resonance(layout: Layout, p: si.FloatArray, k: int) -> si.Hertz:
    """Where the susceptance of the circuit without its losses vanishes above branch k (Hz): with
    one branch fs √(1 + C1/C0)."""
    at = [layout.branch(j) for j in range(layout.branches)]
    squares = np.exp([2 * p[j][0] for j in at])
    weights = np.exp([p[j][2] - p[0] for j in at])
    own = float(squares[k])
    if layout.branches == 1:
        return math.sqrt(own * (1 + float(weights[0])))

    def susceptance(square: float) -> float:
        return float(1 + np.sum(weights * squares / (squares - square)))

    above = squares[squares > own]
    highest = own * (1 + float(np.sum(weights))) * float(np.max(squares)) / own
    top = float(above.min()) * (1 - 1e-12) if above.size else highest * (1 + 1e-9)
    root = optimize.brentq(susceptance, own * (1 + 1e-12), top, xtol=1e-9 * own, rtol=1e-13)
    return math.sqrt(float(root))
