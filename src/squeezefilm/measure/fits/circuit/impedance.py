"""Fit of an impedance sweep by resonances, coupling and a circuit of one or more branches."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Annotated

import numpy as np
from scipy import optimize

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.circuit.branches import Layout, circuit_curve
from squeezefilm.measure.fits.circuit.choice import (
    CORRECTIONS,
    MOST_BRANCHES,
    chosen_circuit,
    sweep_motion,
)
from squeezefilm.measure.fits.complex_fit import ComplexFit, require_passive, sweep_adequacy
from squeezefilm.measure.fits.estimate import (
    Estimate,
    FitResult,
    Observation,
    observed,
)
from squeezefilm.measure.recordings.kinds import ImpedanceSweep

_WORDS = {
    "coupling_loss": "a loss of the coupling",
    "leads": "leads in series",
    "drift": "a drift of the analyser",
}


@dataclass(frozen=True)
class Branch:
    """A motional branch: its series resonance (Hz), Q, and R (Ω), L (H), C (F), and the parallel
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
    """Change of a body that moves farther, from rest to the largest motion of a sweep at one
    voltage: by which share its resonance falls, and by which share its loss 1/Q is larger."""

    frequency_fall: Estimate
    loss_rise: Estimate


@dataclass(frozen=True, eq=False, repr=False)
class ImpedanceFit(FitResult):
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
    layout: Layout
    fit: ComplexFit
    frequency: si.HertzArray
    motion: si.DimensionlessArray

    @property
    def strongest(self) -> Branch:
        """The branch with the largest motional capacitance."""
        return self.branches[self.main]

    @si.checked_numbers
    def admittance(self, frequency: Annotated[si.HertzArray, si.Above(0.0)]) -> si.ComplexArray:
        """The circuit's admittance (S) at frequencies (Hz), without the analyser's drift; one that
        softens moves as it did in the sweep."""
        layout = replace(self.layout, drift=False)
        motion = np.interp(frequency, self.frequency, self.motion)
        return circuit_curve(layout, self.fit.parameters[: layout.size], frequency, motion)[0]

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Observations of the strongest branch; the coupling follows from the two
        resonances and would count them twice. Nothing of one whose Q has no bounds."""
        branch = self.strongest
        if not branch.quality_factor.standard_error < branch.quality_factor.value / 2:
            return ()
        return observed(
            {},
            resonance_frequency=branch.series_resonance,
            parallel_resonance_frequency=branch.parallel_resonance,
            quality_factor=branch.quality_factor,
            static_capacitance=self.static_capacitance,
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
    Q. Where no phase was recorded the circuit's size is fitted, without corrections but leads that
    were not compensated; its `loss_tangent` is then less by twice that of the coupling.

    Noise is relative, down to a floor where the data tell of one, and estimated from them;
    missing points do no harm. Intervals are of 95 %, to first order in the noise; where the
    circuit misses something they are widened by how alike neighbouring residuals are, which is
    no bound. Raises `InputError` for a sweep that no passive capacitive body has (a phase that
    is off by 180° or has the wrong sign), that holds no resonance, or is too short.
    """
    require_passive(sweep)
    if drift and not sweep.phase_recorded:
        raise InputError(
            "sizes alone do not tell a drift of the analyser's complex gain; record the phase too, "
            "or fit without drift",
            quantity="drift",
        )
    if branches is not None:
        si.require("branches", branches, at_least=1, at_most=MOST_BRANCHES)
    (fit, layout), rivals = chosen_circuit(sweep, branches, drift)
    told = _told(sweep, fit, layout)
    for rival in rivals:
        told = _holding(told, _told(sweep, *rival))
    return _alike(told, rivals[0][1]) if rivals else told


def _holding(told: ImpedanceFit, rival: ImpedanceFit) -> ImpedanceFit:
    """The same with intervals that hold what a circuit says that describes the sweep as well."""
    pairs = zip(told.branches, rival.branches, strict=True)
    branches = tuple(
        Branch(
            **{
                part.name: _wider(getattr(ours, part.name), getattr(theirs, part.name))
                for part in fields(Branch)
            }
        )
        for ours, theirs in pairs
    )
    return replace(
        told,
        branches=branches,
        static_capacitance=_wider(told.static_capacitance, rival.static_capacitance),
    )


def _alike(told: ImpedanceFit, rival: Layout) -> ImpedanceFit:
    """The same, and its adequacy names the corrections that the sweep does not tell apart."""
    either = told.layout, rival
    corrections = [name for name in CORRECTIONS if any(getattr(layout, name) for layout in either)]
    names = " and ".join(_WORDS[name] for name in corrections)
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


def _told(sweep: ImpedanceSweep, fit: ComplexFit, layout: Layout) -> ImpedanceFit:
    p = fit.parameters
    capacitances = [p[layout.branch(k)][2] for k in range(layout.branches)]
    what = f"The circuit of {layout.branches} branches"
    if layout.branches == 1:
        what = f"The circuit of one branch{' that softens' if layout.softening else ''}"
    g, h = layout.soft, layout.soft + 1
    softening = (
        Softening(
            frequency_fall=fit.estimate(lambda p: 1 - 1 / math.sqrt(1 + float(p[g])), "1"),
            loss_rise=fit.estimate(lambda p: 1 / (1 - float(p[h])) - 1, "1"),
        )
        if layout.softening
        else None
    )
    return ImpedanceFit(
        static_capacitance=fit.estimate(lambda p: math.exp(p[0]), "F"),
        loss_tangent=fit.estimate(lambda p: float(p[1]), "1"),
        branches=tuple(_branch(fit, layout, k) for k in range(layout.branches)),
        main=int(np.argmax(capacitances)),
        coupling_loss=(
            fit.estimate(lambda p: float(p[layout.loss]), "1") if layout.coupling_loss else None
        ),
        softening=softening,
        drift=complex(p[-2], p[-1]) if layout.drift else None,
        adequacy=sweep_adequacy(fit, sweep.frequency, what),
        layout=layout,
        fit=fit,
        frequency=sweep.frequency,
        motion=sweep_motion(sweep, p),
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
    """Frequency at which the susceptance of the circuit without its losses vanishes above branch k
    (Hz): with one branch fs √(1 + C1/C0). There one that softens is nearly at rest, and as stiff as
    that."""
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
