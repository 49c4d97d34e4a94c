"""The verb that searches for plates which meet requirements."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import (
    AsJson,
    Finger,
    Jobs,
    Scheduler,
    answer,
    app,
    print_json,
    working,
    written_to,
)
from squeezefilm.core.arguments import called_with


@dataclass(frozen=True)
class DesignOptions:
    """What `design` is asked for."""

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

    from squeezefilm.cli.fabrication import written_for
    from squeezefilm.core import presets
    from squeezefilm.core.kit.folder import require_folder
    from squeezefilm.design.search.report.page import write_design
    from squeezefilm.design.search.report.terminal import show_design, show_requirements
    from squeezefilm.design.search.requirements import load_requirements
    from squeezefilm.design.search.run import SearchRequest, search_until_stopped
    from squeezefilm.physics.display import load_display

    if asked.requirements is None:
        if asked.as_json:
            print_json({"requirements": list(presets.requirement_names())})
        else:
            show_requirements()
        return
    if asked.out is not None:
        require_folder(asked.out)
    with working(asked.as_json) as step:
        request = SearchRequest(
            replace(load_requirements(asked.requirements), finger=asked.finger),
            screened=asked.screened,
            solved=asked.solved,
            seed=asked.seed,
            jobs=asked.jobs or os.cpu_count() or 1,
            scheduler=asked.scheduler,
            out=asked.out,
            member=asked.member,
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
