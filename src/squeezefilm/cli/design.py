"""Verbs that search for plates, sweep questions over points, and say how to build a display."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from squeezefilm.cli.app import (
    AsJson,
    Finger,
    Jobs,
    Scheduler,
    Target,
    answer,
    app,
    given,
    print_json,
    to_be_solved,
    working,
    written_to,
)
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError

if TYPE_CHECKING:
    from squeezefilm.core.progress import SayProgress
    from squeezefilm.design.fabrication.fabricate import Fabrication
    from squeezefilm.physics.display import Display


@dataclass(frozen=True)
class DesignOptions:
    """Options of `design`."""

    requirements: Annotated[
        str | None,
        typer.Argument(
            metavar="REQUIREMENTS|FILE",
            help="Preset requirements or a TOML file; the presets are listed without one.",
        ),
    ] = None
    out: Annotated[
        Path | None,
        written_to(
            "Folder for page, numbers, plates, and drawings of the one to build; what it has is "
            "not computed again."
        ),
    ] = None
    screened: Annotated[
        int, typer.Option(help="Designs that are screened before any is solved.")
    ] = 2000
    solved: Annotated[
        int, typer.Option(help="Plates that are solved in three dimensions, at most.")
    ] = 120
    seed: Annotated[int, typer.Option(help="Seed of all random numbers.")] = 1
    finger: Finger = "new"
    jobs: Jobs = None
    scheduler: Scheduler = None
    member: Annotated[
        int,
        typer.Option(
            help="Number of this host where several search in one folder at once: 0, 1, … Each "
            "ends with what all have solved."
        ),
    ] = 0
    quick: Annotated[
        bool,
        typer.Option(
            "--quick",
            help="Drawings and test plan of the plate to build without intervals, which take a "
            "minute or two of solving.",
        ),
    ] = False
    as_json: AsJson = False


@app.command()
@called_with(DesignOptions)
def design(asked: DesignOptions) -> None:
    """Plates that meet requirements: say what a finger should feel, get those that can do it.

    Ctrl-C stops it and shows what it has, and so does the end of a cluster; with --out the same
    command goes on from there. Exit code 1 where no plate was found.
    """
    import os
    from dataclasses import replace

    from squeezefilm.core import presets
    from squeezefilm.core.kit.folder import require_folder
    from squeezefilm.design.search.report.figures import show_design, show_requirements
    from squeezefilm.design.search.report.page import write_design
    from squeezefilm.design.search.requirements import load_requirements
    from squeezefilm.design.search.run import SearchRequest, search_until_stopped
    from squeezefilm.physics.display import load_display

    if asked.requirements is None:
        if asked.as_json:
            print_json({"requirements": list(presets.names("requirements"))})
        else:
            show_requirements()
        return
    if asked.out is not None:
        require_folder(asked.out)
    with working(asked.as_json) as step:
        request = SearchRequest(
            replace(load_requirements(asked.requirements), finger=asked.finger),
            **given(asked, leave="requirements finger jobs quick as_json"),
            jobs=asked.jobs or os.cpu_count() or 1,
            progress=step,
        )
        found, stopped = search_until_stopped(request)
        page = None
        if asked.out is not None:
            chosen = None if found.stopped else found.chosen
            built = "" if chosen is None else f"made/{chosen.name}"
            page = write_design(found, asked.out, fabrication=built and f"{built}/index.html")
            if chosen is not None:
                plate = load_display(asked.out / "plates" / f"{chosen.name}.toml")
                written_for(plate, asked.out / built, quick=asked.quick, step=step)
    answer(asked.as_json, found, show_design, page=page)
    if stopped:
        again = "the same command goes on" if asked.out else "add --out DIR to keep what is done"
        typer.echo(f"{stopped}; {again}", err=True)
        raise typer.Exit(130 if stopped == "stopped" else 2)
    if not found.front:
        raise typer.Exit(1)


@app.command()
def fabricate(
    target: Target,
    out: Annotated[Path, written_to("Folder for drawing, bodies, tables, plan and a page.")],
    quick: Annotated[
        bool,
        typer.Option(
            "--quick", help="Skip intervals: seconds in place of a minute or two of solving."
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
    display: "Display", folder: Path, *, quick: bool, step: "SayProgress"
) -> "tuple[Fabrication, Path]":
    """Write what it takes to build a display; its numbers, and the page."""
    from squeezefilm.design.fabrication.fabricate import fabricate as run
    from squeezefilm.design.fabrication.fabricate import sealed_already
    from squeezefilm.design.fabrication.report.page import PREDICTION, write_fabrication

    blind = None if quick else sealed_already(folder / PREDICTION, display)
    made = run(display, intervals=not quick, blind=blind, progress=step)
    step("drawing and files")
    return made, write_fabrication(made, folder)


@dataclass(frozen=True)
class SweepOptions:
    """Options of `sweep`."""

    targets: Annotated[
        list[str] | None,
        typer.Argument(metavar="PRESET|FILE ...", help="A display, or several to compare."),
    ] = None
    vary: Annotated[
        list[str] | None,
        typer.Option(
            help='Value that changes, and its steps: "actuator.thickness=1 mm..3 mm:9" (:9:log for '
            'equal ratios), "voltage=10 V, 20 V". Any number of the display, or voltage, '
            "frequency, vibration_amplitude, normal_force, speed, position, ambient_pressure, "
            "wanted_friction, surface, model, theory, band, texture, motion, sensor, compensation, "
            "braking, wave. Again for a grid."
        ),
    ] = None
    over: Annotated[
        Path | None,
        typer.Option(help="A CSV file: its header names what changes, each row is a point."),
    ] = None
    ask: Annotated[
        list[str] | None,
        typer.Option(
            help="Numbers of predict, render, plate, friction or analyze: "
            "relative_friction,resonance_frequency; followed: modes by their shapes."
        ),
    ] = None
    answers: Annotated[
        bool, typer.Option("--answers", help="List all that can be asked for, and stop.")
    ] = False
    sample: Annotated[
        int | None,
        typer.Option(
            help='Number of points drawn in the ranges without steps, "actuator.thickness=1 mm..3 '
            'mm", in place of a grid; more of them keep those before.'
        ),
    ] = None
    seed: Annotated[int, typer.Option(help="Seed of the random samples.")] = 0
    finger: Finger = "new"
    jobs: Jobs = None
    scheduler: Scheduler = None
    out: Annotated[
        Path | None,
        written_to("Folder for page, table and JSON; what it has is not computed again."),
    ] = None
    less: Annotated[
        list[str] | None,
        typer.Option(help="Answers of which less is better: the page lists what no other beats."),
    ] = None
    more: Annotated[list[str] | None, typer.Option(help="Answers of which more is better.")] = None
    table: Annotated[str, typer.Option(help="The table as csv or parquet.")] = "csv"
    compare: Annotated[
        str | None,
        typer.Option(help="Two rows of what --out has, from 1, side by side: --compare 3,17."),
    ] = None
    fresh: Annotated[bool, typer.Option("--fresh", help="Compute again what the folder has.")] = (
        False
    )
    as_json: AsJson = False


_NOT_OF_SWEEP = "targets vary ask answers finger jobs less more table compare as_json"
"""Options that the request takes in another form, or not at all."""


@app.command()
@called_with(SweepOptions)
def sweep(asked: SweepOptions) -> None:
    """The same questions at many points: a grid of values, the rows of a file, several displays.

    Ctrl-C stops it; with --out the same command goes on from there.
    """
    import os

    from squeezefilm.design.sweep.answers import asked_for
    from squeezefilm.design.sweep.report.page import require_kind, wishes, write_sweep
    from squeezefilm.design.sweep.report.terminal import (
        compared_rows,
        show_answers,
        show_comparison,
        show_sweep,
    )
    from squeezefilm.design.sweep.sweep import SweepRequest, sweep_until_stopped
    from squeezefilm.measure.fits.friction.friction_scores import with_finger
    from squeezefilm.physics.display import load_display

    if asked.answers:
        show_answers()
        return
    if asked.compare is not None:
        show_comparison(compared_rows(asked.out, asked.compare))
        return
    if not asked.targets:
        raise InputError("sweep needs a display: squeezefilm sweep biet2008-plate --vary ... --ask")
    require_kind(asked.table)
    if asked.less or asked.more:
        wanted = [(number.column, number.unit) for number in asked_for(asked.ask or ())]
        wishes(wanted, asked.less or (), asked.more or ())
    with working(asked.as_json) as step:
        request = SweepRequest(
            [with_finger(load_display(target), asked.finger) for target in asked.targets],
            vary=asked.vary or (),
            ask=asked.ask or (),
            **given(asked, leave=_NOT_OF_SWEEP),
            jobs=asked.jobs or os.cpu_count() or 1,
            progress=step,
        )
        found, stopped = sweep_until_stopped(request)
        written = None
        if asked.out is not None:
            written = write_sweep(
                found, asked.out, table=asked.table, less=asked.less or (), more=asked.more or ()
            )
    answer(asked.as_json, found, show_sweep, page=written)
    if stopped:
        again = "the same command goes on" if asked.out else "add --out DIR to keep what is done"
        typer.echo(f"{stopped}, {found.missing} points are missing; {again}", err=True)
        raise typer.Exit(130 if stopped == "stopped" else 2)
