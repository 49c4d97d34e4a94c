"""What is asked of a mutated file, in process, and how much work that was.

Run as a program it goes through a range of numbers and prints what it found as JSON: the child of
`test_mutated_files`, in which the memory is measured.
"""

from __future__ import annotations

import json
import os
import random
import resource
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from squeezefilm.core.errors import SqueezefilmError, SqueezefilmWarning
from squeezefilm.design.friction import friction_map
from squeezefilm.physics.chain import rendered_texture as render_command
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.film.periodic import batch
from squeezefilm.physics.film.periodic import film as periodic
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.ring import modes as annular
from squeezefilm.physics.plate.solid import solve as solve_modes
from squeezefilm.physics.texture_files.texture_file import load_texture
from squeezefilm.physics.texture_files.trajectories import motion_from
from squeezefilm.study.design.plan import plan_study
from squeezefilm.study.design.study_design import load_design

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tests.faults.mutations import mutated, mutated_stroke, preset_files

MOST_FILMS = 60_000
MOST_RING_UNKNOWNS = 3_000_000
GIGABYTE = 1 << 30
STATOR = "biet2008-stator"


@dataclass
class Work:
    """What was done, in counts that do not depend on the machine."""

    counts: Counter[str] = field(default_factory=Counter)

    def counting(self, function: Callable[..., Any], name: str, size: Callable[..., int]) -> Any:
        """The function, with the size of each of its calls added to a count."""

        def counted(*args: Any, **kwargs: Any) -> Any:
            self.counts[name] += size(*args, **kwargs)
            return function(*args, **kwargs)

        return counted


@contextmanager
def counted() -> Iterator[Work]:
    """Solves, films, unknowns and steps are counted within."""
    work = Work()
    one = lambda *_, **__: 1  # noqa: E731
    films = lambda some, *_, **__: len(some.squeeze_number)  # noqa: E731
    with (
        # What is kept would not be counted.
        mock.patch.dict(os.environ, {"SQUEEZEFILM_CACHE": "off"}),
        mock.patch.object(
            batch, "solve_all",
            work.counting(batch.solve_all, "films", films),
        ),
        mock.patch.object(
            periodic, "refine",
            work.counting(periodic.refine, "films", one),
        ),
        mock.patch.object(
            solve_modes, "solved_classes",
            work.counting(solve_modes.solved_classes, "solid solves", one),
        ),
        mock.patch.object(
            annular, "nearest_modes",
            work.counting(
                annular.nearest_modes, "ring unknowns", lambda system, *_: system.displacements
            ),
        ),
        mock.patch.object(
            render_command, "rendered_stroke",
            work.counting(
                render_command.rendered_stroke, "steps",
                lambda _, trajectory, *__, control_rate, **___: int(
                    trajectory.duration * control_rate
                ),
            ),
        ),
    ):  # fmt: skip
        yield work


@dataclass
class Found:
    """What became of one mutant: "refused", "done", or "untyped" with where."""

    number: int
    kind: str
    outcome: str
    message: str = ""
    work: dict[str, int] = field(default_factory=dict)
    seconds: float = 0.0


def _screened(display: Display) -> None:
    """A display as the screening theory sees it: a beam, its friction and a small map of it."""
    plate = isinstance(display.actuator, RectangularPlate)
    p = predict(display, theory="timoshenko" if plate else None)
    friction_map(p, 4)


def _rendered(texture: Path | None, stroke: str) -> None:
    where = Path(texture) if texture is not None else None
    what = load_texture(preset_files()["texture"][0] if where is None else where)
    render_command.render_texture(load_display(STATOR), what, motion_from(stroke))


KINDS = ("display", "display", "display", "texture", "study", "stroke")


def made(number: int, seed: int, folder: Path) -> tuple[str, Path | str]:
    """The kind of a mutant and its file, or its words."""
    chance = random.Random(f"{seed} {number}")
    kind = KINDS[number % len(KINDS)]
    if kind == "stroke":
        return kind, mutated_stroke(chance)
    source = chance.choice(preset_files()[kind])
    file = folder / f"{kind}-{number}.toml"
    file.write_bytes(mutated(source.read_text(encoding="utf-8"), chance))
    return kind, file


def tried(number: int, seed: int, folder: Path) -> Found:
    """One mutant, read and, where it is accepted, worked on."""
    kind, what = made(number, seed, folder)
    start = time.monotonic()
    loaded = False
    with counted() as work, warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", SqueezefilmWarning)
        try:
            if kind == "display":
                display = load_display(what)
                loaded = True
                _screened(display)
            elif kind == "texture":
                load_texture(what)
                loaded = True
                _rendered(Path(what), "60 mm/s over 4 cm")
            elif kind == "stroke":
                motion_from(str(what))
                loaded = True
                _rendered(None, str(what))
            else:
                design = load_design(what)
                loaded = True
                plan_study(design, 12)
            outcome, message = "done", ""
        except SqueezefilmError as error:
            outcome, message = "late" if loaded else "refused", str(error)
        except Exception as error:
            outcome = "untyped"
            last = traceback.extract_tb(error.__traceback__)[-3:]
            where = " < ".join(f"{Path(one.filename).name}:{one.lineno}" for one in reversed(last))
            message = f"{type(error).__name__}: {error!s:.300} at {where}"
    return Found(number, kind, outcome, message, dict(work.counts), time.monotonic() - start)


def peak() -> int:
    """The most memory that this process ever had (bytes)."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def main(seed: int, first: int, count: int) -> None:
    """Presets first, for what they take; then the mutants. One line of JSON for each, and the
    memory that they took beyond."""
    for file in preset_files()["display"]:
        _screened(load_display(file))
    for file in preset_files()["texture"]:
        _rendered(file, "60 mm/s over 4 cm")
    before = peak()
    with tempfile.TemporaryDirectory() as folder:
        for number in range(first, first + count):
            print(json.dumps(vars(tried(number, seed, Path(folder)))), flush=True)
    print(json.dumps({"peak_beyond_presets": peak() - before}), flush=True)


if __name__ == "__main__":
    # A far tail that underflows to 0 is right.
    np.seterr(all="warn", under="ignore")
    main(*map(int, sys.argv[1:4]))
