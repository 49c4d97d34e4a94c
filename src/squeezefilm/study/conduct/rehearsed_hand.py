"""The paths that simulated participants leave beside a rehearsed study: assumed, and labelled so.

Their finger goes as the model of their answers has it: strokes to and fro along x, or the plain
hand of free exploration (`physics.perception.free_hand`), at the speed and force of its finger
class.
"""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.formats.traces import Table, csv_text
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.free_hand import SAYS
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.percepts import exploration
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.render.motion.finger_path import FingerPath
from squeezefilm.study.conduct.study_device import TrialMotion
from squeezefilm.study.design.matching import Exploring
from squeezefilm.study.record.exploration import PATH_PERIOD
from squeezefilm.study.record.explored_trials import explored_table
from squeezefilm.study.simulated.felt_surfaces import free_path

_STROKES = "Strokes to and fro along x, each pass of least jerk, as the simulated answers assume."


def path_of(
    exploring: Exploring, display: Display, observer: Observer, finger: FingerClass
) -> FingerPath:
    """How a finger of that class explores a surface of a display in a rehearsal.

    Raises `InputError` for free exploration of a ring.
    """
    if exploring == "free":
        return free_path(display, observer, finger)
    strokes = exploration(observer, finger)
    times = np.append(np.arange(0.0, strokes.duration, PATH_PERIOD / 5), strokes.duration)
    return FingerPath(times, strokes.position(times), np.zeros(times.size))


def rehearsed(
    path: FingerPath, exploring: Exploring, stimulus: Stimulus, normal_force: si.Newton
) -> TrialMotion:
    """That a finger explored a surface along a path at a force (N), as a device would say it."""
    times = np.arange(0.0, path.duration, PATH_PERIOD)
    x, y = path.place(times)
    about = {
        "device": "none: a simulated hand",
        "assumed": SAYS if exploring == "free" else _STROKES,
        "stimulus": stimulus.name,
        "surface_sha256": stimulus.surface_sha256,
    }
    table = Table({"time_s": times, "x_m": x, "y_m": y}, about)
    found = explored_table(table)
    return TrialMotion(
        path_length=found.path_length,
        mean_speed=found.mean_speed,
        mean_normal_force=normal_force,
        trace=csv_text(table),
        touch=1.0,
    )
