"""Verbs of what a bench measured: check, fit, calibrate a display, predict blind and score."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import AsJson, answer, app, to_be_solved, working, written_to
from squeezefilm.core.errors import InputError

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
    from squeezefilm.measure.fits.by_kind import fit_recording, response_fit
    from squeezefilm.measure.recordings.read import check_recording
    from squeezefilm.measure.report.page import fit_summary, show_fit, write_fit
    from squeezefilm.physics.display import load_display

    with working(as_json) as step:
        checked = check_recording(file, described)
        step(f"fit of {checked.file.name}")
        plate = None if display is None else load_display(display)
        try:
            fitted = fit_recording(checked.recording, plate, progress=step)
        except InputError:
            for doubt in checked.doubts:
                typer.echo(f"doubtful: {doubt}", err=True)
            raise
        response = response_fit(fitted)
        written = None if out is None else write_fit(checked, fitted, out, response)
    summary = fit_summary(checked, fitted, response)
    answer(as_json, summary, lambda _: show_fit(checked, fitted, response), page=written)
    if not fitted.adequacy.adequate:
        raise typer.Exit(1)


Target = Annotated[str, typer.Argument(metavar="PRESET|FILE", help="The display.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed of all draws.")]


@measure.command()
def calibrate(
    display: Target,
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Recordings, each with its TOML file beside.")
    ],
    out: Annotated[
        Path,
        written_to(
            "Folder for the calibrated display (calibrated.toml), a page, pictures and numbers; a "
            "name that ends in .toml: that file alone."
        ),
    ] = Path("calibrated"),
    seed: Seed = 1,
    as_json: AsJson = False,
) -> None:
    """Learn a display's uncertain values from all recordings of a folder, and write the display
    that they make of it. A few minutes for eight values; stopped, it goes on where it was."""
    from squeezefilm.core.kit.folder import require_folder
    from squeezefilm.measure.calibration.folder import calibrate_display
    from squeezefilm.measure.report.calibration_page import (
        DISPLAY_FILE,
        show_calibration,
        write_calibration,
    )

    folder_too = out.suffix != ".toml"
    if folder_too:
        require_folder(out)
    file = out / DISPLAY_FILE if folder_too else out
    described = to_be_solved(display, quiet=as_json)
    with working(as_json) as step:
        calibration = calibrate_display(described, folder, file, seed=seed, progress=step)
        page = write_calibration(calibration, out) if folder_too else None
    answer(as_json, calibration, show_calibration, display=file, page=page)
    if not calibration.calibration.fits:
        raise typer.Exit(1)


@measure.command("predict")
def predict_unseen(
    display: Target,
    ask: Annotated[
        list[str],
        typer.Option(
            help="An answer and its conditions, like resonance_frequency or "
            '"relative_friction: vibration_amplitude=1.7 um". May be repeated.'
        ),
    ],
    out: Annotated[Path, written_to("The prediction, a JSON file that nothing overwrites.")] = Path(
        "prediction.json"
    ),
    seed: Seed = 1,
    as_json: AsJson = False,
) -> None:
    """Write what will be measured, with its interval and a hash, before it is."""
    from squeezefilm.core.results import to_json
    from squeezefilm.measure.calibration.blind import predict_measurement
    from squeezefilm.measure.calibration.solved_answers import question
    from squeezefilm.measure.report.calibration_page import prediction_lines

    for text in ask:
        question(text)  # refused before the display is looked at
    described = to_be_solved(display, quiet=as_json)
    with working(as_json) as step:
        prediction = predict_measurement(described, ask, out, seed=seed, progress=step)
    lines = "\n".join(prediction_lines(prediction))
    answer(as_json, to_json(prediction), lambda _: typer.echo(lines), prediction=out)


@measure.command()
def score(
    prediction: Annotated[Path, typer.Argument(metavar="FILE", help="File that predict wrote.")],
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="The recordings that were predicted.")
    ],
    display: Target,
    keep: Annotated[
        bool, typer.Option(help="Add the scores to the display's own file, as comments.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Compare a prediction with what was then measured: error, inside its interval or not, and the
    logarithm of its density there."""
    from squeezefilm.core.results import to_json
    from squeezefilm.measure.calibration.blind import keep_scores
    from squeezefilm.measure.calibration.folder import score_prediction
    from squeezefilm.physics.display import load_display

    described = load_display(display)
    with working(as_json) as step:
        found, left_out = score_prediction(prediction, folder, described, progress=step)
    if keep:
        keep_scores(display, prediction, found)
    summary = {"scores": to_json(found), "left_out": list(left_out)}
    lines = [*(score.sentence for score in found), *(f"left out: {why}" for why in left_out)]
    answer(as_json, summary, lambda _: typer.echo("\n".join(lines)))
