"""Percepts of surfaces under fingers: felt once, and kept on disk."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import config_hash
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.percepts import Apparatus, grating_percept, percept
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.physics.perception.stimuli import Grating, Stimulus

if TYPE_CHECKING:
    from squeezefilm.physics.render.motion.finger_path import FingerPath

_KEPT: Kept[Candidates] = Kept("percepts", Candidates)
_MOST_REMEMBERED = 8192
_REMEMBERED: dict[str, Candidates] = {}
"""Percepts that this process has met, by request: to be quick, and where no disk keeps them."""


@dataclass(frozen=True, slots=True, eq=False)
class Asked:
    """Request for percepts of surfaces under a finger: `feel` of each, `rest` of its inputs."""

    feel: Callable[..., Candidates]
    surfaces: tuple[Any, ...]
    rest: tuple[Any, ...]

    def known(self) -> list[Candidates] | None:
        """Percepts computed before; None unless all was."""
        percepts = [_known(_name(self.feel, surface, self.rest)) for surface in self.surfaces]
        return None if None in percepts else [felt for felt in percepts if felt is not None]


def felt_surfaces(asked: list[Asked], tell: SayProgress) -> list[list[Candidates]]:
    """Percepts of each finger; those that are not known yet are computed."""
    felt = [request.known() for request in asked]
    lacking = [at for at, known in enumerate(felt) if known is None]
    with one_blas_thread():
        for number, at in enumerate(lacking, 1):
            tell(f"what fingers feel: {number} of {len(lacking)}")
            request = asked[at]
            felt[at] = [request.feel(surface, *request.rest) for surface in request.surfaces]
    return [known for known in felt if known is not None]


def _name(feel: Callable[..., Candidates], surface: Stimulus | Grating, rest: Any) -> str:
    """Text of a request: how, the surface, and all else that decides what is felt of it."""
    parts = " ".join(_hash(part) for part in rest)
    if isinstance(surface, Grating):
        return f"{feel.__name__} {parts} {config_hash(surface)}"
    # Two kinds of texture may have the same numbers, and the text of an image leaves out pixels.
    texture = surface.surface()
    return f"{feel.__name__} {parts} {texture!r} {config_hash(texture)} {surface.period!r}"


def _known(asked: str) -> Candidates | None:
    """Percept computed before: in this process, or by what is on disk."""
    if asked not in _REMEMBERED and (kept := _KEPT.get(asked)) is not None:
        _remember(asked, kept)
    return _REMEMBERED.get(asked)


def _remember(asked: str, found: Candidates) -> None:
    while len(_REMEMBERED) >= _MOST_REMEMBERED:
        del _REMEMBERED[next(iter(_REMEMBERED))]
    _REMEMBERED[asked] = found


def _keep(asked: str, found: Candidates) -> Candidates:
    _KEPT.put(asked, found)
    _remember(asked, found)
    return found


def felt_by_strokes(
    stimulus: Stimulus, display: Display, observer: Observer, finger: FingerClass, run: Apparatus
) -> Candidates:
    """A virtual surface under strokes along x, shape (1, candidates)."""
    asked = _name(felt_by_strokes, stimulus, (display, observer, finger, run))
    if (known := _known(asked)) is not None:
        return known
    found, _ = percept(display, stimulus, observer, finger, run)
    return _keep(asked, _by_direction(found.candidates))


def felt_freely(
    stimulus: Stimulus, display: Display, observer: Observer, finger: FingerClass, run: Apparatus
) -> Candidates:
    """A virtual surface under a plain hand that explores the face freely: along x and along y,
    shape (2, candidates)."""
    asked = _name(felt_freely, stimulus, (display, observer, finger, run))
    if (known := _known(asked)) is not None:
        return known
    from squeezefilm.physics.perception.path_percepts import path_percept
    from squeezefilm.physics.texture_files.texture_file import TextureFile

    path = free_path(display, observer, finger)
    surface = TextureFile(stimulus.surface(), stimulus.name)
    found = path_percept(display, surface, observer, finger, [path], run)
    # The hand sweeps both ways, on lines far longer than the shortest run.
    assert found.along is not None
    assert found.across is not None
    both = found.along.percept.candidates, found.across.percept.candidates
    return _keep(asked, _by_direction(*both))


def _by_direction(*directions: Candidates) -> Candidates:
    return Candidates(
        np.stack([felt.period for felt in directions]),
        np.stack([felt.d_prime for felt in directions]),
    )


def felt_really(grating: Grating, observer: Observer, finger: FingerClass) -> Candidates:
    """A real grating, shape (candidates,)."""
    asked = _name(felt_really, grating, (observer, finger))
    if (known := _known(asked)) is not None:
        return known
    return _keep(asked, grating_percept(grating, observer, finger).candidates)


def free_path(display: Display, observer: Observer, finger: FingerClass) -> FingerPath:
    """Path of a finger that explores a display freely. Raises `InputError` for a ring."""
    from squeezefilm.physics.perception.free_hand import free_exploration
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
