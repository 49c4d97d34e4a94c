"""What every finger class gets of every surface of a study, and why a stimulus is confused: the
slow part, computed once and kept on disk.

Noise and decisions (`participants`, `judgements`) need only these tables, so ten thousand people
cost seconds.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import squeezefilm
from squeezefilm import quantities as si
from squeezefilm.display import Display, load_display
from squeezefilm.errors import InputError
from squeezefilm.kept_arrays import KeptArrays
from squeezefilm.perception.observer import FingerClass, Observer
from squeezefilm.perception.percepts import (
    Apparatus,
    Percept,
    along_way,
    grating_percept,
    percept,
)
from squeezefilm.perception.senses import Candidates, line_amplitudes, line_periods
from squeezefilm.perception.stimuli import Grating, Stimulus
from squeezefilm.progress import SayProgress
from squeezefilm.results import config_hash
from squeezefilm.second_process import is_present, later, second_process, values
from squeezefilm.study.design.study_design import StudyDesign

if TYPE_CHECKING:
    from squeezefilm.chain.rendered_texture import RenderAnalysis

_AT_ONCE = 3
"""Fingers that each of two processes has between two words of progress."""


@dataclass(frozen=True, slots=True)
class Causes:
    """What speaks against a stimulus being recognised (over several fingers: medians).

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


@dataclass(frozen=True, slots=True, eq=False)
class ChainTables:
    """Percepts of a study's surfaces before any noise.

    Attributes:
        design, observer: the inputs.
        fingers: the finger classes.
        apparatus: how each display was run, by the design's displays.
        virtual: candidates of shape (displays, fingers, stimuli, candidates).
        real: candidates of shape (fingers, alternatives, candidates); no alternatives but in a
            match-to-sample study.
        virtual_rhythm: evidence (d′) by period, shape (displays, fingers, stimuli, periods).
        real_rhythm: likewise, shape (fingers, alternatives, periods).
        causes: of each display and stimulus, one per finger.
        plates: the displays themselves, by the design's displays.
    """

    design: StudyDesign
    observer: Observer
    fingers: tuple[FingerClass, ...]
    apparatus: tuple[Apparatus, ...]
    virtual: Candidates
    real: Candidates
    virtual_rhythm: si.DimensionlessArray
    real_rhythm: si.DimensionlessArray
    causes: tuple[tuple[tuple[Causes, ...], ...], ...]
    plates: tuple[Display, ...] = ()

    def felt(self, display: int, finger: int, stimulus: Stimulus) -> Candidates:
        """Candidates of a surface that is not among the design's stimuli, such as a comparison
        that an adaptive method chose, shape (candidates,)."""
        found = _virtual(
            stimulus,
            self.plates[display],
            self.observer,
            self.fingers[finger],
            self.apparatus[display],
        )
        return found.candidates

    def explain(self, display: int = 0) -> dict[str, Causes]:
        """The reasons by stimulus on one of the displays: medians over fingers."""
        return {
            one.name: _median(found)
            for one, found in zip(self.design.stimuli, self.causes[display], strict=True)
        }


def chain_tables(
    design: StudyDesign,
    observer: Observer,
    apparatus: Apparatus | tuple[Apparatus, ...] | None = None,
    displays: tuple[Display, ...] | None = None,
    progress: SayProgress | None = None,
) -> ChainTables:
    """The chain for every display, finger class and surface.

    What was computed before is read from disk; of what was not, a second process computes a part.

    Args:
        design: the study; surfaces of its catch trials and adaptive series are felt when asked.
        observer: whose senses and fingers.
        apparatus: how displays are run: one for all, or one for each.
        displays: in place of those the design names, in its order.
        progress: is told each step.

    Raises:
        InputError: as many displays or apparatus as the design has not.
    """
    tell = progress or (lambda _: None)
    plates = tuple(load_display(one) for one in design.displays) if displays is None else displays
    runs = apparatus if isinstance(apparatus, tuple) else (apparatus or Apparatus(),) * len(plates)
    if len(plates) != len(design.displays) or len(runs) != len(plates):
        raise InputError(
            f"the design has {len(design.displays)} displays; {len(plates)} displays and "
            f"{len(runs)} apparatus were given"
        )
    fingers = observer.fingers()
    pieces: list[_Asked] = [
        *(
            _Asked(_virtual, design.stimuli, (plate, observer, one, run))
            for plate, run in zip(plates, runs, strict=True)
            for one in fingers
        ),
        *(_Asked(_real, design.alternatives, (observer, one)) for one in fingers),
    ]
    found = _found(pieces, tell)
    real, found = found[-len(fingers) :], found[: -len(fingers)]
    virtual = [found[k : k + len(fingers)] for k in range(0, len(found), len(fingers))]
    return ChainTables(
        design=design,
        observer=observer,
        fingers=fingers,
        apparatus=tuple(runs),
        plates=plates,
        virtual=_competing(virtual),
        real=_competing(real),
        virtual_rhythm=_gathered(virtual, lambda one: one.rhythm),
        real_rhythm=_gathered(real, lambda one: one.rhythm),
        causes=tuple(
            tuple(tuple(row[s].causes for row in by_finger) for s in range(len(design.stimuli)))
            for by_finger in virtual
        ),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Felt:
    """What the tables hold of one surface under one finger; a real grating has no causes."""

    candidates: Candidates
    rhythm: si.DimensionlessArray
    causes: Causes


_KEPT = KeptArrays("percepts", [Path(squeezefilm.__file__).parent])
_REASONS = len(dataclasses.fields(Causes))
_NO_CAUSES: Causes = Causes(*(math.nan,) * _REASONS)
_MOST_REMEMBERED = 8192
_REMEMBERED: dict[str, _Felt] = {}
"""What this process has met, by what was asked: where nothing is kept on disk, and to be quick."""


@dataclass(frozen=True, slots=True, eq=False)
class _Asked:
    """What one finger gets of several surfaces: `feel` of each with the `rest` of its inputs."""

    feel: Callable[..., _Felt]
    surfaces: tuple[Any, ...]
    rest: tuple[Any, ...]

    def known(self) -> list[_Felt] | None:
        """What was computed before; None unless all was."""
        count = next(one for one in self.rest if isinstance(one, Observer)).candidates
        found = [_known(_name(one, self.rest), count) for one in self.surfaces]
        return None if None in found else [one for one in found if one is not None]

    def remember(self, found: list[_Felt]) -> None:
        """What another process found need not be found, nor read, again."""
        for one, felt in zip(self.surfaces, found, strict=True):
            _remember(_name(one, self.rest), felt)


def _felt_of(feel: Callable[..., _Felt], surfaces: tuple[Any, ...], *rest: Any) -> list[_Felt]:
    return [feel(one, *rest) for one in surfaces]


def _found(asked: list[_Asked], tell: SayProgress) -> list[list[_Felt]]:
    """What each finger gets, what is not known yet by two processes."""
    found = [one.known() for one in asked]
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
    return [one for one in found if one is not None]


def _load() -> None:
    """What a second process needs before it takes fingers."""
    import_module("squeezefilm.chain.rendered_texture")


def _name(surface: Stimulus | Grating, rest: tuple[Any, ...]) -> str:
    """What is asked, as text: the surface, and all else that decides what is felt of it."""
    parts = " ".join(_hash(one) for one in rest)
    if isinstance(surface, Grating):
        return f"real {parts} {config_hash(surface)}"
    # Two kinds of texture may have the same numbers, and the text of an image leaves out pixels.
    texture = surface.surface()
    return f"{parts} {texture!r} {config_hash(texture)} {surface.period!r}"


def _known(asked: str, count: int) -> _Felt | None:
    """What was computed before: in this process, or by what is on disk."""
    if asked in _REMEMBERED:
        return _REMEMBERED[asked]
    lines = line_periods().size
    kept = _KEPT.get(asked, 2 * count + lines + _REASONS)
    if kept is None:
        return None
    parts = np.split(kept, np.cumsum([count, count, lines]))
    found = _Felt(Candidates(parts[0], parts[1]), parts[2], Causes(*parts[3].tolist()))
    _remember(asked, found)
    return found


def _remember(asked: str, found: _Felt) -> None:
    while len(_REMEMBERED) >= _MOST_REMEMBERED:
        del _REMEMBERED[next(iter(_REMEMBERED))]
    _REMEMBERED[asked] = found


def _keep(asked: str, found: _Felt) -> _Felt:
    one = found.candidates
    reasons = dataclasses.astuple(found.causes)
    _KEPT.put(asked, np.concatenate([one.period, one.d_prime, found.rhythm, reasons]))
    _remember(asked, found)
    return found


def _virtual(
    stimulus: Stimulus, display: Display, observer: Observer, finger: FingerClass, run: Apparatus
) -> _Felt:
    asked = _name(stimulus, (display, observer, finger, run))
    if (known := _known(asked, observer.candidates)) is not None:
        return known
    found, played = percept(display, stimulus, observer, finger, run)
    why = causes(stimulus, found, played, observer, finger)
    return _keep(asked, _Felt(found.candidates, found.evidence.rhythm, why))


def _real(grating: Grating, observer: Observer, finger: FingerClass) -> _Felt:
    asked = _name(grating, (observer, finger))
    if (known := _known(asked, observer.candidates)) is not None:
        return known
    found = grating_percept(grating, observer, finger)
    return _keep(asked, _Felt(found.candidates, found.evidence.rhythm, _NO_CAUSES))


@functools.lru_cache(maxsize=256)
def _hash(input: Display | Observer | FingerClass | Apparatus) -> str:
    return config_hash(input)


def _competing(tree: Any) -> Candidates:
    return Candidates(
        _gathered(tree, lambda one: one.candidates.period),
        _gathered(tree, lambda one: one.candidates.d_prime),
    )


def _gathered(tree: Any, part: Callable[[_Felt], si.FloatArray]) -> si.FloatArray:
    """One array of every percept in nested lists, which become its first axes."""

    def gather(one: Any) -> Any:
        return [gather(i) for i in one] if isinstance(one, list) else part(one)

    return np.array(gather(tree), dtype=float)


def _median(found: tuple[Causes, ...]) -> Causes:
    return Causes(
        **{
            field.name: float(np.median([getattr(one, field.name) for one in found]))
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
    period, loop = stimulus.period, played.stroke
    latency = 0.0 if loop.sensor is None else loop.sensor.latency
    lag = (latency + played.time_constant) * finger.speed
    rendered, asked = (
        _line(loop.position, values, observer, period)
        for values in (loop.relative_friction_rendered, played.asked)
    )
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
    """What the wave adds to the friction that the same amplitudes make over an antinode."""
    # A compensating renderer's inverse is of the driven amplitude, so there is no plain friction.
    if played.wave != "felt":
        return 0.0 if played.wave == "ignored" else float("nan")
    plain = played.prediction.friction(played.stroke.amplitude, played.finger.speed)
    added = float(np.std(played.stroke.relative_friction_rendered - plain))
    rest = float(np.std(plain))
    return added / (added + rest) if added + rest > 1e-9 else 0.0
