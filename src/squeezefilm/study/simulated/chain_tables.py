"""Surfaces of a study as every finger class gets them, and why a stimulus is confused: the slow
part, computed once and kept on disk.

Noise and decisions (`participants`, `judgements`) need only these tables, so ten thousand people
cost seconds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import config_hash
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.percepts import Apparatus
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.simulated.felt_surfaces import (
    Asked,
    Causes,
    FeltSurface,
    felt_by_strokes,
    felt_freely,
    felt_really,
    felt_surfaces,
    median_causes,
)


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

    @property
    def asked(self) -> str:
        """Text of what simulated answers follow from, but for people and seed: it names them."""
        design = self.design
        surfaces = [*design.stimuli, *(trial.stimulus for trial in design.catch)]
        # Two kinds of texture may have the same numbers, and the text of an image has no pixels.
        return " ".join(
            [
                *map(config_hash, (design, self.observer, *self.plates, *self.apparatus)),
                *(f"{surface.surface()!r} {surface.surface_sha256}" for surface in surfaces),
            ]
        )

    @property
    def whose_finger(self) -> str:
        """Words for whose finger the displays are under."""
        return "; ".join(dict.fromkeys(plate.whose_finger for plate in self.plates))

    def felt(self, display: int, finger: int, stimulus: Stimulus) -> Candidates:
        """Candidates of a surface that is not among the design's stimuli, such as a comparison
        that an adaptive method chose, shape (candidates,); of free exploration (2, candidates),
        along x and along y."""
        feel = felt_freely if self.design.exploring == "free" else felt_by_strokes
        found = feel(
            stimulus,
            self.plates[display],
            self.observer,
            self.fingers[finger],
            self.apparatus[display],
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
            np.stack([surface.period for surface in every], axis=-2),
            np.stack([surface.d_prime for surface in every], axis=-2),
        )

    def explain(self, display: int = 0) -> dict[str, Causes]:
        """The reasons by stimulus on one of the displays: medians over fingers."""
        return {
            stimulus.name: median_causes(found)
            for stimulus, found in zip(self.design.stimuli, self.causes[display], strict=True)
        }


def chain_tables(
    design: StudyDesign,
    observer: Observer,
    apparatus: Apparatus | tuple[Apparatus, ...] | None = None,
    displays: tuple[Display, ...] | None = None,
    finger: str | Path = "new",
    progress: SayProgress | None = None,
) -> ChainTables:
    """The chain for every display, finger class and surface.

    What was computed before is read from disk; of what was not, a second process computes a part.

    Args:
        design: the study; surfaces of its catch trials and adaptive series are felt when asked.
        observer: whose senses and fingers.
        apparatus: how displays are run: one for all, or one for each.
        displays: in place of those the design names, in its order.
        finger: whose finger those that the design names are under, see `with_finger`.
        progress: is told each step.

    Raises:
        InputError: as many displays or apparatus as the design has not.
    """
    tell = progress or (lambda _: None)
    plates = displays
    if plates is None:
        plates = tuple(load_display(name) for name in design.displays)
        if finger != "new":
            # Recordings are read, which what was felt before needs no code for.
            from squeezefilm.measure.fits.friction.person import with_finger

            plates = tuple(with_finger(plate, finger) for plate in plates)
    runs = apparatus if isinstance(apparatus, tuple) else (apparatus or Apparatus(),) * len(plates)
    if len(plates) != len(design.displays) or len(runs) != len(plates):
        raise InputError(
            f"the design has {len(design.displays)} displays; {len(plates)} displays and "
            f"{len(runs)} apparatus were given"
        )
    fingers = observer.fingers()
    free = design.exploring == "free"
    feel = felt_freely if free else felt_by_strokes
    pieces: list[Asked] = [
        *(
            Asked(feel, design.stimuli, (plate, observer, one, run))
            for plate, run in zip(plates, runs, strict=True)
            for one in fingers
        ),
        *(Asked(felt_really, design.alternatives, (observer, one)) for one in fingers),
    ]
    found = felt_surfaces(pieces, tell)
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
        across=_competing(virtual, _across) if free else None,
        across_rhythm=_gathered(virtual, lambda one: one.across_rhythm) if free else None,
    )


def _across(felt: FeltSurface) -> Candidates:
    assert felt.across is not None
    return felt.across


def _competing(
    tree: Any, which: Callable[[FeltSurface], Candidates] = lambda felt: felt.candidates
) -> Candidates:
    return Candidates(
        _gathered(tree, lambda one: which(one).period),
        _gathered(tree, lambda one: which(one).d_prime),
    )


def _gathered(tree: Any, part: Callable[[FeltSurface], si.FloatArray | None]) -> si.FloatArray:
    """An array of every percept in nested lists, which become its first axes."""

    def gather(one: Any) -> Any:
        return [gather(i) for i in one] if isinstance(one, list) else part(one)

    return np.array(gather(tree), dtype=float)
