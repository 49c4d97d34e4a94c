"""The hard limits of size and work: the one place that says how large anything may be.

Two kinds. Sizes of what is described (a plate's side, a modulus): far wider than anything that is
built, so that only a slip of unit or a damaged file meets them, and narrow enough that no formula
runs out of floats. Amounts of work (steps of a stroke, unknowns of a solve, bytes of a file):
what ends in minutes within a few gigabytes on a small computer. `require_within` refuses what is
outside, before anything is computed, and says what would be enough.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

_ONE, _M, _HZ, _S, _N, _PA = (si.Unit(symbol) for symbol in ("1", "m", "Hz", "s", "N", "Pa"))


@dataclass(frozen=True, slots=True)
class HardLimit:
    """Range from `least` to `most` of `name`, in `unit`; `reason` is what people are told."""

    name: str
    least: float
    most: float
    reason: str
    unit: si.Unit = _ONE

    @property
    def range(self) -> str:
        """The allowed range in words: ``"at least 1 µm and at most 10 m"``."""
        return (
            f"at least {_shown(self.least, self.unit)} and at most {_shown(self.most, self.unit)}"
        )

    def refuse_outside(self, asked: si.FloatLike, quantity: str) -> None:
        """`require_within` for what an annotation bounds: ``Annotated[Metre, SIDE]``."""
        require_within(self, asked, quantity)


def require_within(
    limit: HardLimit, asked: si.FloatLike, quantity: str | None = None, *, enough: str = ""
) -> None:
    """Refuse a value (SI; scalar or array) outside a hard limit.

    `quantity` is the field that was asked for (without one the limit's name), `enough` a sentence
    that says what would do. Raises `InputError` with the value, the limit, its reason and `enough`.
    """
    if isinstance(asked, float) and limit.least <= asked <= limit.most:
        return  # as most calls do, without the arrays below
    values = np.asarray(asked, dtype=float)
    outside = ~((values >= limit.least) & (values <= limit.most))
    if not outside.any():
        return
    offender = float(values[outside].flat[0])
    raise InputError(
        f"{quantity or limit.name} = {_shown(offender, limit.unit)} cannot be used: it must be "
        f"{limit.range} ({limit.name}: {limit.reason})"
        + (f"; {enough}" if enough else _probably_meant(limit, offender)),
        quantity=quantity,
    )


def _probably_meant(limit: HardLimit, value: float) -> str:
    """The same number with another prefix, where the limit allows that: metres for millimetres."""
    for scale in (1e-3, 1e-6, 1e3, 1e6):
        if limit.unit != _ONE and value and limit.least <= scale * value <= limit.most:
            return f'; did you mean "{si.typed_quantity(scale * value, limit.unit)}"?'
    return ""


def require_motion(limit: HardLimit, steps: float, duration: float, rate: float) -> None:
    """Refuse more (or fewer) steps of a motion than a limit allows, before they are made.

    `duration` (s) and `rate` (Hz) are what makes them. Raises `InputError`, saying from which to
    which duration would do.
    """
    least, most = (si.format_quantity(count / rate, _S) for count in (limit.least, limit.most))
    shown, pace = si.format_quantity(duration, _S), si.format_quantity(rate, _HZ)
    enough = f"the motion takes {shown} at {pace}, and from {least} to {most} would do: make it"
    enough += " shorter or faster" if steps > limit.most else " longer or slower"
    require_within(limit, float(np.floor(steps)), enough=enough)


def _shown(value: float, unit: si.Unit) -> str:
    """Counts are written out, other numbers with four digits and their unit."""
    if unit == _ONE and float(value).is_integer() and abs(value) < 1e15:
        return f"{int(value):,}".replace(",", " ")
    return si.format_quantity(value, unit)


_SLIP = "anything outside is a slip of unit"

# --- sizes of what is described ---------------------------------------------------------------

SIDE = HardLimit("a side or a diameter", 1e-6, 10.0, "MEMS to table tops; " + _SLIP, _M)
PLACE = HardLimit("a distance from an edge", 0.0, 10.0, "no body is larger; " + _SLIP, _M)
LAYER = HardLimit("the thickness of a layer", 1e-8, 1.0, "thin films to blocks; " + _SLIP, _M)
MODULUS = HardLimit("a modulus", 1e-2, 1e13, "next to nothing to beyond diamond; " + _SLIP, _PA)
SHEAR_MODULUS = HardLimit("a shear modulus", 0.0, 1e13, "up to beyond diamond; " + _SLIP, _PA)
DENSITY = HardLimit("a density", 1.0, 1e5, "aerogel to beyond osmium; " + _SLIP, si.Unit("kg/m3"))
SPECIFIC_HEAT = HardLimit("a specific heat", 10.0, 1e5, "of any solid; " + _SLIP, si.Unit("J/kg/K"))
QUALITY = HardLimit("a quality factor", 0.501, 1e8, "from no resonance to beyond quartz")
COMPLIANCE = HardLimit("a compliance", 1e-14, 1e-3, "of any solid; " + _SLIP, si.Unit("m2/N"))
CROSS_COMPLIANCE = HardLimit("a compliance", -1e-3, 1e-3, "of any solid; " + _SLIP, si.Unit("m2/N"))
CHARGE_COEFFICIENT = HardLimit(
    "a charge coefficient", -1e-6, 1e-6, "beyond any ceramic or crystal; " + _SLIP, si.Unit("m/V")
)
STRESS_COEFFICIENT = HardLimit(
    "a stress coefficient", -1e4, 1e4, "beyond any ceramic or crystal; " + _SLIP, si.Unit("C/m2")
)
PERMITTIVITY = HardLimit("a relative permittivity", 1.0, 1e7, "vacuum to beyond any ceramic")
RESISTANCE = HardLimit("a resistance", 1e-6, 1e15, "a busbar to the best insulator", si.Unit("ohm"))
FREQUENCY = HardLimit("a frequency", 1.0, 1e9, "of a vibration in a solid; " + _SLIP, _HZ)
ROUGHNESS = HardLimit(
    "a roughness", 1e-11, 1e-4, "below an atom to coarse sandpaper, on which no film forms", _M
)
SKIN_ROUGHNESS = HardLimit("a skin's roughness", 0.0, 2e-4, "none to cracked skin; " + _SLIP, _M)
HEIGHTS = HardLimit("a height or a wavelength", 1e-11, 1e-2, "of any roughness; " + _SLIP, _M)
TEXTURE_LENGTH = HardLimit(
    "a texture's period or width", 1e-9, 0.5, "no finger's stroke on a display is longer", _M
)
RIDGE_AMPLITUDE = HardLimit("half a ridge's height", 0.0, 1e-2, "none to a glove; " + _SLIP, _M)
CONTACT_LENGTH = HardLimit("a contact's length", 1e-6, 1.0, "a hair to a forearm; " + _SLIP, _M)
RIDGE_PERIOD = HardLimit("a ridge's period", 1e-6, 1.0, "a hair to a forearm; " + _SLIP, _M)
DECAY_LENGTH = HardLimit("a decay length", 1e-11, 1e-3, "below an atom to a rasp; " + _SLIP, _M)
FORCE = HardLimit("a force", 1e-6, 1e4, "a fly to a car's jack; " + _SLIP, _N)
PRESSURE = HardLimit("a pressure", 1e-3, 1e10, "a high vacuum to a press; " + _SLIP, _PA)
VISCOSITY = HardLimit("a viscosity", 1e-8, 1e3, "below any gas to honey; " + _SLIP, si.Unit("Pa*s"))
GAS_DENSITY = HardLimit("a gas's density", 1e-9, 1e4, "of any gas; " + _SLIP, si.Unit("kg/m3"))
FREE_PATH = HardLimit("a mean free path", 1e-18, 1e3, "none, in effect, to a vacuum; " + _SLIP, _M)
TOUCHED_VIBRATION = HardLimit(
    "a vibration under a finger",
    0.0,
    1e-4,
    "displays reach some micrometres, and film and contact are solved up to here",
    _M,
)
VIBRATION = HardLimit("a vibration's amplitude", 0.0, 1e-3, "no plate survives more", _M)
PAD_STIFFNESS = HardLimit("a stiffness", 1e-3, 1e9, "of a fingertip; " + _SLIP, si.Unit("N/m"))
PAD_DAMPING = HardLimit("a damping", 0.0, 1e6, "of a fingertip; " + _SLIP, si.Unit("N*s/m"))
PAD_MASS = HardLimit("a mass", 1e-9, 1e3, "of a fingertip; " + _SLIP, si.Unit("kg"))
SKIN_MASS = HardLimit("a mass per area", 1e-6, 1e9, "up to one that stands still", si.Unit("kg/m2"))
SKIN_STIFFNESS = HardLimit("a stiffness per area", 0.0, 1e15, "of skin; " + _SLIP, si.Unit("Pa/m"))
SKIN_DAMPING = HardLimit("a damping per area", 0.0, 1e12, "of skin; " + _SLIP, si.Unit("Pa*s/m"))
FINGER_SPEED = HardLimit(
    "a finger's speed", 1e-9, 5.0, "from creeping to faster than any hand", si.Unit("m/s")
)
STROKE_LENGTH = HardLimit("a stroke's length", 1e-9, 10.0, "no surface is longer; " + _SLIP, _M)
PASS_DURATION = HardLimit("a pass's duration", 1e-6, 1e9, "a pass may take thirty years", _S)
STROKE_START = HardLimit("where a stroke starts", -10.0, 10.0, "no surface is longer; " + _SLIP, _M)

# --- work -------------------------------------------------------------------------------------

NODAL_LINES = HardLimit("nodal lines", 2, 300, "a mode is found by going through all below it")
NODAL_CIRCLES = HardLimit(
    "nodal circles or diameters", 0, 100, "a mode is found by going through all below it"
)
PARTS_OF_A_PLATE = HardLimit(
    "ceramics or supports", 0, 200, "every pair is checked, and every edge takes elements"
)
RIDGES = HardLimit(
    "ridges under a contact", 0, 2000, "each is a film and a load balance of its own"
)
SOLID_MEMORY = HardLimit(
    "bytes of a three-dimensional solve", 0, 8e9, "it would take hours and all memory"
)
PLANAR_MEMORY = HardLimit(
    "bytes of a film in the plane", 0, 2e9, "every row of cells keeps a dense block"
)
RING_ELEMENTS = HardLimit(
    "elements of a ring's section", 1, 4000, "it would take hours and all memory"
)
BAND_MODES = HardLimit(
    "modes in a band", 0, 500, "each is a field over the whole plate, refined by itself"
)
RING_MODES = HardLimit(
    "modes of one harmonic in a band", 0, 100, "a section's elements do not tell more apart"
)
SWEEP_STEPS = HardLimit("steps of an axis", 1, 10_000, "each is computed by itself")
SWEEP_POINTS = HardLimit(
    "points of a sweep", 1, 100_000, "each takes from milliseconds to minutes, and a row"
)
DESIGNS_SCREENED = HardLimit(
    "designs screened in a search", 1, 1_000_000, "each takes some ten milliseconds and a line"
)
DESIGNS_SOLVED = HardLimit(
    "plates solved in a search", 0, 100_000, "each takes a second or more, and a line"
)
ASPECT = HardLimit("an aspect ratio", 1e-6, 1e6, "beyond, a strip is the same film")
MOTION_SAMPLES = HardLimit(
    "samples of a motion", 2, 20_000_000, "160 MB for every array of a trace"
)
RENDER_STEPS = HardLimit("steps of a rendered stroke", 2, 3_000_000, "fifty arrays of 24 MB each")
LAG_PRODUCTS = HardLimit(
    "products of a lag's correlation", 0, 5e8, "more take minutes for one number"
)
PIXELS = HardLimit("pixels of an image", 1, 1_048_576, "one table of 8 MB in a program")
PARTICIPANT_TRIALS = HardLimit("trials of one participant", 1, 20_000, "a month of sittings")
SIMULATED_TRIALS = HardLimit(
    "answers of simulated people", 1, 20_000_000, "eighty bytes for each of them"
)
FOREIGN_TRIALS = HardLimit(
    "trials in a file of another program", 1, 500_000, "a row is made for each of them"
)
PLANNED_TRIALS = HardLimit(
    "planned trials", 1, 500_000, "each participant's order is made and kept"
)
STUDIES = HardLimit(
    "simulated studies of one size", 10, 100_000, "each is drawn and tested by itself"
)

# --- texts and files --------------------------------------------------------------------------

NAME = HardLimit("characters of a name", 1, 200, "it becomes a file's name or a title")
DESCRIPTION_BYTES = HardLimit(
    "bytes of a description", 0, 4_000_000, "a display has a few thousand"
)
PICTURE_BYTES = HardLimit("bytes of a picture", 0, 16_000_000, "a megapixel of 16 bits")
RECORDING_BYTES = HardLimit(
    "bytes of a recording", 0, 200_000_000, "its text is taken apart cell by cell"
)
TABLE_BYTES = HardLimit("bytes of a table", 0, 2_000_000_000, "it is read into memory")
KEPT_BYTES = HardLimit("bytes of a kept result", 0, 200_000_000, "the largest plates have 100 MB")
TRACE_BYTES = HardLimit("bytes of a trace", 0, 1e12, "a month of the fastest loop")
READING_MEMORY = HardLimit(
    "bytes of memory for a file", 0, 1.5e9, "a small file may unpack to any size"
)
READING_TIME = HardLimit(
    "processor time for a file", 0.0, 60.0, "a damaged file may keep its reader busy for ever", _S
)
OWN_BYTES = HardLimit("bytes of a file of this program", 0, 64e6, "such files have kilobytes")
LINES_BYTES = HardLimit("bytes of kept answers", 0, 2e9, "they are read into memory")
