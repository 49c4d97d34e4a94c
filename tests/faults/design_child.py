"""A search for designs in a process of its own, by formulas in place of plates: to be killed.

    python -m tests.faults.design_child FOLDER

A line is appended to FOLDER/asked for each design that is computed.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from unittest import mock

from tests.unit.design.search.made_up import formula, requirements

import squeezefilm.design.search.run as run
from squeezefilm.design.search.candidate import Design, Evaluated, Level
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.limits import Made
from squeezefilm.design.search.requirements import Requirements


def searched(folder: Path, pause: float = 0.0) -> DesignSearch:
    """The search, each design counted; `pause` (s) is what a task takes."""

    def counted(wanted: Requirements, designs: tuple[Design, ...], level: Level) -> list[Evaluated]:
        time.sleep(pause)
        with (folder / "asked").open("a") as there:
            there.write("".join(f"{one.address} {level}\n" for one in designs))
        return [formula(wanted, one, level) for one in designs]

    # Put back afterwards: a test calls this in its own process, where others come after it.
    with (
        mock.patch.object(run, "evaluate_all", counted),
        mock.patch.object(run, "made_of", return_value=Made(64, 1.0, {}, {}, {})),
    ):
        return run.search_designs(requirements(), screened=150, solved=24, out=folder)


if __name__ == "__main__":
    searched(Path(sys.argv[1]), pause=0.004)
