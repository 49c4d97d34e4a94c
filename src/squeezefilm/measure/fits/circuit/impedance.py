"""From an impedance sweep to resonances, coupling and a circuit of one or more branches."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated

import numpy as np
from scipy import optimize

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.measure.fits.circuit.branches import (
    Layout,
    circuit_curve,
    poles,
    relative_motion,
    start_at,
)
from squeezefilm.measure.fits.complex_fit import ComplexFit, fit_complex, sweep_adequacy
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, Observation
from squeezefilm.measure.fits.sweep_reading import require_passive
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.physics.plate.circuit import EquivalentCircuit

MOST_BRANCHES = 8
# So many richer circuits in a row that are no better, and no more are tried: two modes of five that
# are told only together take three steps.
_PATIENCE = 6
# A branch that is flatter than this is no resonance but what a band shows of other things.
_LEAST_QUALITY = 4.0
_LEAST_RISE = 1e-3
# A further branch must lower the Bayesian information criterion by this: "very strong" evidence
# (Kass and Raftery 1995, 10.1080/01621459.1995.10476572), and take a fifth of what was left.
_EVIDENCE, _LESS_LEFT = 10.0, 0.8
# ... and be told from the others: to that standard error of ln Q and ln C.
_TOLD_APART = 0.35


# What may stand beside the branches.
_CORRECTIONS = ("coupling_loss", "leads", "drift")
_WORDS = {"coupling_loss": "a loss of the coupling", "leads": "leads in series",
          "drift": "a drift of the analyser"}  # fmt: skip
_Fitted = tuple[ComplexFit, Layout]


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
class Softening:
    """What a body does when it moves farther, from rest to the largest motion of a sweep at one
    voltage: by which share its resonance falls, and by which share its loss 1/Q is larger."""

    frequency_fall: Estimate
    loss_rise: Estimate


@dataclass(frozen=True, eq=False)
class ImpedanceFit:
    """A circuit fitted to a sweep: `static_capacitance` C0 (F) with its `loss_tangent`, and
    `branches` rising in frequency, of which `main` is the number of the strongest.

    `coupling_loss` is the loss tangent θ of the piezoelectric coupling itself (motional currents
    are turned by (1 − iθ)²), None where the sweep does not ask for one. With `softening`, found in
    the same way, the branch is that of the largest motion in the sweep; None for a body that is
    linear as far as the sweep tells. `motion` (points,) at `frequency` (Hz) is relative to the
    largest. `drift` is the change of the analyser's complex gain from the first to the last point
    where it was fitted too. `layout` and `fit` are what was fitted, for `admittance`.
    """

    static_capacitance: Estimate
    loss_tangent: Estimate
    branches: tuple[Branch, ...]
    main: int
    coupling_loss: Estimate | None
    softening: Softening | None
    drift: complex | None
    adequacy: Adequacy
    layout: Layout
    fit: ComplexFit
    frequency: si.HertzArray
    motion: si.DimensionlessArray

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
        """The circuit's admittance (S) at frequencies (Hz), without the analyser's drift; one that
        softens moves as it did in the sweep."""
        layout = replace(self.layout, drift=False)
        motion = np.interp(frequency, self.frequency, self.motion)
        return circuit_curve(layout, self.fit.parameters[: layout.size], frequency, motion)[0]

    @property
    def observations(self) -> tuple[Observation, ...]:
        """What a calibration may use of the strongest branch; the coupling follows from the two
        resonances and would count them twice. Nothing of one whose Q has no bounds."""
        branch = self.strongest
        if not branch.quality_factor.standard_error < branch.quality_factor.value / 2:
            return ()
        return tuple(
            Observation(answer, estimate.value, estimate.standard_error)
            for answer, estimate in (
                ("resonance_frequency", branch.series_resonance),
                ("parallel_resonance_frequency", branch.parallel_resonance),
                ("quality_factor", branch.quality_factor),
                ("static_capacitance", self.static_capacitance),
            )
        )


def fit_impedance(
    sweep: ImpedanceSweep, *, branches: int | None = None, drift: bool = False
) -> ImpedanceFit:
    """Fit a circuit of Butterworth and Van Dyke, with as many `branches` as the sweep asks for.

    Without `branches`: one more as long as what is left is smoother than noise and the Bayesian
    information criterion falls by more than 10, at most 8. In the same way are asked for: a
    loss of the coupling itself, leads in series, a drift of the complex gain in proportion to
    the point's number, and after them a branch that softens and loses more the farther it
    moves, by the square of its motion (for a sweep at one voltage). `drift`, or a sweep that is
    not `compensated`, has drift or leads for certain; a compensated one has no leads. Where the
    sweep does not tell one of the three from another, intervals hold what each makes of it, and
    the adequacy says so. A resonance that drifts during the sweep cannot be told from another
    Q. Noise is relative, down to a floor where the data tell of one, and estimated from them;
    missing points do no harm. Intervals are of 95 %, to first order in the noise; where the
    circuit misses something they are widened by how alike neighbouring residuals are, which is
    no bound. Raises `InputError` for a sweep that no passive capacitive body has (a phase that
    is off by 180° or has the wrong sign), that holds no resonance, or is too short.
    """
    require_passive(sweep)
    if branches is not None:
        si.require("branches", branches, at_least=1, at_most=MOST_BRANCHES)
    (fit, layout), rivals = _settled(sweep, _chosen(sweep, branches, drift), drift)
    told = _told(sweep, fit, layout)
    for rival in rivals:
        told = _holding(told, _told(sweep, *rival))
    return _alike(told, rivals[0][1]) if rivals else told


def _holding(told: ImpedanceFit, rival: ImpedanceFit) -> ImpedanceFit:
    """The same with intervals that hold what a circuit says that describes the sweep as well."""
    pairs = zip(told.branches, rival.branches, strict=True)
    branches = tuple(
        Branch(**{
            part.name: _wider(getattr(ours, part.name), getattr(theirs, part.name))
            for part in fields(Branch)
        })
        for ours, theirs in pairs
    )  # fmt: skip
    return replace(
        told,
        branches=branches,
        static_capacitance=_wider(told.static_capacitance, rival.static_capacitance),
    )


def _alike(told: ImpedanceFit, rival: Layout) -> ImpedanceFit:
    """The same, and its adequacy names the corrections that the sweep does not tell apart."""
    either = told.layout, rival
    found = [name for name in _CORRECTIONS if any(getattr(layout, name) for layout in either)]
    names = " and ".join(_WORDS[name] for name in found)
    said = (
        f"{told.adequacy.sentence} {names.capitalize()} describe this sweep alike: intervals hold "
        "what either makes of it. Write compensated = true if leads were compensated, or false if "
        "they were not."
    )
    return replace(told, adequacy=replace(told.adequacy, sentence=said))


def _wider(ours: Estimate, theirs: Estimate) -> Estimate:
    """An estimate under two circuits that are as likely: each with half of the weight."""
    error = math.hypot(ours.standard_error, (theirs.value - ours.value) / math.sqrt(2))
    more = error / ours.standard_error if ours.standard_error > 0 else 1.0
    low, high = (ours.value + more * (end - ours.value) for end in ours.interval)
    return replace(ours, standard_error=error, interval=(low, high))


def _chosen(sweep: ImpedanceSweep, branches: int | None, drift: bool) -> _Fitted:
    """The fit of as many branches as were asked for, or as the sweep asks for."""
    counts = range(1, MOST_BRANCHES + 1) if branches is None else (branches,)
    best: _Fitted | None = None
    since = 0
    for count in counts:
        for step in _layouts(count, _corrections(sweep, drift)):
            if best is not None and (best[0].correlation == 1.0 or since == _PATIENCE):
                return best
            tried = [_fitted(sweep, layout) for layout in step] + [_one_more(sweep, step[0], best)]
            told = [one for one in tried if one is not None and (not best or _better(one, best))]
            if told:
                best, since = min(told, key=_criterion), 0
            else:
                since += 1
    if best is None:
        raise _no_resonance(sweep, branches or 1)
    return best


def _corrections(sweep: ImpedanceSweep, drift: bool) -> tuple[frozenset[str], ...]:
    """What may stand beside the branches, the plainer first: what was told stands in all."""
    told = {"drift"} if drift else set()
    told |= {"leads"} if sweep.compensated is False else set()
    free = [one for one in _CORRECTIONS if one not in told]
    if sweep.compensated:
        free.remove("leads")
    return tuple(
        frozenset(told | set(one))
        for size in range(3)
        for one in itertools.combinations(free, size)
    )


def _layouts(count: int, corrections: Sequence[frozenset[str]]) -> Iterator[tuple[Layout, ...]]:
    """Circuits of that many branches, the plainer first, those of one step beside each other; only
    one branch can soften."""
    made = [Layout(count, **dict.fromkeys(one, True)) for one in corrections]
    for _, step in itertools.groupby(made, _corrected):
        yield tuple(step)
    if count == 1:
        yield (replace(made[0], coupling_loss=True, softening=True),)


def _corrected(layout: Layout) -> int:
    """How many corrections a circuit has."""
    return sum(getattr(layout, one) for one in _CORRECTIONS)


def _settled(sweep: ImpedanceSweep, best: _Fitted, drift: bool) -> tuple[_Fitted, list[_Fitted]]:
    """The fit with the corrections that are told, though what is left looked like noise (leads far
    too small to be seen there move Q by more than its interval); and its rivals: as many
    corrections of another kind, which the sweep does not tell from them."""
    if best[1].softening:
        return best, []
    corrected = _corrected(best[1])
    tried = [
        _fitted(sweep, layout)
        for step in _layouts(best[1].branches, _corrections(sweep, drift))
        for layout in step
        if corrected <= _corrected(layout) <= corrected + 1
        and (not layout.softening or best[0].correlation > 1.0)
    ]
    fits = [one for one in tried if one is not None]
    least = min(fits, key=_criterion, default=best)
    best = least if _criterion(least) < _criterion(best) - _EVIDENCE else best
    return best, [
        one
        for one in fits
        if one[1] != best[1]
        and _corrected(one[1]) == _corrected(best[1])
        and _deviance(one) < _deviance(best) + _EVIDENCE
    ]


def _deviance(fit: _Fitted) -> float:
    """What a fit leaves: twice the logarithm of a likelihood, but for a constant."""
    return 2 * fit[0].residual.size * math.log(fit[0].left ** 2)


def _criterion(fit: _Fitted) -> float:
    """The Bayesian information criterion of a fit."""
    return _deviance(fit) + fit[1].size * math.log(2 * fit[0].residual.size)


def _better(more: _Fitted, best: _Fitted) -> bool:
    """Whether the richer circuit is asked for by the data, and each of its branches is told."""
    fit, layout = more
    for k in range(layout.branches):
        if np.any(np.sqrt(np.diag(fit.covariance)[layout.branch(k)]) > _TOLD_APART):
            return False
    # Under much noise a neighbour takes less, and leaves nothing but noise.
    explains = fit.left < _LESS_LEFT * best[0].left or fit.correlation == 1.0
    return _criterion(best) - _criterion(more) > _EVIDENCE and explains


def _no_resonance(sweep: ImpedanceSweep, branches: int) -> InputError:
    f = sweep.frequency
    wanted = "a resonance" if branches == 1 else f"{branches} resonances"
    return InputError(
        f"{wanted} could not be found between {f[0] / 1e3:.5g} and {f[-1] / 1e3:.5g} kHz; give a "
        "sweep that holds the conductance's maximum and the parallel resonance above it, with "
        "some points within the maximum's width",
        quantity="admittance",
    )


def _one_more(sweep: ImpedanceSweep, layout: Layout, best: _Fitted | None) -> _Fitted | None:
    """A branch more than the best fit has, where that leaves most: poles of all the sweep do not
    find a small one under noise."""
    if best is None or layout.branches != best[1].branches + 1:
        return None
    rows = [best[0].parameters[best[1].branch(k)] for k in range(best[1].branches)]
    own, quality = np.exp(np.array(rows)[:, :2]).T
    width = max(sweep.frequency.size // 16, 3)
    left = np.convolve(best[0].residual.real, np.ones(width) / width, mode="same")
    there = float(sweep.frequency[int(np.argmax(left))])
    more = np.append(own, there), np.append(quality, float(np.median(quality)))
    order = np.argsort(more[0])
    return _fitted(sweep, layout, more[0][order], more[1][order])


def _fitted(
    sweep: ImpedanceSweep,
    layout: Layout,
    own: si.HertzArray | None = None,
    quality: si.DimensionlessArray | None = None,
) -> _Fitted | None:
    """The fit of a layout, branches rising in frequency, from frequencies (Hz) and Q of branches or
    from the poles of the sweep; None where there are not so many."""
    f, y, count = sweep.frequency, sweep.admittance, layout.branches
    if 2 * y.size < layout.size + 8:
        return None
    if own is None:
        own, quality = _starts(f, y, count)
    if own is None or quality is None:
        return None
    start = start_at(layout, f, y, own, quality)
    motion = _motion(sweep, start)
    try:
        fit = fit_complex(lambda p: circuit_curve(layout, p, f, motion), start, y)
    except ConvergenceError:
        return None
    logs = np.array([fit.parameters[layout.branch(k)] for k in range(count)])
    frequency, quality = np.exp(np.clip(logs[:, :2], -30, 30)).T
    inside = (frequency > f[0]) & (frequency < f[-1])
    # Narrower than the points are apart is no resonance that these points can tell.
    step = np.interp(frequency, f, np.gradient(f))
    sharp = (quality > _LEAST_QUALITY) & (frequency / quality > step)
    # How far the branch rises above the static capacitance, at its resonance.
    strong = quality * np.exp(np.clip(logs[:, 2] - fit.parameters[0], -60, 30)) > _LEAST_RISE
    if not np.all(inside & sharp & strong) or not np.all(np.diag(fit.covariance) > 0):
        return None
    if layout.leads:
        ohms, henries = fit.parameters[layout.lead :][:2]
        # A coil within the sweep's own reactance; leads give no power.
        error = math.sqrt(fit.covariance[layout.lead, layout.lead])
        least = float(np.min(np.abs(1 / y)))
        if ohms < -2 * error or ohms > least or 2 * math.pi * f[-1] * abs(henries) > 10 * least:
            return None
    # Softer by a third is no correction of a linear circuit any more.
    if layout.softening and np.any(np.abs(fit.parameters[layout.soft :][:2]) > [0.3, 0.95]):
        return None
    return _in_order(fit, layout, frequency), layout


def _motion(sweep: ImpedanceSweep, p: si.FloatArray) -> si.DimensionlessArray:
    """The motion at each point over the largest, with the static branch of parameters `p`."""
    held = 2j * np.pi * sweep.frequency * math.exp(p[0]) * (1 - 1j * p[1])
    return relative_motion(held, sweep.frequency, sweep.admittance)


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
    return replace(
        fit,
        parameters=fit.parameters[order],
        covariance=fit.covariance[both],
        information=fit.information[both],
    )


def _told(sweep: ImpedanceSweep, fit: ComplexFit, layout: Layout) -> ImpedanceFit:
    p = fit.parameters
    capacitances = [p[layout.branch(k)][2] for k in range(layout.branches)]
    what = f"The circuit of {layout.branches} branches"
    if layout.branches == 1:
        what = f"The circuit of one branch{' that softens' if layout.softening else ''}"
    return ImpedanceFit(
        static_capacitance=fit.estimate(lambda p: math.exp(p[0]), "F"),
        loss_tangent=fit.estimate(lambda p: float(p[1]), "1"),
        branches=tuple(_branch(fit, layout, k) for k in range(layout.branches)),
        main=int(np.argmax(capacitances)),
        coupling_loss=(
            fit.estimate(lambda p: float(p[layout.loss]), "1") if layout.coupling_loss else None
        ),
        softening=_softening(fit, layout) if layout.softening else None,
        drift=complex(p[-2], p[-1]) if layout.drift else None,
        adequacy=sweep_adequacy(fit, sweep.frequency, what),
        layout=layout,
        fit=fit,
        frequency=sweep.frequency,
        motion=_motion(sweep, p),
    )


def _softening(fit: ComplexFit, layout: Layout) -> Softening:
    g, h = layout.soft, layout.soft + 1
    return Softening(
        frequency_fall=fit.estimate(lambda p: 1 - 1 / math.sqrt(1 + float(p[g])), "1"),
        loss_rise=fit.estimate(lambda p: 1 / (1 - float(p[h])) - 1, "1"),
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
    one branch fs √(1 + C1/C0). There one that softens is nearly at rest, and as stiff as that."""
    at = [layout.branch(j) for j in range(layout.branches)]
    squares = np.exp([2 * p[j][0] for j in at])
    weights = np.exp([p[j][2] - p[0] for j in at])
    own = float(squares[k])
    if layout.branches == 1:
        stiffer = float(p[layout.soft]) if layout.softening else 0.0
        return math.sqrt(own * (1 + stiffer + float(weights[0])))

    def susceptance(square: float) -> float:
        return float(1 + np.sum(weights * squares / (squares - square)))

    above = squares[squares > own]
    highest = own * (1 + float(np.sum(weights))) * float(np.max(squares)) / own
    top = float(above.min()) * (1 - 1e-12) if above.size else highest * (1 + 1e-9)
    root = optimize.brentq(susceptance, own * (1 + 1e-12), top, xtol=1e-9 * own, rtol=1e-13)
    return math.sqrt(float(root))
