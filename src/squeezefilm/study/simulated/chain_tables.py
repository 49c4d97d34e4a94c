"""Percepts of a study's surfaces under every finger class: the slow part, computed once and kept.

Noise and decisions (`participants`, `judgements`) need only these tables, so ten thousand people
cost seconds.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import config_hash
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.path_percepts import SAYS
from squeezefilm.physics.perception.percepts import (
    Apparatus,
    Perceived,
    grating_percept,
    perceived_anew,
    percept,
)
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.design.rules import Exploring
from squeezefilm.study.design.study_design import StudyDesign

if TYPE_CHECKING:
    from squeezefilm.physics.render.motion.stroke import FingerPath

_KEPT: Kept[Candidates] = Kept("percepts", Candidates)
_MOST_REMEMBERED = 8192
_REMEMBERED: dict[str, Candidates] = {}
"""Percepts that this process has met, by request: to be quick, and where no disk keeps them."""


def _known(
    how: str,
    surface: Stimulus | Grating,
    rest: tuple[Any, ...],
    make: Callable[[], Candidates],
) -> Candidates:
    """Percept computed before, in this process or by what is on disk, or made now. It is asked for
    by how it is felt, the surface, and the `rest` of what decides."""
    asked = f"{how} {' '.join(_hash(part) for part in rest)} {_name(surface)}"
    if asked not in _REMEMBERED:
        while len(_REMEMBERED) >= _MOST_REMEMBERED:
            del _REMEMBERED[next(iter(_REMEMBERED))]
        _REMEMBERED[asked] = _KEPT.found(asked, make)
    return _REMEMBERED[asked]


def _name(surface: Stimulus | Grating) -> str:
    if isinstance(surface, Grating):
        return config_hash(surface)
    # Two kinds of texture may have the same numbers, and the text of an image leaves out pixels.
    texture = surface.surface()
    return f"{texture!r} {config_hash(texture)} {surface.period!r}"


def felt_virtually(
    exploring: Exploring,
    stimulus: Stimulus,
    display: Display,
    observer: Observer,
    finger: FingerClass,
    run: Apparatus,
) -> Candidates:
    """A virtual surface, shape (directions, candidates): along x under strokes; along x and along
    y under a plain hand that explores the face freely."""

    def make() -> Candidates:
        if exploring == "strokes":
            strokes, _ = percept(display, stimulus, observer, finger, run)
            return Candidates(strokes.candidates.period[None], strokes.candidates.d_prime[None])
        from squeezefilm.physics.perception.path_percepts import path_percept
        from squeezefilm.physics.texture_files.texture_file import TextureFile

        path = free_path(display, observer, finger)
        surface = TextureFile(stimulus.surface(), stimulus.name)
        found = path_percept(display, surface, observer, finger, [path], run)
        # The hand sweeps both ways, on lines far longer than the shortest run.
        assert found.along is not None
        assert found.across is not None
        ways = found.along.candidates, found.across.candidates
        return Candidates(
            np.stack([felt.period for felt in ways]), np.stack([felt.d_prime for felt in ways])
        )

    return _known(exploring, stimulus, (display, observer, finger, run), make)


def felt_really(grating: Grating, observer: Observer, finger: FingerClass) -> Candidates:
    """A real grating, shape (candidates,)."""
    return _known(
        "really",
        grating,
        (observer, finger),
        lambda: grating_percept(grating, observer, finger).candidates,
    )


def free_path(display: Display, observer: Observer, finger: FingerClass) -> FingerPath:
    """Path of a finger that explores a display freely. Raises `InputError` for a ring."""
    from squeezefilm.physics.perception.path_percepts import free_exploration
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


@dataclass(frozen=True, slots=True, eq=False)
class ChainTables:
    """Percepts of a study's surfaces before any noise.

    Attributes:
        design, observer: the inputs.
        fingers: the finger classes.
        apparatus: how each display was run, by the design's displays.
        virtual: candidates of shape (displays, fingers, stimuli, directions, candidates): in one
            direction of strokes, in two (along x and along y) of free exploration.
        real: candidates of shape (fingers, alternatives, candidates); no alternatives but in a
            match-to-sample study.
        plates: the displays themselves, by the design's displays.
    """

    design: StudyDesign
    observer: Observer
    fingers: tuple[FingerClass, ...]
    apparatus: tuple[Apparatus, ...]
    virtual: Candidates
    real: Candidates
    plates: tuple[Display, ...] = ()

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
        that an adaptive method chose, shape (directions, candidates)."""
        return felt_virtually(
            self.design.exploring,
            stimulus,
            self.plates[display],
            self.observer,
            self.fingers[finger],
            self.apparatus[display],
        )


def chain_tables(
    design: StudyDesign,
    observer: Observer,
    apparatus: Apparatus | tuple[Apparatus, ...] | None = None,
    displays: tuple[Display, ...] | None = None,
    finger: str | Path = "new",
    progress: SayProgress | None = None,
) -> ChainTables:
    """The chain for every display, finger class and surface.

    What was computed before is read from disk.

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
            from squeezefilm.measure.fits.friction.friction_scores import with_finger

            plates = tuple(with_finger(plate, finger) for plate in plates)
    runs = apparatus if isinstance(apparatus, tuple) else (apparatus or Apparatus(),) * len(plates)
    if len(plates) != len(design.displays) or len(runs) != len(plates):
        raise InputError(
            f"the design has {len(design.displays)} displays; {len(plates)} displays and "
            f"{len(runs)} apparatus were given"
        )
    fingers = observer.fingers()
    virtual, real = [], []
    with one_blas_thread():
        for plate, run in zip(plates, runs, strict=True):
            under = []
            for number, finger_class in enumerate(fingers, 1):
                tell(f"what fingers feel on {plate.name}: {number} of {len(fingers)}")
                decided = plate, observer, finger_class, run
                under.append(
                    [felt_virtually(design.exploring, each, *decided) for each in design.stimuli]
                )
            virtual.append(under)
        for finger_class in fingers:
            real.append([felt_really(each, observer, finger_class) for each in design.alternatives])
    return ChainTables(
        design=design,
        observer=observer,
        fingers=fingers,
        apparatus=tuple(runs),
        plates=plates,
        virtual=Candidates(
            np.array([[[felt.period for felt in row] for row in rows] for rows in virtual]),
            np.array([[[felt.d_prime for felt in row] for row in rows] for rows in virtual]),
        ),
        real=Candidates(
            np.array([[felt.period for felt in row] for row in real]),
            np.array([[felt.d_prime for felt in row] for row in real]),
        ),
    )


# A surface is perceived in each direction in which it was explored
# (`physics.perception.percepts`): how evident its clearest rhythm is, and with which period. Two
# percepts differ, in standard deviations of that difference, by the strengths in every direction
# and by the periods where both have one that is felt. A person who knows the stimuli by name
# recalls each as if it were felt again, with noise of its own, and names the one that differs
# least. None of that was measured or tuned: `assumed` says what answers to a design rest on.
ASSUMED = (
    "Each stimulus is recalled as if it were felt again, and the answer is the one that differs "
    "least: by how evident the clearest rhythm is in each direction, and by its period where both "
    "are felt, in standard deviations.",
    "The senses know rhythms and how evident they are, and not where on the face something lies.",
)
"""Assumptions of answers by likeness, in sentences that results repeat."""


def difference(
    one: Perceived, other: Perceived, skill: si.DimensionlessArray, spread: si.DimensionlessArray
) -> si.DimensionlessArray:
    """Distance between two percepts in standard deviations, summed over the last axis (directions).

    Args:
        one, other: of shapes (…, directions) that broadcast.
        skill: by what noise is more than a practised person's (1), of their shape.
        spread: σ of a clear rhythm's ln period (1), likewise.
    """
    strengths = np.maximum(one.strength, 0.0) - np.maximum(other.strength, 0.0)
    periods = np.where(one.felt & other.felt, (one.log_period - other.log_period) / spread, 0.0)
    apart = np.sqrt(np.sum((strengths**2 + periods**2) / (2.0 * skill**2), axis=-1))
    return np.asarray(apart)


def recalled_distances(
    tables: ChainTables,
    display: si.IntArray,
    finger: si.IntArray,
    stimulus: si.IntArray,
    skill: si.DimensionlessArray,
    spread: si.DimensionlessArray,
    random: np.random.Generator,
    drawn: int,
) -> tuple[si.DimensionlessArray, NDArray[np.bool_]]:
    """Distance of each trial's surface from every stimulus recalled, shape (people, trials,
    stimuli), and whether anything was felt of it, shape (people, trials).

    Args:
        tables: what everybody gets.
        display, stimulus: numbers of what was presented, shape (people, trials).
        finger: class of each person, shape (people,).
        skill, spread: as in `difference`, shapes (people, trials) and (people, 1).
        random: of the noise.
        drawn: people whose noise is drawn, so that nobody depends on how many there are.
    """
    found, observer = tables.virtual, tables.observer

    def felt(rows: tuple[si.IntArray, ...], deep: int) -> Perceived:
        surface = Candidates(found.period[rows], found.d_prime[rows])
        own = (slice(None), slice(None), *(None,) * deep)
        return perceived_anew(surface, observer, skill[own], spread[own], random, drawn)

    now = felt((display, finger[:, None], stimulus), 1)
    then = felt((display, finger[:, None]), 2)
    shown = Perceived(now.log_period[:, :, None], now.strength[:, :, None], now.felt[:, :, None])
    own = (slice(None), slice(None), None, None)
    anything: NDArray[np.bool_] = np.any(now.felt, axis=-1, keepdims=True)[..., 0]
    return difference(shown, then, skill[own], spread[own]), anything


def assumed(design: StudyDesign) -> tuple[str, ...]:
    """Assumptions of the simulated answers to a design, beyond the observer's own file."""
    task = design.described
    found = task.assumed
    if design.exploring == "free":
        found = (SAYS, *(found if design.task != "same-different" else ()), *task.in_plane)
    return (*found, *(ASSUMED if design.matched_with == "stimuli" else ()))
