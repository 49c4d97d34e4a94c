"""A design search: requirements from a page's text, and a process of its own told over a pipe."""

from __future__ import annotations

import contextlib
import hashlib
import re
import signal
import time
import tomllib
from collections.abc import Iterator, Mapping
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import tomlkit

from squeezefilm.core import config, presets
from squeezefilm.core import quantities as si
from squeezefilm.core.config.syntax import require_quick_toml
from squeezefilm.core.errors import ConfigError, SqueezefilmError
from squeezefilm.core.interrupts import hear_interrupts
from squeezefilm.core.results import values_of
from squeezefilm.design.search.candidate import Design, Evaluated
from squeezefilm.design.search.criteria import CRITERIA, bounded, criterion_of
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.limits import Made, corner_in_words, limit_in_words
from squeezefilm.design.search.report.page import plate_file
from squeezefilm.design.search.report.words import setting_words
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.lab.files import existing
from squeezefilm.lab.own_process import Tell, ToldProcess, telling
from squeezefilm.lab.worker import LARGEST_MEMORY, prepare

MOST_POINTS = 600
"""Most points of the screened front that are drawn; of a longer one as many, evenly."""
_ALL_WORDS = 40
"""Reasons that are told of one kind; the first are those of most designs."""


def plate(
    requirements: Requirements, evaluated: Evaluated, made: Made | None = None
) -> dict[str, Any]:
    """A plate: name, shape and objectives (SI), what was chosen and what it does in words, of each
    of its numbers the criterion's key, its name for people and the value."""
    design, space = evaluated.design, requirements.spaces[evaluated.design.shape]
    objectives = evaluated.objectives(requirements.objectives)
    return {
        "name": design.address,
        "shape": space.shape,
        "objectives": list(objectives),
        "words": [
            criterion_of(name).shown(value)
            for name, value in zip(requirements.objectives, objectives, strict=True)
        ],
        "numbers": [
            [key, CRITERIA[key].said, CRITERIA[key].shown(value)]
            for key, value in evaluated.numbers.items()
            if key in CRITERIA and key != "cost"
        ],
        "chosen": [
            [variable.name.replace("_", " "), setting_words(variable, design, requirements)]
            for variable in space
        ],
        "design": {"shape": design.shape, "values": design.settings},
        "yield": None if made is None else made.kept,
        "warnings": list(evaluated.warnings),
    }


def glimpse(seen: DesignSearch) -> dict[str, Any]:
    """Message of what a search has so far."""
    every = max(1, -(-len(seen.screened_front) // MOST_POINTS))
    screened_front = sorted(seen.screened_front.tolist())[::every]
    now = {"stage": seen.stage, "left": seen.left, "screened_front": screened_front}
    return {**now, **_so_far(seen)}


def _so_far(search: DesignSearch) -> dict[str, Any]:
    """Counts, front and display to compare with, of a search that runs or has ended."""
    asked = search.requirements
    return {
        "screened": len(search.screened),
        "solved": search.plates_solved,
        "front": [plate(asked, member.evaluated, member.made) for member in search.front],
        "reference": reference(asked, search.reference),
    }


def reference(requirements: Requirements, candidate: Evaluated | None) -> dict[str, Any] | None:
    """The display that the front is set beside, which limits it breaks, and why it could not be
    judged ("" where it was)."""
    if candidate is None:
        return None
    return {
        "name": Path(requirements.compare_with).stem,
        "objectives": list(candidate.objectives(requirements.objectives)),
        "breaks": [breach.sentence for breach in candidate.broken],
        "reason": candidate.reason,
    }


def result(search: DesignSearch) -> dict[str, Any]:
    """Message of what a search found, or of what it had when it was stopped: the front, the plate
    that it would build, what each limit costs, the empty corners, what it rests on."""
    return {
        **_so_far(search),
        "chosen": search.chosen and search.chosen.name,
        "beats": [member.name for member in search.beats_reference],
        **values_of(search, "plates_better hypervolume requirements.assumed computed kept stopped"),
        "limits": [
            limit_in_words(limit, len(search.screened)) for limit in search.limits if limit.broken
        ],
        "corners": [corner_in_words(corner) for corner in search.corners[:_ALL_WORDS]],
        "ranks": {criterion_of(key).said: value for key, value in search.ranks.items()},
    }


TELL_EVERY: si.Second = 0.25
"""Time between two glimpses that the pages get; a new stage and the end are told at once."""
_SLOWER = 100
"""Plates of a front for which it is twice as long, since each has a row."""


class SearchProcess(ToldProcess):
    """Process of a search, at most one at a time."""

    ended = "search ended"
    in_use = "this lab searches already; stop that search first"
    stopped = "stopped; what is shown is what was found until then"
    died = (
        "the process that searched ended without a word, as one does that runs out of memory; what "
        "it knew is kept, and the same requirements go on from there"
    )
    patience = 1.0


class _Stop:
    """SIGINT as `KeyboardInterrupt`, once, and not in the middle of a message on the pipe."""

    def __init__(self) -> None:
        self._asked, self._held, self._late = False, False, False
        signal.signal(signal.SIGINT, self._hear)

    def _hear(self, *_: object) -> None:
        if self._asked:
            return
        self._asked = True
        if self._held:
            self._late = True
        else:
            raise KeyboardInterrupt

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """Do what is done here whole; a stop comes after it."""
        self._held = True
        try:
            yield
        finally:
            self._held = False
        if self._late:
            self._late = False
            raise KeyboardInterrupt


def search(connection: Connection, text: str, folder: Path, out: Path, **how: Any) -> None:
    """Search for the plates that a text's requirements ask for, and tell of it.

    `folder` is the lab's, `out` keeps every design; `how` has screened, solved, seed and jobs.
    """
    prepare()
    stop = _Stop()
    tell = telling(connection)
    try:
        hear_interrupts()
        outcome = _found(stop, tell, text, folder, out, how)
    except KeyboardInterrupt:
        # Before the first design, or a second time while it was counted what there is.
        outcome = {"failed": False, "message": "stopped"}
    except SqueezefilmError as error:
        outcome = {"failed": True, "message": str(error)}
    except MemoryError:
        outcome = {
            "failed": True,
            "message": f"the search needs more than {LARGEST_MEMORY / 1024**3:g} GiB of memory and "
            "was ended; screen or solve fewer designs",
        }
    except Exception as error:
        # A mistake of ours: the page says it, and not that the search died.
        outcome = {"failed": True, "message": f"not foreseen: {type(error).__name__}: {error}"}
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tell({"type": SearchProcess.ended, **outcome})


def _found(
    stop: _Stop, tell: Tell, text: str, folder: Path, out: Path, how: dict[str, Any]
) -> dict[str, Any]:
    from squeezefilm.design.search.run import SearchRequest, search_until_stopped

    requirements = requirements_of(text, folder)
    last: tuple[str, float] | None = None

    def say(words: str) -> None:
        with stop.held():
            tell({"type": "search says", "text": words})

    def watch(seen: DesignSearch) -> None:
        nonlocal last
        now = time.monotonic()
        every = TELL_EVERY * (1 + len(seen.front) / _SLOWER)
        if last is not None and last[0] == seen.stage and now - last[1] < every:
            return
        last = seen.stage, now
        with stop.held():
            tell({"type": "search found", **glimpse(seen)})

    search, stopped = search_until_stopped(
        SearchRequest(requirements, out=out, progress=say, watch=watch, **how)
    )
    message = SearchProcess.stopped if stopped else "finished"
    return {"failed": False, "message": message, "result": result(search)}


_DISPLAYS = ("start_from", "compare_with")
"""Keys of requirements that name a display, which may be a file."""


def requirements_of(text: str, folder: Path) -> Requirements:
    """The requirements that a TOML text states. A display that it names is a preset's or a file of
    the lab's folder, as everything else that a page reads.

    Raises:
        ConfigError: a text that states none, with the line.
        InputError: a display's file that is not in the folder.
    """
    return config.load_text(Requirements, _with_files_of(text, folder))


def _with_files_of(text: str, folder: Path) -> str:
    """The same text, line by line, with the whole paths of the displays' files."""
    require_quick_toml(text)
    try:
        stated = tomllib.loads(text)
    except (ValueError, RecursionError):
        return text  # whoever reads it says what is wrong in which line
    files = {}
    for key in _DISPLAYS:
        name = stated.get(key)
        if isinstance(name, str) and name and name not in presets.display_names():
            files[key] = str(existing(folder, name, ".toml").resolve())
    if not files:
        return text
    document = tomlkit.parse(text)
    document.update(files)
    return tomlkit.dumps(document)


def asked_of(text: str, folder: Path) -> dict[str, Any]:
    """Words for what requirements ask for, before anything is computed. Raises as
    `requirements_of`, and for a display that they start from and that cannot be read."""
    asked = requirements_of(text, folder)
    return {
        **values_of(asked, "name title note assumed"),
        "objectives": [
            {
                "key": criterion.key,
                "said": criterion.said,
                "unit": "" if criterion.unit.symbol == "1" else criterion.unit.symbol,
            }
            for criterion in map(criterion_of, asked.objectives)
        ],
        "limits": [criterion.limit_said(bound) for criterion, bound in bounded(asked.limits)],
        "shapes": [
            {"name": space.shape, "chosen": [free.name.replace("_", " ") for free in space.free]}
            for space in asked.spaces
        ],
        "start_from": Path(asked.start_from).stem,
        "compare_with": Path(asked.compare_with).stem if asked.compare_with else "",
    }


def display_text(text: str, folder: Path, shape: int, values: Mapping[str, Any]) -> str:
    """The TOML text of the display that a search of requirements made of a shape's number and of
    what it chose. Raises as `requirements_of`, and `ConfigError` for a shape that is not there."""
    asked = requirements_of(text, folder)
    if not 0 <= shape < len(asked.shapes):
        raise ConfigError(f"the requirements have no shape {shape + 1}")
    return plate_file(asked, Design(shape, tuple(values.items())))


def folder_of(name: str, text: str) -> str:
    """The name of the folder of a search: the same for the same text, so that what is known is
    asked once, and another for every other, whose answers are not alike."""
    plain = re.sub(r"[^A-Za-z0-9]+", "-", name)[:40].strip("-") or "search"
    return f"{plain}-{hashlib.sha256(text.encode()).hexdigest()[:8]}"
