"""The verb that asks another verb's questions at many points."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import AsJson, Finger, Jobs, Scheduler, answer, app, working, written_to
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError


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
    from squeezefilm.measure.fits.friction.person import with_finger
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
            over=asked.over,
            sample=asked.sample,
            seed=asked.seed,
            jobs=asked.jobs or os.cpu_count() or 1,
            scheduler=asked.scheduler,
            out=asked.out,
            fresh=asked.fresh,
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
