"""How each answer's surfaces were explored, measured on the paths that lie beside the study."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import Table, table_from_csv
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import AnnularStator
from squeezefilm.study.record.exploration import PATH_PERIOD, Exploration, exploration
from squeezefilm.study.record.store import StudyStore

LONGEST_STEP: si.Second = 1.5 * PATH_PERIOD
"""Between two samples of a path; a longer one is a lifted finger."""
MEASURES = ("peak_speed_m_per_s", "time_in_touch_s", "passes", "along_x_share", "coverage")
"""What `ExploredTrials.measures` gives of an answer, units in the names."""
NO_MEASURES: dict[str, float | None] = dict.fromkeys(MEASURES)


@dataclass(frozen=True)
class ExploredTrials:
    """Reads a study's paths; each display's face is looked up once."""

    store: StudyStore
    _faces: dict[str, tuple[si.Metre, si.Metre] | None] = field(default_factory=dict)

    def paths(self, traces: list[str]) -> list[Table]:
        """The paths among an answer's traces, in the order of its surfaces.

        One that is not there or cannot be read is left out: traces may be kept elsewhere.
        """
        found = []
        for name in traces:
            if name.endswith(".csv"):
                try:
                    table = table_from_csv(self.store.traces / name)
                    time = table.column("time_s")
                    table.column("x_m"), table.column("y_m")
                except (ConfigError, InputError):
                    continue
                if time.size > 1:
                    found.append(table)
        return found

    def measures(self, display: str, traces: list[str]) -> dict[str, float | None]:
        """Of an answer: peak speed (m/s), time in touch (s), passes, share of their way along x
        (1), coverage of the face (1); of two surfaces sums, the greater peak and mean shares.

        None for what is not known: without a path all of them, without the display's file coverage.
        """
        found = []
        for table in self.paths(traces):
            try:
                found.append(explored_table(table, self.face(display)))
            except InputError:
                # A path of another program that is none: it says nothing.
                continue
        if not found:
            return dict(NO_MEASURES)
        values = (
            max(one.peak_speed for one in found),
            sum(one.touched for one in found),
            float(sum(one.passes for one in found)),
            _mean([one.along_x_share for one in found]),
            _mean([one.coverage for one in found]),
        )
        return {
            name: value if math.isfinite(value) else None
            for name, value in zip(MEASURES, values, strict=True)
        }

    def face(self, display: str) -> tuple[si.Metre, si.Metre] | None:
        """Length and width (m) of what a display has to touch; None of a ring, or where its
        description cannot be read."""
        if display not in self._faces:
            self._faces[display] = _face(display)
        return self._faces[display]


def explored_table(table: Table, face: tuple[si.Metre, si.Metre] | None = None) -> Exploration:
    """How a finger explored, from the table of its path. Raises what `exploration` raises."""
    time, x, y = (table.column(name) for name in ("time_s", "x_m", "y_m"))
    return exploration(time, x, y, face=face, longest_step=LONGEST_STEP)


def _mean(values: list[float]) -> float:
    known = [one for one in values if math.isfinite(one)]
    return float(np.mean(known)) if known else math.nan


@functools.lru_cache(maxsize=32)
def _face(display: str) -> tuple[si.Metre, si.Metre] | None:
    try:
        actuator = load_display(display).actuator
    except (ConfigError, InputError):
        return None
    return None if isinstance(actuator, AnnularStator) else actuator.extent
