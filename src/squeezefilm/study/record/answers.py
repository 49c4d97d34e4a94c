"""Answers as arrays, one row a trial: what analyses start from, whoever answered."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.design.tasks.task import DifferenceModel
from squeezefilm.study.record.exploration import MEASURES
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import (
    SURFACES,
    Cell,
    is_chosen,
    origin_of,
    presented,
    trial_table,
)

EXPLORED = ("mean_speed_m_per_s", "mean_normal_force_N", "path_length_m", *MEASURES)


@dataclass(frozen=True, slots=True, eq=False)
class Answers:
    """Answered trials of a study; arrays of shape (trials,), in each person's order.

    Attributes:
        design: what was asked.
        origin: whose answers these are, like "people".
        people: pseudonyms, by number.
        surfaces: every virtual surface that was presented, by number.
        participant: number of the person.
        number: of the trial within the person, from 1.
        phase: "practice", "main" or "catch".
        display: number in the design's order.
        series: number of the adaptive series, −1 for none.
        presented: numbers of the surfaces in their order, shape (surfaces of a trial, trials).
        intensity: of an adaptive series' comparison, in parts of the reference (1); else NaN.
        choice, right: numbers among the design's answers; −1 for none.
        estimate: number given (1); NaN for none.
        response_time: (s); NaN for none.
        exploration: quantity with its unit → values; NaN for none.
    """

    design: StudyDesign
    origin: str
    people: tuple[str, ...]
    surfaces: tuple[Stimulus, ...]
    participant: si.IntArray
    number: si.IntArray
    phase: NDArray[np.str_]
    display: si.IntArray
    series: si.IntArray
    presented: si.IntArray
    intensity: si.DimensionlessArray
    choice: si.IntArray
    right: si.IntArray
    estimate: si.DimensionlessArray
    response_time: si.SecondArray
    exploration: Mapping[str, si.FloatArray] = dataclasses.field(default_factory=dict)

    @property
    def trials(self) -> int:
        """Number of trials."""
        return int(self.participant.size)

    @property
    def values(self) -> si.FloatArray:
        """Amount (SI) that each surface has of what is judged, shape (surfaces,)."""
        return np.array([self.design.judged_value(surface) for surface in self.surfaces])

    @property
    def model(self) -> DifferenceModel:
        """The model of the task, which must have one."""
        model = self.design.described.model
        assert model is not None
        return model

    @property
    def in_order(self) -> si.IntArray:
        """`presented` of each trial as its answer puts them, from most to least."""
        places = np.array(self.design.described.ranks)[self.choice].T
        return np.take_along_axis(self.presented, places, axis=0)

    @property
    def told(self) -> NDArray[np.bool_]:
        """True for each trial whose answer is what the model counts."""
        counts = self.model.counts
        return np.asarray(self.choice == (self.right if counts < 0 else counts))

    @property
    def differences(self) -> si.FloatArray:
        """Difference of levels that the task's model takes of each trial."""
        design = self.design
        levels = np.array([design.level(surface) for surface in self.surfaces])
        found = self.model.difference(levels[self.presented], design.reference_level)
        return np.asarray(np.round(found, 12))

    @property
    def correct(self) -> si.DimensionlessArray:
        """1 where the answer was right, 0 where not, NaN where nothing is right."""
        return np.where(self.right < 0, np.nan, (self.choice == self.right).astype(float))

    def take(self, rows: NDArray[np.bool_]) -> Answers:
        """Some of the trials, with all people and surfaces."""
        arrays = {
            field.name: getattr(self, field.name)[..., rows]
            for field in dataclasses.fields(self)
            if isinstance(getattr(self, field.name), np.ndarray)
        }
        explored = {key: values[rows] for key, values in self.exploration.items()}
        return dataclasses.replace(self, **arrays, exploration=explored)

    def main(self, display: int) -> Answers:
        """The main trials on a display."""
        return self.take((self.display == display) & (self.phase == "main"))


def recorded_answers(store: StudyStore) -> Answers:
    """The answered trials of a study's file, without those that were only felt or set aside.

    Raises `RecordError` if the file cannot be read.
    """
    return answers_of(store.design, trial_table(store), origin_of(store))


def answers_of(design: StudyDesign, table: Sequence[Mapping[str, Cell]], origin: str) -> Answers:
    """The same of a table with the keys of `COLUMNS` that answers need, whoever wrote it."""
    rows = [row for row in table if row["phase"] != "familiarisation" and not row["set_aside"]]
    known: dict[tuple[str, object], int] = {}
    surfaces: list[Stimulus] = []

    def surface(name: str, row: Mapping[str, Cell]) -> int:
        key = name, row["intensity"] if is_chosen(design, name, row) else None
        if key not in known:
            known[key] = len(surfaces)
            surfaces.append(presented(design, name, row))
        return known[key]

    people = tuple(dict.fromkeys(str(row["participant_id"]) for row in rows))
    place = {name: number for number, name in enumerate(people)}
    displays = {name: number for number, name in enumerate(design.displays)}
    series = {one.name: number for number, one in enumerate(design.adaptive)}
    names = {name: number for number, name in enumerate(design.answers)}

    def whole(found: list[int]) -> si.IntArray:
        return np.array(found, dtype=np.int64)

    def column(key: str) -> si.FloatArray:
        return np.array([row[key] for row in rows], dtype=float)

    return Answers(
        design=design,
        origin=origin,
        people=people,
        participant=whole([place[str(row["participant_id"])] for row in rows]),
        number=whole([int(str(row["trial"])) for row in rows]),
        phase=np.array([str(row["phase"]) for row in rows], dtype=np.str_),
        display=whole([displays[str(row["display"])] for row in rows]),
        series=whole([series.get(str(row["adaptive_series"]), -1) for row in rows]),
        presented=np.array(
            [
                [surface(str(row[key]), row) for row in rows]
                for key in SURFACES[: design.described.surfaces]
            ],
            dtype=np.int64,
        ),
        surfaces=tuple(surfaces),
        intensity=column("intensity"),
        choice=whole([names.get(str(row["choice"]), -1) for row in rows]),
        right=whole([names.get(str(row["answer"]), -1) for row in rows]),
        estimate=column("estimate"),
        response_time=column("response_time_s"),
        exploration={key: values for key in EXPLORED if np.isfinite(values := column(key)).any()},
    )
