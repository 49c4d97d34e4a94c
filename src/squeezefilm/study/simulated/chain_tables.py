"""What every finger class gets of every surface of a study, and why a stimulus is confused: the
slow part, computed once and kept on disk.

Noise and decisions (`participants`, `judgements`) need only these tables, so ten thousand people
cost seconds.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import squeezefilm
from squeezefilm import quantities as si
from squeezefilm.display import Display, load_display
from squeezefilm.errors import InputError
from squeezefilm.kept_arrays import KeptArrays
from squeezefilm.perception.free_hand import free_exploration
from squeezefilm.perception.observer import FingerClass, Observer
from squeezefilm.perception.path_percepts import path_percept
from squeezefilm.perception.percepts import (
    Apparatus,
    grating_percept,
    percept,
)
from squeezefilm.perception.senses import Candidates, line_periods
from squeezefilm.perception.stimuli import Grating, Stimulus
from squeezefilm.plate.layout import AnnularStator
from squeezefilm.progress import SayProgress
from squeezefilm.render.motion.finger_path import FingerPath
from squeezefilm.results import config_hash
from squeezefilm.second_process import later, values
from squeezefilm.study.design.matching import Exploring
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.simulated.causes import Causes, causes, free_causes, median_causes
from squeezefilm.texture_file import TextureFile

_AT_ONCE = 6
"""Fingers between two words of progress: of fewer, one of two processes waits for the other."""


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
        across: of free exploration, candidates along y, in the shape of `virtual`, which are then
            those along x; None where people explore by strokes.
        across_rhythm: likewise, in the shape of `virtual_rhythm`.
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
    across: Candidates | None = None
    across_rhythm: si.DimensionlessArray | None = None

    def felt(self, display: int, finger: int, stimulus: Stimulus) -> Candidates:
        """Candidates of a surface that is not among the design's stimuli, such as a comparison
        that an adaptive method chose, shape (candidates,); of free exploration (2, candidates),
        along x and along y."""
        (found,) = _of_finger(
            self.plates[display],
            (stimulus,),
            self.observer,
            self.fingers[finger],
            self.apparatus[display],
            self.design.exploring,
        )
        one, other = found.candidates, found.across
        if other is None:
            return one
        return Candidates(
            np.stack([one.period, other.period]), np.stack([one.d_prime, other.d_prime])
        )

    @property
    def directions(self) -> Candidates:
        """Candidates with an axis for the directions in which they were felt, shape (displays,
        fingers, stimuli, directions, candidates): one of strokes, two of free exploration."""
        every = [self.virtual] if self.across is None else [self.virtual, self.across]
        return Candidates(
            np.stack([one.period for one in every], axis=-2),
            np.stack([one.d_prime for one in every], axis=-2),
        )

    def explain(self, display: int = 0) -> dict[str, Causes]:
        """The reasons by stimulus on one of the displays: medians over fingers."""
        return {
            one.name: median_causes(found)
            for one, found in zip(self.design.stimuli, self.causes[display], strict=True)
        }


def chain_tables(
    design: StudyDesign,
    observer: Observer,
    apparatus: Apparatus | tuple[Apparatus, ...] | None = None,
    displays: tuple[Display, ...] | None = None,
    progress: SayProgress | None = None,
) -> ChainTables:
    """The chain for every display, finger class and surface; cached within the process.

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
    real = [[_real(one, observer, finger) for one in design.alternatives] for finger in fingers]
    pieces = [
        later(_of_finger, plate, design.stimuli, observer, one, run, design.exploring)
        for plate, run in zip(plates, runs, strict=True)
        for one in fingers
    ]
    found: list[list[_Felt]] = []
    for first in range(0, len(pieces), _AT_ONCE):
        plate, number = plates[first // len(fingers)], first % len(fingers)
        tell(f"{plate.name}: finger {number + 1} of {len(fingers)}")
        found += values(*pieces[first : first + _AT_ONCE])
    virtual = [found[k : k + len(fingers)] for k in range(0, len(found), len(fingers))]
    free = design.exploring == "free"
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
        across=_competing(virtual, _across) if free else None,
        across_rhythm=_gathered(virtual, lambda one: one.across_rhythm) if free else None,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Felt:
    """What the tables hold of one surface under one finger; a real grating has no causes, and one
    that strokes explore nothing across."""

    candidates: Candidates
    rhythm: si.DimensionlessArray
    causes: Causes
    across: Candidates | None = None
    across_rhythm: si.DimensionlessArray | None = None


def _of_finger(
    plate: Display,
    stimuli: tuple[Stimulus, ...],
    observer: Observer,
    finger: FingerClass,
    run: Apparatus,
    exploring: Exploring,
) -> list[_Felt]:
    felt = _free if exploring == "free" else _virtual
    return [felt(plate, one, observer, finger, run) for one in stimuli]


_KEPT = KeptArrays("percepts", [Path(squeezefilm.__file__).parent])
_REASONS = len(dataclasses.fields(Causes))
_NO_CAUSES: Causes = Causes(*(math.nan,) * _REASONS)


@functools.lru_cache(maxsize=4096)
def _virtual(
    display: Display, stimulus: Stimulus, observer: Observer, finger: FingerClass, run: Apparatus
) -> _Felt:
    surface = stimulus.surface()
    # Two kinds of texture may have the same numbers, and the text of an image leaves out pixels.
    asked = f"{_hash((display, observer, finger, run))} {surface!r} {config_hash(surface)} "
    asked += repr(stimulus.period)
    count, lines = observer.candidates, line_periods().size
    kept = _KEPT.get(asked, 2 * count + lines + _REASONS)
    if kept is not None:
        parts = np.split(kept, np.cumsum([count, count, lines]))
        return _Felt(Candidates(parts[0], parts[1]), parts[2], Causes(*parts[3].tolist()))
    found, played = percept(display, stimulus, observer, finger, run)
    why = causes(stimulus, found, played, observer, finger)
    one, rhythm = found.candidates, found.evidence.rhythm
    _KEPT.put(asked, np.concatenate([one.period, one.d_prime, rhythm, dataclasses.astuple(why)]))
    return _Felt(one, rhythm, why)


@functools.lru_cache(maxsize=4096)
def _free(
    display: Display, stimulus: Stimulus, observer: Observer, finger: FingerClass, run: Apparatus
) -> _Felt:
    """The same of a plain hand that explores the face freely; not kept on disk."""
    path = free_path(display, observer, finger)
    surface = TextureFile(stimulus.surface(), stimulus.name)
    found = path_percept(display, surface, observer, finger, [path], run)
    # The hand sweeps both ways, on lines far longer than the shortest run.
    assert found.along is not None
    assert found.across is not None
    one, other = found.along, found.across
    clearer = max(one, other, key=lambda run: run.clearest_d_prime)
    return _Felt(
        one.percept.candidates,
        one.percept.evidence.rhythm,
        free_causes(stimulus, clearer, found.played[0], finger),
        other.percept.candidates,
        other.percept.evidence.rhythm,
    )


def free_path(display: Display, observer: Observer, finger: FingerClass) -> FingerPath:
    """How a finger explores a display freely. Raises `InputError` for a ring: it has no plane."""
    plate = display.actuator
    if isinstance(plate, AnnularStator):
        raise InputError(
            f"display '{display.name}' is a ring, and its finger goes along its circumference; for "
            'exploring = "free" take a plate, or take exploring = "strokes"',
            quantity="exploring",
        )
    return free_exploration(observer, finger, plate.extent)


@functools.lru_cache(maxsize=256)
def _hash(inputs: tuple[Display, Observer, FingerClass, Apparatus]) -> str:
    return config_hash(inputs)


@functools.lru_cache(maxsize=4096)
def _real(grating: Grating, observer: Observer, finger: FingerClass) -> _Felt:
    found = grating_percept(grating, observer, finger)
    return _Felt(found.candidates, found.evidence.rhythm, _NO_CAUSES)


def _along(felt: _Felt) -> Candidates:
    return felt.candidates


def _across(felt: _Felt) -> Candidates:
    assert felt.across is not None
    return felt.across


def _competing(tree: Any, which: Callable[[_Felt], Candidates] = _along) -> Candidates:
    return Candidates(
        _gathered(tree, lambda one: which(one).period),
        _gathered(tree, lambda one: which(one).d_prime),
    )


def _gathered(tree: Any, part: Callable[[_Felt], si.FloatArray | None]) -> si.FloatArray:
    """One array of every percept in nested lists, which become its first axes."""

    def gather(one: Any) -> Any:
        return [gather(i) for i in one] if isinstance(one, list) else part(one)

    return np.array(gather(tree), dtype=float)
