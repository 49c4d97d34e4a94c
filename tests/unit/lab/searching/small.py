"""Requirements of which everything is quick, and evaluated designs that nobody computed."""

from __future__ import annotations

from pathlib import Path

from squeezefilm.design.search.candidate import Evaluated, Level, design_of
from squeezefilm.design.search.criteria import breaches
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.lab.search_process import requirements_of

TEXT = Path(__file__).with_name("small.toml").read_text(encoding="utf-8")


def requirements(text: str = TEXT) -> Requirements:
    """Those of `TEXT`."""
    return requirements_of(text, Path())


def evaluated(
    asked: Requirements, share: float, level: Level = "solved", **numbers: float
) -> Evaluated:
    """The design at a share of every range, with numbers that are made up."""
    space = asked.spaces[0]
    design = design_of(0, space.at({one.name: share for one in space.free}))
    return Evaluated(design, level, numbers, breaches(numbers, asked.limits))
