"""Choice of a sweep's circuit: how many branches, and which corrections beside."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.measure.fits.circuit.branches import (
    Layout,
    circuit_curve,
    poles,
    relative_motion,
    start_at,
)
from squeezefilm.measure.fits.complex_fit import ComplexFit, fit_complex
from squeezefilm.measure.recordings.kinds import ImpedanceSweep

MOST_BRANCHES = 8
# So many richer circuits in a row that are no better, and no more are tried: two modes of five that
# are told only together take three steps.
_PATIENCE = 6
# A mode whose ln Q is known to no better is none.
_BOUNDED = 0.5
# A branch that is flatter than this is no resonance but what a band shows of other things.
_LEAST_QUALITY = 4.0
_LEAST_RISE = 1e-3
# A further branch must lower the Bayesian information criterion by this: "very strong" evidence
# (Kass and Raftery 1995, 10.1080/01621459.1995.10476572), and take a fifth of what was left.
_EVIDENCE, _LESS_LEFT = 10.0, 0.8
# ... and be told from the others: to that standard error of ln Q and ln C.
_TOLD_APART = 0.35

# Inductance of leads (H): some metres; and their reactance over the sweep's least impedance.
_WIRE, _COIL = 5e-6, 0.5
# Loss of the coupling, either way, and of a capacitance that gives power; usual ones are .02.
_MOST_LOSS = 0.1
# A gain that changes by more from one end of the sweep to the other is no drift.
_MOST_DRIFT = 0.3

CORRECTIONS = ("coupling_loss", "leads", "drift")
"""Corrections that may stand beside the branches."""

Fitted = tuple[ComplexFit, Layout]
_Starts = tuple[si.HertzArray, si.DimensionlessArray]
_Corrections = tuple[frozenset[str], ...]
# The fit of a layout from the poles of a sweep; None where there are not so many.
_Trial = Callable[[Layout], Fitted | None]


def chosen_circuit(
    sweep: ImpedanceSweep, branches: int | None, drift: bool
) -> tuple[Fitted, list[Fitted]]:
    """The fit of as many branches as were asked for, or as the sweep asks for, with the corrections
    that are told; and its rivals: as many corrections of another kind, which the sweep does not
    tell from them. Raises `InputError` for a sweep without a resonance."""
    corrections = _corrections(sweep, drift)
    starts = functools.cache(partial(_starts, sweep.frequency, sweep.admittance))

    @functools.cache
    def trial(layout: Layout) -> Fitted | None:
        start = starts(layout.branches)
        return None if start is None else _fitted(sweep, layout, *start)

    return _settled(trial, corrections, _chosen(sweep, trial, corrections, branches))


def _chosen(
    sweep: ImpedanceSweep, trial: _Trial, corrections: _Corrections, branches: int | None
) -> Fitted:
    """The fit of as many branches as were asked for, or as the sweep asks for."""
    counts = range(1, MOST_BRANCHES + 1) if branches is None else (branches,)
    best: Fitted | None = None
    since = 0
    for count in counts:
        for step in _layouts(count, corrections):
            if best is not None and (best[0].correlation == 1.0 or since == _PATIENCE):
                return best
            tried = [trial(layout) for layout in step]
            tried.append(_one_more(sweep, step[0], best))
            told = [fit for fit in tried if fit is not None and (not best or _better(fit, best))]
            if told:
                best, since = min(told, key=_criterion), 0
            else:
                since += 1
    if best is None:
        f = sweep.frequency
        wanted = f"{branches} resonances" if branches and branches > 1 else "a resonance"
        raise InputError(
            f"{wanted} could not be found between {f[0] / 1e3:.5g} and {f[-1] / 1e3:.5g} kHz; give "
            "a sweep that holds the conductance's maximum and the parallel resonance above it, "
            "with some points within the maximum's width",
            quantity="admittance",
        )
    return best


def _corrections(sweep: ImpedanceSweep, drift: bool) -> _Corrections:
    """Corrections that may stand beside the branches, the plainer first: what was told stands in
    all."""
    told = {"drift"} if drift else set()
    told |= {"leads"} if sweep.compensated is False else set()
    free = [name for name in CORRECTIONS if name not in told]
    if sweep.compensated:
        free.remove("leads")
    if not sweep.phase_recorded:
        # A phase is what tells of these.
        free = []
    return tuple(
        frozenset(told | set(some))
        for size in range(3)
        for some in itertools.combinations(free, size)
    )


def _layouts(count: int, corrections: _Corrections) -> Iterator[tuple[Layout, ...]]:
    """Circuits of that many branches, the plainer first, those of one step beside each other; only
    one branch can soften."""
    made = [Layout(count, **dict.fromkeys(names, True)) for names in corrections]
    for _, step in itertools.groupby(made, _corrected):
        yield tuple(step)
    if count == 1 and any(layout.coupling_loss for layout in made):
        yield (replace(made[0], coupling_loss=True, softening=True),)


def _corrected(layout: Layout) -> int:
    """Number of corrections a circuit has."""
    return sum(getattr(layout, name) for name in CORRECTIONS)


def _settled(trial: _Trial, corrections: _Corrections, best: Fitted) -> tuple[Fitted, list[Fitted]]:
    """The fit with the corrections that are told, though what is left looked like noise (leads far
    too small to be seen there move Q by more than its interval); and its rivals."""
    if best[1].softening:
        return best, []
    corrected = _corrected(best[1])
    tried = [
        trial(layout)
        for step in _layouts(best[1].branches, corrections)
        for layout in step
        if corrected <= _corrected(layout) <= corrected + 1
        and (not layout.softening or best[0].correlation > 1.0)
    ]
    fits = [fit for fit in tried if fit is not None]
    least = min(fits, key=_criterion, default=best)
    best = least if _criterion(least) < _criterion(best) - _EVIDENCE else best
    return best, [
        fit
        for fit in fits
        if fit[1] != best[1]
        and _corrected(fit[1]) == _corrected(best[1])
        and _deviance(fit) < _deviance(best) + _EVIDENCE
    ]


def _deviance(fit: Fitted) -> float:
    """Deviance of a fit: twice the logarithm of a likelihood, but for a constant."""
    return fit[0].numbers * math.log(fit[0].left ** 2)


def _criterion(fit: Fitted) -> float:
    """The Bayesian information criterion of a fit."""
    return _deviance(fit) + fit[1].size * math.log(fit[0].numbers)


def _better(more: Fitted, best: Fitted) -> bool:
    """True where the richer circuit is asked for by the data, and each of its branches is told."""
    fit, layout = more
    for k in range(layout.branches):
        if np.any(np.sqrt(np.diag(fit.covariance)[layout.branch(k)]) > _TOLD_APART):
            return False
    # Under much noise a neighbour takes less, and leaves nothing but noise.
    explains = fit.left < _LESS_LEFT * best[0].left or fit.correlation == 1.0
    return _criterion(best) - _criterion(more) > _EVIDENCE and explains


def _one_more(sweep: ImpedanceSweep, layout: Layout, best: Fitted | None) -> Fitted | None:
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
    own: si.HertzArray,
    quality: si.DimensionlessArray,
) -> Fitted | None:
    """The fit of a layout, branches rising in frequency, from frequencies (Hz) and Q of branches;
    None where it is none."""
    f, y, count = sweep.frequency, sweep.admittance, layout.branches
    start = start_at(layout, f, y, own, quality)
    motion = sweep_motion(sweep, start)

    def circuit(p: si.FloatArray) -> tuple[si.ComplexArray, si.ComplexArray]:
        curve, slopes = circuit_curve(layout, p, f, motion)
        through = 1 / (1 + curve * sweep.in_series)
        return curve * through, slopes * through**2

    try:
        fit = fit_complex(circuit, start, sweep.as_recorded(y))
    except (ConvergenceError, InputError):
        return None
    logs = np.array([fit.parameters[layout.branch(k)] for k in range(count)])
    frequency, quality = np.exp(np.clip(logs[:, :2], -30, 30)).T
    inside = (frequency > f[0]) & (frequency < f[-1])
    # Narrower than the points are apart is no resonance that these points can tell.
    step = np.interp(frequency, f, np.gradient(f))
    sharp = (quality > _LEAST_QUALITY) & (frequency / quality > step)
    # How far the branch rises above the static capacitance, at its resonance.
    strong = quality * np.exp(np.clip(logs[:, 2] - fit.parameters[0], -60, 30)) > _LEAST_RISE
    variances = np.diag(fit.covariance)
    bounded = variances[3 : layout.loss : 3] < _BOUNDED**2
    if not np.all(inside & sharp & strong & bounded) or not np.all(variances > 0):
        return None
    if not _is_usual(sweep, fit, layout):
        return None
    return _in_order(fit, layout, frequency), layout


def _is_usual(sweep: ImpedanceSweep, fit: ComplexFit, layout: Layout) -> bool:
    """True where corrections are what leads, ceramics and analysers do; else they stand for modes
    beside the band, with another static capacitance."""
    p = fit.parameters
    if layout.leads:
        ohms, henries = p[layout.lead : layout.lead + 2]
        # Leads give no power. A coil may be what metres of wire have, or half of the impedance;
        # any where leads are told.
        error = math.sqrt(fit.covariance[layout.lead, layout.lead])
        omega = 2 * math.pi * sweep.frequency[-1]
        least = float(np.min(np.abs(1 / sweep.admittance)))
        most = 10 * least if sweep.compensated is False else max(omega * _WIRE, _COIL * least)
        if ohms < -2 * error or ohms > least or omega * abs(henries) > most:
            return False
    if layout.coupling_loss and (abs(p[layout.loss]) > _MOST_LOSS or p[1] < -_MOST_LOSS):
        return False
    if layout.drift and math.hypot(*p[-2:]) > _MOST_DRIFT:
        return False
    # Softer by a third is no correction of a linear circuit any more.
    return not (layout.softening and np.any(np.abs(p[layout.soft :][:2]) > [0.3, 0.95]))


def sweep_motion(sweep: ImpedanceSweep, p: si.FloatArray) -> si.DimensionlessArray:
    """The motion at each point of a sweep over the largest (1, (points,)), with the static branch
    of the circuit's parameters `p`."""
    held = 2j * np.pi * sweep.frequency * math.exp(p[0]) * (1 - 1j * p[1])
    return relative_motion(held, sweep.frequency, sweep.admittance)


def _starts(f: si.HertzArray, y: si.ComplexArray, count: int) -> _Starts | None:
    """Frequencies and Q to begin with: poles of a rational function with one or more too many, of
    which those with the strongest residues inside the band are kept."""
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
    return None


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
