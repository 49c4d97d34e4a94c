"""Partial levitation: gas film and asperities share the load of a ridge's plateau.

Over a plateau h(T) = u − a cos T, u its mean gap. In the mean over a period

    ⟨p_gas⟩ − p0 + ⟨p_a(h(T))⟩ = p_plateau,        µ′/µ = ⟨p_a⟩ / p_plateau

with the film solved (`gas_table`) and p_a the asperities' law, which does not know the load.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.errors import ConvergenceError, InputError, OutOfRangeError, OutOfRangeWarning
from squeezefilm.physics.contact.finger.fingertip import Skin
from squeezefilm.physics.contact.rough_contact import LEAST_GAP, ContactLaw, RoughContact
from squeezefilm.physics.contact.sharing.gas_table import DEEPEST_EXCURSION, FilmTable, complete


@dataclass(frozen=True, eq=False)
class LoadSharing:
    """Balances of plateaus, arrays of one shape.

    Pressures are means over plateau and period, the gas's over ambient. `gap_amplitude` differs
    from `amplitude` (the plate's) by what the skin moves, `skin_amplitude`. `residual` is the
    imbalance over the plateau's pressure, `relative_friction_error` what the film table's error
    bound leaves of doubt in µ′/µ.
    """

    amplitude: si.MetreArray
    plateau_pressure: si.PascalArray
    mean_gap: si.MetreArray
    gas_pressure: si.PascalArray
    asperity_pressure: si.PascalArray
    gap_amplitude: si.MetreArray
    skin_amplitude: si.MetreArray
    residual: si.DimensionlessArray
    film_error: float
    steps: si.FloatArray
    asperities: ContactLaw
    model: str

    @property
    def relative_friction(self) -> si.DimensionlessArray:
        """µ′/µ: the asperities' share of the load (dimensionless)."""
        return self.asperity_pressure / (self.asperity_pressure + self.gas_pressure)

    @property
    def relative_friction_error(self) -> si.DimensionlessArray:
        """The bound on the error of µ′/µ: that of the film times the gas's share."""
        return self.film_error * (1 - self.relative_friction) + np.abs(self.residual)


@si.checked_numbers
def share_load(
    table: FilmTable,
    asperities: ContactLaw,
    amplitude: Annotated[si.MetreLike, si.AtLeast(0.0), si.AtMost(1e-4)],
    plateau_pressure: Annotated[si.PascalLike, si.Above(0.0)],
    *,
    skin: Skin | None = None,
) -> LoadSharing:
    """Each plateau at its own balance; amplitude (m, of the plate there) and pressure broadcast.

    Without a `skin` the finger is rigid at the ultrasonic frequency. Raises `InputError` for
    values that cannot be used, `OutOfRangeError` where the asperities are pressed through (the gap
    would close beyond 99.3 % of its mean, or below nothing) or the skin resonates, so that it goes
    along with the plate, `ConvergenceError` where no balance is found. Warns `OutOfRangeWarning` of
    a pressure above the law's `largest_pressure`.
    """
    from squeezefilm.physics.contact.sharing import kernel

    announce(kernel.balance_rows, "load balance", 20)
    if skin is not None:
        swings = np.vectorize(partial(_swings, table, asperities, skin), otypes=[float, float])
        gap, moved = swings(amplitude, plateau_pressure)
        rigid = share_load(table, asperities, gap, plateau_pressure)
        met = np.broadcast_to(amplitude, gap.shape)
        model = rigid.model.replace("rigid skin", "yielding skin")
        return replace(rigid, amplitude=met, skin_amplitude=moved, model=model)
    form = np.broadcast_shapes(np.shape(amplitude), np.shape(plateau_pressure))
    a = np.array(np.broadcast_to(amplitude, form), dtype=float).ravel()
    p = np.array(np.broadcast_to(plateau_pressure, form), dtype=float).ravel()
    rows = np.zeros((a.size, kernel.COLUMNS))
    law = asperities.compiled()
    complete(table, lambda films: kernel.balance_rows(a, p, law, films, rows))
    require_balanced(rows, asperities, a, p)
    model = _model(table, asperities, "each plateau at its own balance")
    return _shared(a.reshape(form), p.reshape(form), rows, table, asperities, model)


def _swings(
    table: FilmTable, asperities: ContactLaw, skin: Skin, amplitude: float, pressure: float
) -> tuple[float, float]:
    """Amplitudes of gap and skin (m) where the skin yields to the alternating pressure.

    b = a/(1 + Z/D): D the skin's dynamic stiffness, Z = [film + 2⟨p_a cos T⟩/b] that of the gap.
    A light skin resonates on the film, and the gap may have several swings: the least is taken,
    which is the one met as the plate's amplitude rises.
    """
    from scipy.optimize import brentq

    from squeezefilm.physics.contact.asperity_kernel import asperity_mean
    from squeezefilm.physics.contact.sharing import kernel

    if amplitude == 0:
        return 0.0, 0.0
    law, D = asperities.compiled(), skin.dynamic_stiffness(table.frequency)

    def moved(swing: float) -> complex:
        """Z/D, what the skin moves over what the gap does."""
        u = float(share_load(table, asperities, swing, pressure).mean_gap)
        k, d = (kernel.film_value(which, u, swing, table.compiled)[0] for which in (1, 2))
        return complex(k + asperity_mean(law, u, swing)[1] / swing, d) / D

    def excess(swing: float) -> float:
        return swing * abs(1 + moved(swing)) - amplitude

    low, high = 1e-6 * amplitude, 0.6 * amplitude
    if excess(low) > 0:
        raise OutOfRangeError(
            f"a skin of {abs(D):.3g} Pa/m at {table.frequency:.5g} Hz goes along with the plate: "
            "its gap swings by less than a millionth of the amplitude. Give it more damping, or a "
            "mass and a stiffness that resonate at another frequency"
        )
    while excess(high) < 0:
        low, high = high, 1.15 * high
    swing = float(brentq(excess, low, high, xtol=1e-14 * amplitude, rtol=1e-14))
    return swing, swing * abs(moved(swing))


@si.checked_numbers
def share_load_tied(
    table: FilmTable,
    asperities: ContactLaw,
    amplitude: Annotated[si.MetreArray, si.AtLeast(0.0), si.AtMost(1e-4)],
    plateau_pressure: Annotated[si.Pascal, si.Above(0.0)],
    shares: Annotated[si.DimensionlessArray, si.AtLeast(0.0)] | None = None,
) -> LoadSharing:
    """Plateaus tied to one mean gap that carry a mean pressure (Pa), the skin rigid.

    `amplitude` (m) has shape (…, ridges); `shares` (ridges,) are those of all the ridges that each
    stands for (None: alike). All else that is given back is of the shape before the ridges:
    pressures are means over all plateaus and the period. Raises as `share_load` does.
    """
    from squeezefilm.physics.contact.sharing import kernel

    announce(kernel.balance, "load balance", 20)
    a = np.ascontiguousarray(np.atleast_1d(amplitude), dtype=float)
    *form, count = a.shape
    part = np.full(count, 1 / count) if shares is None else np.ascontiguousarray(shares)
    if part.shape != (count,):
        raise InputError(f"{count} ridges need {count} of shares", quantity="shares")
    law = asperities.compiled()
    rows, pressure = np.zeros((*form, kernel.COLUMNS)), np.full(form, plateau_pressure)
    for at in np.ndindex(*form):
        row, ridges = rows[at], kernel.CompiledRidges(a[at], part)
        p = float(plateau_pressure)
        complete(table, partial(kernel.balance, ridges, p, law, out=row))
        _refuse(row[None, :], a[at].max(keepdims=True), np.array([p]))
        _require_law(asperities, np.array(row[kernel.GAP] - a[at].max()), np.array(p))
    model = _model(table, asperities, "all plateaus at one mean gap")
    return _shared(a, pressure, rows, table, asperities, model)


def _shared(
    amplitude: si.FloatArray,
    pressure: si.FloatArray,
    rows: si.FloatArray,
    table: FilmTable,
    asperities: ContactLaw,
    model: str,
) -> LoadSharing:
    """Balances as they are handed out, in the shape of the pressure."""
    from squeezefilm.physics.contact.sharing import kernel

    columns = {
        "mean_gap": kernel.GAP,
        "gas_pressure": kernel.GAS,
        "asperity_pressure": kernel.ASPERITIES,
        "residual": kernel.RESIDUAL,
        "steps": kernel.STEPS,
    }
    return LoadSharing(
        amplitude=amplitude,
        plateau_pressure=pressure,
        gap_amplitude=amplitude,
        skin_amplitude=np.zeros(pressure.shape),
        film_error=table.relative_error,
        asperities=asperities,
        model=model,
        **{name: rows[..., at].reshape(pressure.shape) for name, at in columns.items()},
    )


def require_balanced(
    rows: si.FloatArray, law: ContactLaw, amplitude: si.FloatArray, pressure: si.FloatArray
) -> None:
    """Raise what `share_load` raises of the kernel's rows, each plateau at an amplitude (m) under a
    pressure (Pa) of its own."""
    from squeezefilm.physics.contact.sharing import kernel

    _refuse(rows, amplitude, pressure)
    _require_law(law, rows[:, kernel.GAP] - amplitude, pressure)


def _require_law(law: ContactLaw, nearest: si.FloatArray, pressure: si.FloatArray) -> None:
    """Refuse balances that press a rough interface nearly flat, where its law ends, at the
    `nearest` gap of a period (m); warn of plateaus pressed so hard that the law of asperities does
    not hold even at rest."""
    if isinstance(law, RoughContact):
        flat = nearest < law.least_gap
        if np.any(flat):
            most = si.format_quantity(law.largest_pressure, si.Unit("Pa"))
            shown = si.format_quantity(float(np.min(pressure[flat])), si.Unit("Pa"))
            raise OutOfRangeError(
                f"a plateau under {shown} brings nearly everything into contact once a period: the "
                f"gap falls below {LEAST_GAP} of the roughness, where the contact's law ends; at "
                f"rest it holds to {most}. Press less, vibrate less, or take a rougher or stiffer "
                "skin"
            )
    elif np.any(pressure > law.largest_pressure):
        most = si.format_quantity(law.largest_pressure, si.Unit("Pa"))
        shown = si.format_quantity(float(np.max(pressure)), si.Unit("Pa"))
        warnings.warn(
            f"a plateau under {shown} presses most of its asperities flat even at rest, where they "
            f"no longer carry by themselves: {law.words} hold to {most}. Press less, or take the "
            "contact of a rough elastic interface (RoughContact)",
            OutOfRangeWarning,
            stacklevel=3,
        )


def _model(table: FilmTable, asperities: ContactLaw, tie: str) -> str:
    return (
        f"partial levitation, {tie}: strip films of {table.width * 1e6:.4g} µm with slip "
        f"'{table.slip}', {asperities.words}, rigid skin"
    )


def _refuse(rows: si.FloatArray, amplitude: si.FloatArray, pressure: si.FloatArray) -> None:
    from squeezefilm.physics.contact.sharing import kernel

    bad = np.flatnonzero(rows[:, kernel.STATUS] != kernel.BALANCED)
    if bad.size == 0:
        return
    at = int(bad[0])
    status = int(rows[at, kernel.STATUS])
    asked = (
        f"a plateau under {si.format_quantity(pressure[at], si.Unit('Pa'))} at an amplitude of "
        f"{si.format_quantity(amplitude[at], si.Unit('m'))}"
    )
    if status == kernel.PRESSED_THROUGH:
        raise OutOfRangeError(
            f"{asked} is pressed through its asperities: gas and asperities do not carry it at a "
            f"gap closed by {si.percent(DEEPEST_EXCURSION, 1)} of its mean, or closed altogether. "
            "Press less, vibrate less, or take asperities that carry more"
        )
    if status == kernel.OUT_OF_TABLE:
        raise OutOfRangeError(
            f"{asked} leads to a gap for which the film is not tabulated: the asperities hold skin "
            "and surface too far apart or too near for a film, whose squeeze number is out of 3e-4 "
            "to 1.6e5. Check the roughness of surface and skin, frequency, plateau width and "
            "ambient pressure"
        )
    raise ConvergenceError(
        f"{asked} was not balanced; the residual is {rows[at, kernel.RESIDUAL]:.3g} of the load",
        residual=float(rows[at, kernel.RESIDUAL]),
        iterations=int(rows[at, kernel.STEPS]),
    )
