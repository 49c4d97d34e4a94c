"""Every public call of the physics and rendering rooms, whatever its numbers are.

One argument at a time is replaced by nan, infinities, extremes, texts, objects and other shapes:
the answer is a typed error or finite numbers, never a crash, a hang, a warning or another error.
Seeds are printed in nightly.
"""

from __future__ import annotations

import random
import secrets
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from .good_arguments import (
    FOR_ONE_CALL,
    MADE,
    Later,
    constructor_of,
    good_arguments,
    wanted_values,
)
from .hostile_calls import HOSTILE, fault
from .public_calls import NAMES_NOT_CALLED, NOT_CALLED, public_calls

TESTS = Path(__file__).parents[1]
CALLS = public_calls()

# How many public calls are left out, by reason. One more has to be argued for here.
LEFT_OUT = {
    "a record of what was computed, which only the package makes": 53,
    "inside a solver: meshes, matrices and indices, made by calls that are checked": 154,
    "no number but the index of what its other arguments hold, or an array the package made": 18,
    "the real-time tick: it takes any floats, flags what it cannot use and never raises": 1,
    "a verb that is called with the fields of a record, which is attacked itself": 2,
    "the check of numbers itself, whose bounds are the code's own, and its messages' text": 4,
}

# Calls that neither solve nor need something solved: what the default run draws from.
QUICK = (
    "physics.contact.asperities.AsperityLaw",
    "physics.contact.sliding.march",
    "physics.contact.finger.",
    "physics.contact.finger.fingertip",
    "physics.contact.skin.",
    "core.distributions",
    "physics.film.gap",
    "physics.film.closed",
    "physics.film.planar.grid",
    "physics.film.validity.knudsen_number",
    "core.formats.traces",
    "physics.texture_files.image_file",
    "core.materials",
    "physics.plate.beam_modes.euler",
    "physics.plate.laminate",
    "physics.plate.layout",
    "physics.plate.loaded_mode",
    "design.plate.ring_pair",
    "physics.plate.sound.exposure_guidance",
    "physics.plate.working_mode.resonance_factor",
    "physics.render.resonator.envelope.e",
    "physics.render.resonator.envelope.f",
    "physics.render.texture.levels",
    "physics.render.motion.estimator.MotionModel",
    "physics.render.texture.pattern",
    "physics.render.motion.estimator.SensorModel",
    "physics.render.motion.stroke",
)


def test_every_public_call_is_attacked_or_left_out_by_name_for_a_reason() -> None:
    assert NAMES_NOT_CALLED - CALLS.keys() == set(), "these are no longer there"
    listed = [name for names in NOT_CALLED.values() for name in names.split()]
    assert len(listed) == len(NAMES_NOT_CALLED), "one is listed twice"
    assert {reason: len(names.split()) for reason, names in NOT_CALLED.items()} == LEFT_OUT
    assert len(CALLS) - len(NAMES_NOT_CALLED) >= 290


def test_there_is_a_good_call_of_every_one_that_is_attacked() -> None:
    """So that a new public call is noticed here, and not first at night."""
    for name in sorted(CALLS.keys() - NAMES_NOT_CALLED):
        given = FOR_ONE_CALL.get(name, {})
        if not isinstance(given, Later):
            wanted_values(CALLS[name], given)
            owner = CALLS[name].owner
            if owner is not None and owner not in MADE and "self" not in given:
                constructor_of(owner)


# Calls that check their numbers in words of their own, in place of `checked_numbers`.
CHECK_THEMSELVES = (
    "core.quantities.rules.Rule",
    "core.quantities.units.percent",
    "measure.recordings.kinds.RawSignals",
    "measure.recordings.kinds.RingDown",
    "physics.chain.pad_place.",
    "physics.chain.prediction.predict",
    "physics.contact.finger.fingertip.FingerpadDynamics.pressed",
    "physics.plate.beam_pieces.BeamPiece",
    "physics.plate.solid.resonances.Neighbour",
    "physics.render.motion.stroke.Stroke",
    "physics.render.program.renderer.",
    "physics.render.texture.",
)


def is_guarded(function: Any) -> bool:
    """True for a function, method or class under `checked_numbers`."""
    if isinstance(function, type):
        function = function.__new__ if issubclass(function, tuple) else function.__init__
    code = getattr(function, "__code__", None)
    return code is not None and code.co_qualname == "_guarded.<locals>.guarded"


def test_every_call_checks_its_numbers() -> None:
    """So that one that does not is noticed here, and not first at night."""
    attacked = CALLS.keys() - NAMES_NOT_CALLED
    open_to_anything = {name for name in attacked if not is_guarded(CALLS[name].function)}
    theirs = {name for name in open_to_anything if name.startswith(CHECK_THEMSELVES)}
    assert open_to_anything == theirs
    for prefix in CHECK_THEMSELVES:
        assert any(name.startswith(prefix) for name in theirs), f"{prefix} is guarded"


def test_a_sample_of_hostile_calls_ends_in_a_typed_error_or_finite_numbers() -> None:
    generator = random.Random(14)
    names = [name for name in sorted(CALLS) if name.startswith(QUICK)]
    quick = [name for name in names if name not in NAMES_NOT_CALLED]
    faults = []
    for name in generator.sample(quick, 60):
        good = good_arguments(CALLS[name])
        assert fault(CALLS[name], good) is None, f"{name} as it should be called"
        for what in generator.sample(sorted(HOSTILE), 6):
            argument = generator.choice(CALLS[name].numbers)
            if text := fault(CALLS[name], {**good, argument: HOSTILE[what]}):
                faults.append(f"{name}({argument} = {what}): {text}")
    assert faults == []


@pytest.mark.nightly
@pytest.mark.parametrize(
    "prefix",
    [
        "actuators",
        "measure",
        "design.sweep",
        "core.calibration_record",
        "physics.contact",
        "core.distributions",
        "physics.film",
        "core.formats",
        "physics.chain.friction",
        "core.materials",
        "physics.plate",
        "physics.chain.prediction",
        "physics.render",
        "physics.chain.touch",
    ],
)
def test_every_hostile_call_ends_in_a_typed_error_or_finite_numbers(prefix: str) -> None:
    seed = secrets.randbits(32)
    print(f"seed {seed}")
    done = subprocess.run(
        [sys.executable, "-m", "properties.hostile_calls", prefix, str(seed)],
        cwd=TESTS,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{done.stdout}\nlast: {done.stderr[-2000:]}"
    print(done.stdout)
