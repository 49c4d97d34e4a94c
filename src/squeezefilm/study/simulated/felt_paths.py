"""Percept of a finger's own path, by a study's surfaces and an observer's senses.

The path is one that a study recorded (`felt_in_trial`), or any other (`felt_on_path`). Every
surface that the study might have presented is felt along the same path, so that it is known which
of them the path tells from the one that was there. Nothing is tuned and nothing is random.
**Everything that comes out is simulated**: it is no evidence of what the person felt.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.formats.traces import table_from_csv
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import Result, stamp, to_json
from squeezefilm.physics.display import NamedDisplay, load_display
from squeezefilm.physics.perception.observer import (
    FingerClass,
    NamedObserver,
    Observer,
    load_observer,
)
from squeezefilm.physics.perception.path_percepts import PathPercept, RunPercept, path_percept
from squeezefilm.physics.perception.perceived import Perceived
from squeezefilm.physics.perception.percepts import Apparatus, grating_percept
from squeezefilm.physics.perception.senses import percept_deviation
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.plate.layout import AnnularStator
from squeezefilm.physics.render.motion.finger_path import FingerPath
from squeezefilm.physics.texture_files.texture_file import TextureFile
from squeezefilm.physics.texture_files.trajectories import motion_from
from squeezefilm.study.design.study_design import NamedDesign, StudyDesign
from squeezefilm.study.record.exploration import LONGEST_STEP, Exploration, exploration, touches
from squeezefilm.study.simulated.recalled import difference

_SAMPLE: si.Second = 2e-3
_KEPT = frozenset({"speed_m_per_s", "amplitude_m", "relative_friction"})
"""Columns of a study's own paths beside time and place."""


@dataclass(frozen=True, slots=True)
class Likeness:
    """Distance of a surface felt along the path from the one explored: `apart` in standard
    deviations of that difference (1), without noise; infinite where nothing was felt."""

    name: str
    apart: si.Dimensionless


@dataclass(frozen=True, eq=False, repr=False)
class FeltPath(Result):
    """Percept of a path over a surface.

    Attributes:
        design, observer: of the study, and whose senses.
        display: name of what rendered.
        stimulus: the surface explored.
        source: where the path is from.
        paths: the finger's, one for each touch.
        explored: how it went.
        finger: contact, moisture and force of the finger.
        force_is: whether the force was known, or is assumed.
        felt: evidence on runs along x and along y.
        nearest: the surfaces that could be answered, or that the study has, the likest first.
        compared_by: what they are compared by, in words.
        choice, answer: what the participant answered, and what was right; empty without.
        assumed: what this rests on, in sentences.
    """

    design: StudyDesign
    observer: Observer
    display: str
    stimulus: Stimulus
    source: str
    paths: tuple[FingerPath, ...]
    explored: Exploration
    finger: FingerClass
    force_is: str
    felt: PathPercept
    nearest: tuple[Likeness, ...]
    compared_by: str
    choice: str
    answer: str
    assumed: tuple[str, ...]
    _shown: ClassVar[str] = "design.name display stimulus.name source force_is"

    @property
    def directions(self) -> dict[str, RunPercept]:
        """Percepts along x and along y, where the path has runs."""
        both = {"along x": self.felt.along, "along y": self.felt.across}
        return {name: one for name, one in both.items() if one is not None}

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values; keys carry units."""
        found = {}
        for name, direction in self.directions.items():
            rhythms = direction.percept.candidates
            found[name] = {
                "runs": direction.runs,
                "way_m": direction.way,
                "mean_speed_m_per_s": direction.mean_speed,
                "friction_swing_asked": direction.asked_swing,
                "friction_swing_felt": direction.felt_swing,
                "rhythms": [
                    {"period_m": period, "d_prime": d}
                    for period, d in zip(rhythms.period, rhythms.d_prime, strict=True)
                    if math.isfinite(d)
                ],
                "felt": direction.clearest_d_prime > self.observer.detection_criterion,
            }
        values = {
            "origin": "simulated",
            "study": self.design.name,
            "display": self.display,
            "stimulus": self.stimulus.name,
            "surface": self.stimulus.kind,
            "surface_sha256": self.stimulus.surface_sha256,
            "source": self.source,
            "observer": self.observer.name,
            "normal_force_N": self.finger.normal_force,
            "normal_force_is": self.force_is,
            "explored": self.explored,
            "directions": found,
            "nearest": self.nearest,
            "compared_by": self.compared_by,
            "choice": self.choice,
            "answer": self.answer,
            "assumed": self.assumed,
            "provenance": stamp((self.design, self.observer, self.finger)),
        }
        plain: dict[str, Any] = to_json(values)
        return plain


@si.checked_numbers
@dataclass(frozen=True)
class FeltRequest:
    """Arguments of `felt_on_path`."""

    design: NamedDesign
    stimulus: str
    path: str | Path | FingerPath | Sequence[FingerPath]
    _: KW_ONLY
    observer: NamedObserver | None = None
    display: NamedDisplay | None = None
    normal_force: si.Newton | None = None
    source: str = ""
    choice: str = ""
    answer: str = ""
    progress: SayProgress | None = None


@reads_text
@called_with(FeltRequest)
def felt_on_path(asked: FeltRequest) -> FeltPath:
    """Percept of a path over one of a design's surfaces.

    Args:
        design: the study whose surfaces are compared.
        stimulus: the one explored.
        path: a CSV file (`time_s`, `x_m`, `y_m`; a `force_N` if it is known), a motion in words
            (`physics.texture_files.trajectories`), or paths, one for each touch.
        observer: whose senses; the preset "fingertip" if None.
        display: in place of the design's first.
        normal_force: (N); of the file, or the observer's median, which is assumed, if None.
        source: where the path is from, for people; the file's name if empty.
        choice, answer: what was answered, and what was right.
        progress: is told each surface.

    Raises:
        InputError: a name that is not known, a path without a straight run of 4 mm, or one that
            does not fit on the display.
        ConfigError: a file that is no path.
    """
    design, observer = asked.design, asked.observer or load_observer()
    plate = asked.display or load_display(design.displays[0])
    one, tell = design.stimulus(asked.stimulus), asked.progress or (lambda _: None)
    paths, in_file = _paths(asked.path)
    force, force_is = asked.normal_force, "known"
    if force is None and in_file is not None:
        force, force_is = in_file, "known: mean of the file's force_N"
    if force is None:
        force = observer.median_finger().normal_force
        force_is = "assumed: the observer's median"
    finger = observer.median_finger(normal_force=force)
    run = Apparatus()
    face = None if isinstance(plate.actuator, AnnularStator) else plate.actuator.extent

    def felt(stimulus: Stimulus) -> PathPercept:
        tell(stimulus.name)
        surface = TextureFile(stimulus.surface(), stimulus.name)
        return path_percept(plate, surface, observer, finger, paths, run)

    here = felt(one)
    if design.alternatives:
        nearest = _to_gratings(here, design, observer, finger)
    else:
        others = {other.name: other for other in (*design.stimuli, one)}
        nearest = [
            Likeness(name, _apart(here, here if other == one else felt(other), observer))
            for name, other in others.items()
        ]
    return FeltPath(
        design=design,
        observer=observer,
        display=plate.name,
        stimulus=one,
        source=asked.source or (str(asked.path) if isinstance(asked.path, str | Path) else ""),
        paths=paths,
        explored=_explored(paths, face),
        finger=finger,
        force_is=force_is,
        felt=here,
        nearest=tuple(sorted(nearest, key=lambda x: x.apart)),
        compared_by=(
            "the period of the clearest rhythm"
            if design.alternatives
            else "strength and period of the clearest rhythms in both directions"
        ),
        choice=asked.choice,
        answer=asked.answer,
        assumed=(
            "Contact length, moisture and orientation are those of the observer's median finger.",
            f"The normal force of {force:.3g} N is {force_is}.",
            "The loop sees the finger with the observer's sensor, and the skin is dragged along "
            "the path: what it does across it where the finger turns is left out.",
        ),
    )


def _paths(
    given: str | Path | FingerPath | Sequence[FingerPath],
) -> tuple[tuple[FingerPath, ...], si.Newton | None]:
    """Paths, and the mean force of a file that has one."""
    if isinstance(given, FingerPath):
        return (given,), None
    if not isinstance(given, str | Path):
        return tuple(given), None
    if isinstance(given, Path) or given.lower().endswith(".csv"):
        table = table_from_csv(given)
        more = set(table.columns) - {"time_s", "x_m", "y_m"}
        if more and more <= _KEPT | {"force_N"}:
            time, x, y = (table.column(name) for name in ("time_s", "x_m", "y_m"))
            # A file of one's own may have any step; a study's has its own, and lifts between.
            step = LONGEST_STEP if more & _KEPT else math.inf
            force = table.columns.get("force_N")
            exploration(time, x, y)
            if force is not None:
                si.require("force", force, si.Unit("N"), at_least=0.0)
            return touches(time, x, y, step), None if force is None else float(np.mean(force))
    motion = motion_from(given)
    if isinstance(motion, FingerPath):
        return (motion,), None
    times = np.append(np.arange(0.0, motion.duration, _SAMPLE), motion.duration)
    return (FingerPath(times, motion.position(times), np.zeros(times.size)),), None


def _explored(paths: tuple[FingerPath, ...], face: tuple[si.Metre, si.Metre] | None) -> Exploration:
    """An exploration of all touches, set one after another."""
    pause, now = 1.0, 0.0
    times: list[si.FloatArray] = []
    for path in paths:
        times.append(path.time + now)
        now = float(times[-1][-1]) + pause
    x, y = (np.concatenate([getattr(path, name) for path in paths]) for name in ("x", "y"))
    # Shifted times are rounded: a step must not become a lift by that.
    longest = max(float(np.diff(path.time).max()) for path in paths) * (1 + 1e-6)
    step = longest if len(paths) > 1 and longest < pause else math.inf
    return exploration(np.concatenate(times), x, y, face=face, longest_step=step)


def _perceived(felt: PathPercept, observer: Observer) -> Perceived:
    """Percept in each direction without noise; nothing where there is no run."""
    both = [felt.along, felt.across]
    strength = np.array([0.0 if percept is None else percept.clearest_d_prime for percept in both])
    period = [math.nan if percept is None else percept.clearest_period for percept in both]
    period = [1.0 if math.isnan(value) else value for value in period]
    return Perceived(np.log(period), strength, strength > observer.detection_criterion)


def _apart(path: PathPercept, other: PathPercept, observer: Observer) -> si.Dimensionless:
    spread = np.full(2, percept_deviation(observer.period_weber_fraction))
    here, there = _perceived(path, observer), _perceived(other, observer)
    return float(difference(here, there, np.ones(2), spread))


def _to_gratings(
    felt: PathPercept, design: StudyDesign, observer: Observer, finger: FingerClass
) -> list[Likeness]:
    """The real gratings by the period of the clearest rhythm in either direction, as simulated
    answers go; infinitely far where nothing was felt."""
    both = [percept for percept in (felt.along, felt.across) if percept is not None]
    best = max(both, key=lambda percept: percept.clearest_d_prime)
    spread = percept_deviation(observer.period_weber_fraction)
    likenesses = []
    for alternative in design.alternatives:
        touched = grating_percept(alternative, observer, finger).candidates
        apart = math.inf
        if best.clearest_d_prime > 0.0 and math.isfinite(touched.d_prime[0]):
            ratio = math.log(best.clearest_period / float(touched.period[0]))
            apart = abs(ratio) / (math.sqrt(2.0) * spread)
        likenesses.append(Likeness(alternative.name, apart))
    return likenesses
