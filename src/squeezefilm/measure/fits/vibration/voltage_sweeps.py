"""Sweeps at several voltages: a resonance and losses that change with the amplitude."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Literal, get_args

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import (
    Estimate,
    FitResult,
    Observation,
    adequacy_of,
    correlation_factor,
    guarded_fit,
    inverse_of,
    observed,
)
from squeezefilm.measure.fits.least_squares import NonlinearFit, fit_nonlinear
from squeezefilm.measure.fits.vibration.frequency_response import (
    PHASE_REVERSED,
    ModalCircle,
    modal_circle,
)
from squeezefilm.measure.recordings.kinds import VoltageSweeps, finite
from squeezefilm.physics.plate.loaded_mode import FreePlate

BackboneLaw = Literal["quadratic", "linear"]
BACKBONE_LAWS: tuple[BackboneLaw, ...] = get_args(BackboneLaw)
"""Laws of the frequency over the amplitude: with its square (Duffing), or in proportion."""
_POWERS: dict[BackboneLaw, int] = {"quadratic": 2, "linear": 1}

_Flags = np.ndarray[tuple[int, ...], np.dtype[np.bool]]
_FEWEST_POINTS = 30
# Near a fold of the curve a small noise moves a point far: such points say little and bend much.
_FOLD = 0.15


@dataclass(frozen=True, eq=False, repr=False)
class VoltageSweepsFit(FitResult):
    """A resonance whose frequency and losses depend on the amplitude a (m, zero to peak).

    f = f0 (1 + `backbone` a²) by the law "quadratic" (1/m²), f0 (1 + `backbone` a) by "linear"
    (1/m): negative where the plate softens. 1/Q = (1/Q0)(1 + `damping_rise` a) (1/m).
    `frequency` (f0, Hz), `quality_factor` (Q0) and `amplitude_per_volt` (m/V, at resonance) are
    those of vanishing amplitudes. Above `critical_amplitude` (m) at the resonance a sweep jumps;
    None where the backbone is not told from none. `phase_reversed` says that the phase was recorded
    with the other sign, and the fit is of the complex conjugate. `model` and `residual` (m,
    complex) go with the finite points of all sweeps in a row.
    """

    recording: VoltageSweeps
    law: BackboneLaw
    frequency: Estimate
    quality_factor: Estimate
    amplitude_per_volt: Estimate
    backbone: Estimate
    damping_rise: Estimate
    critical_amplitude: si.Metre | None
    phase_reversed: bool
    model: si.ComplexArray
    residual: si.ComplexArray

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Observations of a linear plate: values for vanishing amplitudes; none where
        the fit is not adequate."""
        if not self.adequacy.adequate:
            return ()
        return observed(
            {"voltage": 0.0},
            resonance_frequency=self.frequency,
            quality_factor=self.quality_factor,
            amplitude_per_volt=self.amplitude_per_volt,
        )

    @si.checked_numbers
    def free_plate(
        self, share: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 1.0
    ) -> FreePlate:
        """The plate's nonlinearity as a motor's description takes it, for `[motor.free_plate]`.

        `share` is what the point that was measured moves of the lobe (1). Losses that fall with the
        amplitude by less than their standard error count as constant; raises `InputError` for a fit
        that is not adequate, and for losses that fall.
        """
        if not self.adequacy.adequate:
            raise InputError(
                "the fit of these sweeps is not adequate, and its backbone is no property of the "
                "plate; see what it says of its misfit"
            )
        rise = self.damping_rise
        if rise.value < -2 * rise.standard_error:
            raise InputError(
                f"the losses fall with the amplitude ({rise.value:.3g} 1/m), which no plate by "
                "itself does; measure it without what it rubs on"
            )
        by = {"linear": "by_amplitude", "quadratic": "by_square"}[self.law]
        bent = {by: self.backbone.value * share ** _POWERS[self.law]}
        return FreePlate(**bent, loss_rise=max(0.0, rise.value) * share)


@guarded_fit
def fit_voltage_sweeps(recording: VoltageSweeps) -> VoltageSweepsFit:
    """Fit how resonance frequency (Hz) and losses depend on the amplitude (m), from sweeps at
    several voltages (V), up and down.

    At every point [(f(a)/f0)² (1 + i/Q(a)) − (f/f0)²](x − R V) = g V with the amplitude a = |x|
    that was recorded: no branch has to be chosen, and jumps need no treatment. Residuals are
    brought back to metres by the curve's own slope (to first order: small noise); points next to a
    fold are left out. Of the laws the one that leaves less. Noise is taken to be the same in metres
    at every voltage. Raises `InputError` for fewer than 30 points, a sweep without a voltage or
    phase, or one voltage only. Source: Nayfeh and Mook, Nonlinear Oscillations, section 4.1.
    """
    points = _Points.of(recording)
    looks = [_first_look(points, law) for law in BACKBONE_LAWS]
    duffing, look, steps = min(looks, key=_left)
    return _told(recording, duffing, *_fitted(duffing, look, steps))


@dataclass(frozen=True, eq=False)
class _Points:
    """All points in a row, amplitudes over the largest and volts over the highest."""

    f: si.HertzArray
    u: si.ComplexArray
    v: si.FloatArray
    size: si.Metre
    volts: si.Volt
    phase_reversed: bool = False

    @classmethod
    def of(cls, recording: VoltageSweeps) -> _Points:
        if len(recording.sweeps) != len(recording.directions):
            raise InputError(
                f"{len(recording.sweeps)} sweeps have {len(recording.directions)} directions; say "
                "of each whether it went up or down"
            )
        if not recording.sweeps:
            raise InputError("there is no sweep; give sweeps at two or more voltages")
        rows = []
        for number, sweep in enumerate(recording.sweeps, 1):
            if not sweep.voltage or sweep.voltage <= 0:
                raise InputError(f"sweep {number} has no voltage; say at which it was made")
            f, H = finite(sweep.frequency, sweep.displacement_per_volt)
            f, H = f[f > 0], H[f > 0]
            rows.append((f, H * sweep.voltage, np.full(f.size, sweep.voltage)))
        f, x, V = (np.concatenate(column) for column in zip(*rows, strict=True))
        if f.size < _FEWEST_POINTS:
            raise InputError(
                f"the sweeps have {f.size} usable points; a backbone needs at least "
                f"{_FEWEST_POINTS}"
            )
        if not np.any(x.imag):
            raise InputError("the sweeps have no phase; record magnitude and phase")
        if np.ptp(V) < 0.05 * V.max():
            raise InputError(
                "all sweeps were made at one voltage; what depends on the amplitude shows between "
                "voltages: sweep at two or more"
            )
        size = float(np.max(np.abs(x)))
        points = cls(
            f,
            np.asarray(x / size, dtype=complex),
            V / V.max(),
            size,
            float(V.max()),
        )
        circle = points.circle
        if circle is not None and circle.quality_factor < 0:
            return replace(points, u=points.u.conj(), phase_reversed=True)
        return points

    @cached_property
    def circle(self) -> ModalCircle | None:
        """The lowest sweep's, up and down in one row, so that it meets rising frequencies."""
        low = self.v == self.v.min()
        order = np.argsort(self.f[low], kind="stable")
        return modal_circle(self.f[low][order], self.u[low][order] / self.v.min())

    @cached_property
    def start(self) -> si.FloatArray:
        """f0 as 1, loss, backbone, its loss, g, R (real and imaginary); from the lowest sweep's
        circle and the highest one's peak."""
        low, circle = self.v == self.v.min(), self.circle
        f, u = self.f[low], self.u[low] / self.v.min()
        if circle is None or not f.min() < circle.frequency < f.max():
            return np.array([float(f[np.argmax(np.abs(u))]), 0.02, 0, 0, 0.02, 0, 0, 0])
        loss = min(abs(1 / circle.quality_factor), 0.3)
        peak = u[np.argmin(np.abs(f - circle.frequency))]
        g = 1j * loss * peak
        return np.array([circle.frequency, loss, 0, 0, g.real, g.imag, 0, 0])


@dataclass(frozen=True, eq=False)
class _Duffing:
    """The equation of motion of a law, over the frequency `own` (Hz)."""

    points: _Points
    law: BackboneLaw
    own: si.Hertz

    def terms(self, at: si.FloatArray) -> tuple[si.ComplexArray, ...]:
        """D, a dD/da, x − RV and gV."""
        shift, loss, bend, rise = at[:4]
        g, R = at[4] + 1j * at[5], at[6] + 1j * at[7]
        points = self.points
        a = np.abs(points.u)
        own, power = 1 + shift, _POWERS[self.law]
        back, bent = 1 + bend * a**power, power * bend * a**power
        lossy = 1 + 1j * loss * (1 + rise * a)
        D = (own * back) ** 2 * lossy - (points.f / self.own) ** 2
        slope = own**2 * (2 * back * bent * lossy + back**2 * 1j * loss * rise * a)
        x = points.u - R * points.v
        return tuple(np.asarray(term, dtype=complex) for term in (D, slope, x, g * points.v))

    def steps_to_curve(self, at: si.FloatArray) -> tuple[si.ComplexArray, si.FloatArray]:
        """Distance of each point from the curve, to first order, and how far from a fold: the
        determinant of the equation's slopes over that of a linear one."""
        D, slope, x, wanted = self.terms(at)
        E, u = D * x - wanted, self.points.u
        size = np.abs(u)
        unit = u / np.where(size > 0, size, 1.0)
        z = slope * x / np.where(size > 0, size, 1.0)
        # Rows of the 2 × 2 slopes: D δu + z Re(û* δu).
        a, b = D.real + z.real * unit.real, -D.imag + z.real * unit.imag
        c, d = D.imag + z.imag * unit.real, D.real + z.imag * unit.imag
        determinant = a * d - b * c
        safe = np.where(np.abs(determinant) > 1e-12, determinant, 1e-12)
        step = ((d * E.real - b * E.imag) + 1j * (a * E.imag - c * E.real)) / safe
        return np.asarray(step), np.asarray(determinant.real / np.abs(D) ** 2)


def _told(
    recording: VoltageSweeps, duffing: _Duffing, fit: NonlinearFit, used: _Flags
) -> VoltageSweepsFit:
    """A law's fit to the points that were `used`, read off."""
    points, own, power = duffing.points, duffing.own, _POWERS[duffing.law]
    step, _ = duffing.steps_to_curve(fit.numbers)
    count = int(used.sum())
    left = -(fit.residual[:count] + 1j * fit.residual[count:])
    fit = fit.with_widening(correlation_factor(left))
    size, volts = points.size, points.volts

    def estimate(i: int, factor: float, unit: str) -> Estimate:
        return fit.estimate(lambda at: factor * float(at[i]), unit)

    backbone = estimate(2, size**-power, "1/m2" if power == 2 else "1/m")
    f, v = points.f[used], points.v[used] * volts
    adequacy = adequacy_of(
        points.u[used] * size,
        left * size,
        lambda i: (
            f"at {si.format_quantity(f[i], si.Unit('Hz'), 5)} and "
            f"{si.format_quantity(v[i], si.Unit('V'), 3)}"
        ),
        said=PHASE_REVERSED if points.phase_reversed else "",
        remedy="Narrow the band to the one mode, or wait between sweeps until the plate is cold.",
    )
    return VoltageSweepsFit(
        recording=recording,
        law=duffing.law,
        frequency=fit.estimate(lambda at: own * (1 + float(at[0])), "Hz"),
        quality_factor=inverse_of(estimate(1, 1.0, "1")),
        amplitude_per_volt=fit.estimate(
            lambda at: size / volts * math.hypot(at[4], at[5]) / abs(at[1]) / (1 + at[0]) ** 2,
            "m/V",
            positive=True,
        ),
        backbone=backbone,
        damping_rise=estimate(3, 1 / size, "1/m"),
        critical_amplitude=_critical(backbone, float(fit.numbers[1]), power),
        phase_reversed=points.phase_reversed,
        model=(points.u - step) * size,
        residual=step * size,
        adequacy=adequacy,
    )


def _first_look(points: _Points, law: BackboneLaw) -> tuple[_Duffing, NonlinearFit, si.FloatArray]:
    """A law's numbers by the equation as it stands, which leads near from afar, and the steps by
    which they are varied."""
    start = points.start.copy()
    own, start[0] = float(start[0]), 0.0
    duffing = _Duffing(points, law, own)
    loss = float(start[1])
    # The backbone by where the highest sweep has its peak.
    peak = int(np.argmax(np.where(points.v == 1.0, np.abs(points.u), 0.0)))
    start[2] = (points.f[peak] / own - 1) / np.abs(points.u[peak]) ** _POWERS[law]
    steps = np.array([loss, loss, loss, 1.0, loss, loss, loss, loss]) * 1e-5

    def equation(at: si.FloatArray) -> si.FloatArray:
        D, _, x, wanted = duffing.terms(at)
        E = D * x - wanted
        return np.concatenate([E.real, E.imag])

    return duffing, fit_nonlinear(equation, start, steps), steps


def _left(look: tuple[_Duffing, NonlinearFit, si.FloatArray]) -> float:
    """Distance of points away from folds from a law's curve after its first look."""
    duffing, fit, _ = look
    step, folded = duffing.steps_to_curve(fit.numbers)
    return float(np.mean(np.minimum(np.abs(step), 0.2)[folded > _FOLD] ** 2))


def _fitted(
    duffing: _Duffing, fit: NonlinearFit, steps: si.FloatArray
) -> tuple[NonlinearFit, _Flags]:
    """The best numbers of a law, and the points used: those near a fold are left out by the last
    look."""
    everything = np.ones(duffing.points.f.size, dtype=bool)
    for _ in range(2):
        _, folded = duffing.steps_to_curve(fit.numbers)
        used = folded > _FOLD
        if used.sum() < _FEWEST_POINTS:
            used = everything

        def residual(at: si.FloatArray, used: _Flags = used) -> si.FloatArray:
            step, _ = duffing.steps_to_curve(at)
            return np.concatenate([step.real[used], step.imag[used]])

        fit = fit_nonlinear(residual, fit.numbers, steps)
    return fit, used


def _critical(backbone: Estimate, loss: float, power: int) -> si.Metre | None:
    """The amplitude at resonance from which the response is not single-valued.

    For the square law a² = 4/(3√3) · 1/(Q|b|), at the drive at which the curve's slope first
    stands upright; for the law in proportion no closed form is given.
    """
    low, high = backbone.interval
    if power != 2 or low <= 0 <= high:
        return None
    return math.sqrt(4 * abs(loss) / (3 * math.sqrt(3) * abs(backbone.value)))
