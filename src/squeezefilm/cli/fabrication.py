"""The verb that turns a display into what a workshop and a bench need."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from squeezefilm.cli.app import AsJson, Target, answer, app, to_be_solved, working, written_to
from squeezefilm.core.errors import InputError

if TYPE_CHECKING:
    from squeezefilm.core.progress import SayProgress
    from squeezefilm.design.fabrication.fabricate import Fabrication
    from squeezefilm.physics.display import Display


@app.command()
def fabricate(
    target: Target,
    out: Annotated[Path, written_to("Folder for drawing, bodies, tables, plan and a page.")],
    quick: Annotated[
        bool,
        typer.Option(
            "--quick", help="Without intervals: seconds in place of a minute or two of solving."
        ),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Write what it takes to build a display and to measure it: dimensioned drawing (DXF, PDF,
    SVG), bodies (STL), electrodes and poling, bill of materials, drive electronics, and a test plan
    with what is expected."""
    from squeezefilm.actuators.described import is_actuator

    if is_actuator(target):
        raise InputError(
            f"'{target}' describes a motor or a skin-stretch array; fabricate takes a display: "
            "squeezefilm presets lists those that come with the package"
        )
    from squeezefilm.core.kit.folder import require_folder
    from squeezefilm.design.fabrication.report.page import show_fabrication

    folder = require_folder(out)
    display = to_be_solved(target, quiet=as_json)
    with working(as_json) as step:
        made, written = written_for(display, folder, quick=quick, step=step)
    answer(as_json, made, show_fabrication, page=written)


def written_for(
    display: Display, folder: Path, *, quick: bool, step: SayProgress
) -> tuple[Fabrication, Path]:
    """What it takes to build a display, and the page of it in a folder."""
    from squeezefilm.design.fabrication.fabricate import fabricate as run
    from squeezefilm.design.fabrication.fabricate import sealed_already
    from squeezefilm.design.fabrication.report.page import PREDICTION, write_fabrication

    blind = None if quick else sealed_already(folder / PREDICTION, display)
    made = run(display, intervals=not quick, blind=blind, progress=step)
    step("drawing and files")
    return made, write_fabrication(made, folder)
