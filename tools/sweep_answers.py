"""Write `squeezefilm/search/answers.toml`: every number that a sweep can ask of each verb.

    python tools/sweep_answers.py

Verbs answer for displays of each kind; what any of them says is listed. A test compares.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import squeezefilm.design.sweep
from squeezefilm.core.results import Result, to_json
from squeezefilm.design.analysis.analyze import analyze
from squeezefilm.design.friction import analyze_friction
from squeezefilm.design.plate.command import solve_plate
from squeezefilm.design.plate.solved import ModeRow
from squeezefilm.design.sweep.answers import VERBS, numbers_of
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.chain.rendered_texture import render_texture
from squeezefilm.physics.display import load_display
from squeezefilm.physics.texture_files.texture_file import load_texture
from squeezefilm.physics.texture_files.trajectories import motion_from

DISPLAYS = ("biet2008-plate", "biet2008-stator", "winfield2007-tpad")
# Two numbers that always stand together are listed each; of longer lists only that there is one.
_PAIR = re.compile(r"(relative_friction_interval|finger_impedance_N_s_per_m)\.[01]$")
HEAD = """\
# What a sweep can ask of each verb; tools/sweep_answers.py writes it.
# A star stands for a place in a list, from 0 on; "heat: predict" for all that predict lists under
# heat, and ": predict" for all of its numbers.
"""


def results(verb: str) -> Iterator[Result]:
    """What a verb says of displays of each kind."""
    for display in map(load_display, DISPLAYS):
        if verb == "predict":
            yield predict(display)
        elif verb == "render":
            motion = motion_from("60 mm/s over 2 cm")
            sensor = "touch-panel-120-hz"
            yield render_texture(display, load_texture("sine-3mm"), motion, sensor=sensor)
        elif verb == "plate":
            yield solve_plate(display)
        elif verb == "friction":
            yield analyze_friction(display, wanted_friction=0.9)
        elif verb == "analyze":
            yield analyze(display)


def keys(verb: str) -> list[str]:
    """The keys of a verb, in the order in which its JSON has them."""
    if verb == "followed":
        fields = to_json(ModeRow("", *(1.0,) * 8))
        return [key for key in fields if key not in ("label", "modal_force")]
    found: dict[str, None] = {}
    for result in results(verb):
        for key, value in numbers_of(result.summary()):
            starred = key if _PAIR.search(key) else re.sub(r"\.\d+(?=\.|$)", ".*", key)
            # NaN: a text or a group that is missing here, or a number that another display has.
            if value == value:
                found[starred] = None
    return list(found)


def written(found: dict[str, list[str]], verb: str) -> list[str]:
    """A verb's keys; what a verb before it lists alike is said by that verb's name."""
    own, lines = found[verb], {}
    before = {one: found[one] for one in list(found)[: list(found).index(verb)]}
    if whole := next((one for one, theirs in before.items() if set(theirs) <= set(own)), None):
        lines[f": {whole}"] = None
        own = [key for key in own if key not in before[whole]]
    for key in own:
        head, dot, _ = key.partition(".")
        group = [one for one in own if one.startswith(f"{head}.")]
        alike = (
            one
            for one, theirs in before.items()
            if dot and group == [key for key in theirs if key.startswith(f"{head}.")]
        )
        other = next(alike, None)
        lines[key if other is None else f"{head}: {other}"] = None
    return list(lines)


def text() -> str:
    """The text of the file."""
    found, lines = {verb: keys(verb) for verb in VERBS}, [HEAD]
    for verb in VERBS:
        lines += [f"{verb} = [", *(f'  "{line}",' for line in written(found, verb)), "]", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    assert squeezefilm.design.sweep.__file__ is not None
    Path(squeezefilm.design.sweep.__file__).with_name("answers.toml").write_text(
        text(), encoding="utf-8"
    )
