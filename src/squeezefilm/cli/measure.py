"""Verbs of what a bench measured: check it, fit it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from squeezefilm.cli.app import AsJson, answer, app, print_json, working, written_to
from squeezefilm.core.errors import InputError

if TYPE_CHECKING:
    from squeezefilm.core.progress import SayProgress
    from squeezefilm.measure.fits.by_kind import Fit
    from squeezefilm.measure.recordings.read import RecordingCheck

measure = typer.Typer(
    name="measure",
    help="Recordings of a bench: check how it is read, and fit it.",
    no_args_is_help=True,
)
app.add_typer(measure)

Recording = Annotated[
    Path,
    typer.Argument(
        metavar="FILE", help="Data with a TOML file of the same name beside, or that TOML file."
    ),
]
DescribedBy = Annotated[
    Path | None,
    typer.Option("--described", help="The TOML file, where it does not stand beside the data."),
]


@measure.command()
def check(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE|FOLDER",
            help="Data with a TOML file of the same name beside, that TOML file, or a folder.",
        ),
    ],
    described: DescribedBy = None,
    write: Annotated[
        bool,
        typer.Option("--write", help="Write the proposed TOML file beside the data first."),
    ] = False,
    out: Annotated[Path | None, written_to("Folder for pictures, numbers and a page.")] = None,
    as_json: AsJson = False,
) -> None:
    """Say how a recording is read, with a picture, before anything is fitted: kind, columns, units,
    amplitudes, and what is doubtful. Exit code 1 if a file of a folder could not be read. Exports
    of known instruments need no TOML file; --write keeps the one that is proposed.
    """
    from squeezefilm.measure.recordings.read import (
        FolderCheck,
        check_folder,
        check_recording,
        write_description,
    )
    from squeezefilm.measure.report.page import show_folder, write_checks

    if file.is_dir():
        if described is not None or write:
            raise InputError("--described and --write go with one file; not with a folder")
        checked = check_folder(file)
    else:
        if write:
            typer.echo(f"written: {write_description(file)}", err=True)
        checked = FolderCheck((check_recording(file, described),), ())
    written = None if out is None else write_checks(checked, out)
    answer(as_json, checked, show_folder, page=written)
    if checked.refused:
        raise typer.Exit(1)


@measure.command()
def fit(
    file: Recording,
    described: DescribedBy = None,
    display: Annotated[
        str | None,
        typer.Option(help="The plate with whose solved shapes a grid scan is compared."),
    ] = None,
    out: Annotated[
        Path | None, written_to("Folder for the picture of data, model and residual, and a page.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Fit what goes with the kind of a recording: numbers with intervals, and whether the fit is
    adequate. Exit code 1 if it is not."""
    from squeezefilm.measure.fits.by_kind import response_fit
    from squeezefilm.measure.recordings.read import check_recording
    from squeezefilm.measure.report.page import fit_summary, show_fit, write_fit

    with working(as_json) as step:
        checked = check_recording(file, described)
        step(f"fit of {checked.file.name}")
        fitted = _fitted(checked, display, step)
        response = response_fit(fitted)
        written = None if out is None else write_fit(checked, fitted, out, response)
    if as_json:
        print_json(fit_summary(checked, fitted, response))
    else:
        show_fit(checked, fitted, response)
        if written is not None:
            typer.echo(f"page: {written}")
    if not fitted.adequacy.adequate:
        raise typer.Exit(1)


def _fitted(found: RecordingCheck, display: str | None, step: SayProgress) -> Fit:
    """The fit of what was read; where it is refused, what is doubtful of the recording is said."""
    from squeezefilm.measure.fits.by_kind import fit_recording
    from squeezefilm.physics.display import load_display

    plate = None if display is None else load_display(display)
    try:
        return fit_recording(found.recording, plate, progress=step)
    except InputError:
        for doubt in found.doubts:
            typer.echo(f"doubtful: {doubt}", err=True)
        raise
