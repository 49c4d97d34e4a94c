"""Likeness of two surfaces, direction by direction; and surfaces matched with those recalled.

A surface is perceived in each direction in which it was explored (`physics.perception.perceived`):
how evident its clearest rhythm is, and with which period. Two percepts differ, in standard
deviations of that difference, by the strengths in every direction and by the periods where both
have one that is felt. A person who knows the stimuli by name recalls each as if it were felt again,
with noise of its own, and names the one that differs least. None of that was measured or tuned:
`assumed` says what answers to a design rest on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.free_hand import SAYS
from squeezefilm.physics.perception.perceived import Perceived, perceived_anew
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.study.design.study_design import StudyDesign

if TYPE_CHECKING:
    from squeezefilm.study.simulated.chain_tables import ChainTables


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
