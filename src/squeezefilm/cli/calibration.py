"""Verbs that go on from a bench's recordings: calibrate a display, predict blind and score."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import AsJson, answer, print_json, to_be_solved, working, written_to
from squeezefilm.cli.measure import measure

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
    if as_json:
        print_json(to_json(prediction))
        return
    for line in (*prediction_lines(prediction), f"prediction: {out}"):
        typer.echo(line)


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
    if as_json:
        print_json({"scores": to_json(found), "left_out": list(left_out)})
        return
    for line in (*(left.sentence for left in found), *(f"left out: {why}" for why in left_out)):
        typer.echo(line)
