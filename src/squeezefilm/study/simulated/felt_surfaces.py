"""Percepts of surfaces under fingers, and causes of confusion: felt once, kept on disk, and shared
by two processes."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import config_hash
from squeezefilm.core.second_process import is_present, later, second_process, values
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.percepts import (
    Apparatus,
    Percept,
    along_way,
    grating_percept,
    percept,
)
from squeezefilm.physics.perception.senses import Candidates, line_amplitudes, line_periods
from squeezefilm.physics.perception.stimuli import Grating, Stimulus

if TYPE_CHECKING:
    from squeezefilm.physics.chain.rendered_texture import RenderAnalysis
    from squeezefilm.physics.perception.path_percepts import RunPercept
    from squeezefilm.physics.render.motion.finger_path import FingerPath

_AT_ONCE = 12
"""Fingers that each of two processes has between two words of progress."""


@dataclass(frozen=True, slots=True)
class Causes:
    """Causes against a stimulus being recognised (over several fingers: medians).

    Attributes:
        texture_frequency: at which it passes the finger at mean speed (Hz).
        envelope_bandwidth: at which the display's envelope has lost 3 dB (Hz).
        contrast_kept: line of the friction rendered over that asked for, at the period (1); the
            standing wave's ripple may raise it above 1. NaN without a contrast asked for.
        lag_over_period: way of the finger during the sensor's latency and the envelope's time
            constant, over the period (1).
        contact_over_period: length of the contact over the period (1).
        ripple_share: friction's standard deviation that the standing wave adds over that and the
            rest together (1); 0 where the wave is ignored, NaN where it is compensated.
        mean_displacement: of the skin (m).
        d_prime: evidence for the rhythm of the period (1).
        clearest_period: most evident rhythm (m).
        clearest_d_prime: its evidence (1).
    """

    texture_frequency: si.Hertz
    envelope_bandwidth: si.Hertz
    contrast_kept: si.Dimensionless
    lag_over_period: si.Dimensionless
    contact_over_period: si.Dimensionless
    ripple_share: si.Dimensionless
    mean_displacement: si.Metre
    d_prime: si.Dimensionless
    clearest_period: si.Metre
    clearest_d_prime: si.Dimensionless


def median_causes(of_fingers: tuple[Causes, ...]) -> Causes:
    """The medians over several fingers."""
    return Causes(
        **{
            field.name: float(np.median([getattr(finger, field.name) for finger in of_fingers]))
            for field in dataclasses.fields(Causes)
        }
    )


def causes(
    stimulus: Stimulus,
    found: Percept,
    played: RenderAnalysis,
    observer: Observer,
    finger: FingerClass,
) -> Causes:
    """The numbers of one percept of a virtual grating; `played` is its rendering."""
    loop = played.stroke
    rendered, asked = (
        _line(loop.position, values, observer, stimulus.period)
        for values in (loop.relative_friction_rendered, played.asked)
    )
    return _causes(stimulus, found, played, finger, rendered, asked)


def free_causes(
    stimulus: Stimulus, runs: RunPercept, played: RenderAnalysis, finger: FingerClass
) -> Causes:
    """The same of the runs of a free exploration in one direction; `contrast_kept` is of the whole
    swing of friction, for a shape has no line of its own."""
    return _causes(stimulus, runs.percept, played, finger, runs.felt_swing, runs.asked_swing)


def _causes(
    stimulus: Stimulus,
    found: Percept,
    played: RenderAnalysis,
    finger: FingerClass,
    rendered: si.Dimensionless,
    asked: si.Dimensionless,
) -> Causes:
    period, sensor = stimulus.period, played.stroke.sensor
    latency = 0.0 if sensor is None else sensor.latency
    lag = (latency + played.time_constant) * finger.speed
    return Causes(
        texture_frequency=finger.speed / period,
        envelope_bandwidth=1.0 / (2.0 * math.pi * played.time_constant),
        contrast_kept=rendered / asked if asked > 1e-6 else float("nan"),
        lag_over_period=lag / period,
        contact_over_period=finger.contact_length / period,
        ripple_share=_ripple_share(played),
        mean_displacement=found.mean_displacement,
        d_prime=found.evidence.at(period),
        clearest_period=float(found.candidates.period[0]),
        clearest_d_prime=max(float(found.candidates.d_prime[0]), 0.0),
    )


def _line(way: si.FloatArray, values: si.FloatArray, observer: Observer, period: si.Metre) -> float:
    periods = line_periods()
    # What lies beside the period is all that is asked.
    at = int(np.searchsorted(periods, period))
    near = slice(max(at - 1, 0), at + 1)
    lines = line_amplitudes(along_way(way, values, observer, (1.0, 1.0)), near)
    return float(np.interp(period, periods[near], lines))


def _ripple_share(played: RenderAnalysis) -> si.Dimensionless:
    """Contribution of the wave to the friction that the same amplitudes make over an antinode."""
    # A compensating renderer's inverse is of the driven amplitude, so there is no plain friction.
    if played.wave != "felt":
        return 0.0 if played.wave == "ignored" else float("nan")
    plain = played.prediction.friction(played.stroke.amplitude, played.finger.speed)
    added = float(np.std(played.stroke.relative_friction_rendered - plain))
    rest = float(np.std(plain))
    return added / (added + rest) if added + rest > 1e-9 else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class FeltSurface:
    """Percept of a surface under a finger: candidates and evidence by period, of free exploration
    along x, and `across` along y; why it may be confused (a real grating has no causes)."""

    candidates: Candidates
    rhythm: si.DimensionlessArray
    causes: Causes
    across: Candidates | None = None
    across_rhythm: si.DimensionlessArray | None = None


_KEPT: Kept[FeltSurface] = Kept("percepts", FeltSurface)
_NO_CAUSES: Causes = Causes(*(math.nan,) * len(dataclasses.fields(Causes)))
_MOST_REMEMBERED = 8192
_REMEMBERED: dict[str, FeltSurface] = {}
"""Percepts that this process has met, by request: to be quick, and where no disk keeps them."""


@dataclass(frozen=True, slots=True, eq=False)
class Asked:
    """Request for percepts of surfaces under a finger: `feel` of each, `rest` of its inputs."""

    feel: Callable[..., FeltSurface]
    surfaces: tuple[Any, ...]
    rest: tuple[Any, ...]

    def known(self) -> list[FeltSurface] | None:
        """Percepts computed before; None unless all was."""
        percepts = [_known(_name(self.feel, surface, self.rest)) for surface in self.surfaces]
        return None if None in percepts else [one for one in percepts if one is not None]

    def remember(self, percepts: list[FeltSurface]) -> None:
        """Keep percepts of another process, which need not be computed nor read again."""
        for surface, felt in zip(self.surfaces, percepts, strict=True):
            _remember(_name(self.feel, surface, self.rest), felt)


def _felt_of(
    feel: Callable[..., FeltSurface], surfaces: tuple[Any, ...], *rest: Any
) -> list[FeltSurface]:
    return [feel(surface, *rest) for surface in surfaces]


def felt_surfaces(asked: list[Asked], tell: SayProgress) -> list[list[FeltSurface]]:
    """Percepts of each finger; two processes compute what is not known yet."""
    found = [request.known() for request in asked]
    lacking = [at for at, known in enumerate(found) if known is None]
    with contextlib.ExitStack() as stack:
        # One that is started when nothing lacks would still be loading when all is done.
        if lacking and not is_present():
            stack.enter_context(second_process(_load))
        half = -(-len(lacking) // 2)
        for first in range(0, half, _AT_ONCE):
            # One process begins with the first, the other with the last: of two displays each
            # solves one.
            now = lacking[:half][first : first + _AT_ONCE]
            now += lacking[half:][first : first + _AT_ONCE]
            tell(f"what fingers feel: {2 * first + 1} of {len(lacking)}")
            pieces = [
                later(_felt_of, asked[at].feel, asked[at].surfaces, *asked[at].rest) for at in now
            ]
            for at, felt in zip(now, values(*pieces), strict=True):
                found[at] = felt
                asked[at].remember(felt)
    return [known for known in found if known is not None]


def _load() -> None:
    """Load the modules that a second process needs before it takes fingers."""
    import squeezefilm.physics.chain.rendered_texture  # noqa: F401


def _name(feel: Callable[..., FeltSurface], surface: Stimulus | Grating, rest: Any) -> str:
    """Text of a request: how, the surface, and all else that decides what is felt of it."""
    parts = " ".join(_hash(part) for part in rest)
    if isinstance(surface, Grating):
        return f"{feel.__name__} {parts} {config_hash(surface)}"
    # Two kinds of texture may have the same numbers, and the text of an image leaves out pixels.
    texture = surface.surface()
    return f"{feel.__name__} {parts} {texture!r} {config_hash(texture)} {surface.period!r}"


def _known(asked: str) -> FeltSurface | None:
    """Percept computed before: in this process, or by what is on disk."""
    if asked not in _REMEMBERED and (kept := _KEPT.get(asked)) is not None:
        _remember(asked, kept)
    return _REMEMBERED.get(asked)


def _remember(asked: str, found: FeltSurface) -> None:
    while len(_REMEMBERED) >= _MOST_REMEMBERED:
        del _REMEMBERED[next(iter(_REMEMBERED))]
    _REMEMBERED[asked] = found


def _keep(asked: str, found: FeltSurface) -> FeltSurface:
    _KEPT.put(asked, found)
    _remember(asked, found)
    return found


def felt_by_strokes(
    stimulus: Stimulus, display: Display, observer: Observer, finger: FingerClass, run: Apparatus
) -> FeltSurface:
    """A virtual surface under strokes along x."""
    asked = _name(felt_by_strokes, stimulus, (display, observer, finger, run))
    if (known := _known(asked)) is not None:
        return known
    found, played = percept(display, stimulus, observer, finger, run)
    why = causes(stimulus, found, played, observer, finger)
    return _keep(asked, FeltSurface(found.candidates, found.evidence.rhythm, why))


def felt_freely(
    stimulus: Stimulus, display: Display, observer: Observer, finger: FingerClass, run: Apparatus
) -> FeltSurface:
    """A virtual surface under a plain hand that explores the face freely."""
    asked = _name(felt_freely, stimulus, (display, observer, finger, run))
    if (known := _known(asked)) is not None:
        return known
    from squeezefilm.physics.perception.path_percepts import path_percept
    from squeezefilm.physics.texture_files.texture_file import TextureFile

    path = free_path(display, observer, finger)
    surface = TextureFile(stimulus.surface(), stimulus.name)
    found = path_percept(display, surface, observer, finger, [path], run)
    # The hand sweeps both ways, on lines far longer than the shortest run.
    assert found.along is not None
    assert found.across is not None
    one, other = found.along, found.across
    clearer = max(one, other, key=lambda run: run.clearest_d_prime)
    felt = FeltSurface(
        one.percept.candidates,
        one.percept.evidence.rhythm,
        free_causes(stimulus, clearer, found.played[0], finger),
        other.percept.candidates,
        other.percept.evidence.rhythm,
    )
    return _keep(asked, felt)


def felt_really(grating: Grating, observer: Observer, finger: FingerClass) -> FeltSurface:
    """A real grating."""
    asked = _name(felt_really, grating, (observer, finger))
    if (known := _known(asked)) is not None:
        return known
    found = grating_percept(grating, observer, finger)
    return _keep(asked, FeltSurface(found.candidates, found.evidence.rhythm, _NO_CAUSES))


def free_path(display: Display, observer: Observer, finger: FingerClass) -> FingerPath:
    """Path of a finger that explores a display freely. Raises `InputError` for a ring."""
    from squeezefilm.physics.perception.free_hand import free_exploration
    from squeezefilm.physics.plate.layout import AnnularStator

    plate = display.actuator
    if isinstance(plate, AnnularStator):
        raise InputError(
            f"display '{display.name}' is a ring, and its finger goes along its circumference; for "
            'exploring = "free" take a plate, or take exploring = "strokes"',
            quantity="exploring",
        )
    return free_exploration(observer, finger, plate.extent)


@functools.lru_cache(maxsize=256)
def _hash(input: Display | Observer | FingerClass | Apparatus) -> str:
    return config_hash(input)
