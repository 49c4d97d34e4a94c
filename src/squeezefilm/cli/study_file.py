"""Verbs of a study's file: look, export, merge, take out, analyse."""

from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import AsJson, answer, print_json, working, written_to
from squeezefilm.cli.study import Store, study


@study.command()
def status(store: Store, as_json: AsJson = False) -> None:
    """Show who is enrolled and how far they are."""
    from squeezefilm.study.record.store import StudyStore
    from squeezefilm.study.report.terminal import show_status

    with StudyStore.open(store) as found:
        if as_json:
            print_json({"study": found.study["name"], "participants": found.participants()})
            return
        show_status(found)


@study.command()
def export(
    store: Store,
    format: Annotated[str, typer.Option("--format", help="csv or psych-ds.")] = "csv",
    out: Annotated[
        Path | None,
        written_to("Folder; beside the study's file without it."),
    ] = None,
) -> None:
    """Write all answers as CSV or a Psych-DS dataset."""
    from squeezefilm.study.record.exports import export_study
    from squeezefilm.study.record.store import StudyStore

    with StudyStore.open(store) as found:
        typer.echo(f"wrote {export_study(found, format, out)}")  # type: ignore[arg-type] # checked there


@study.command()
def merge(
    store: Store,
    others: Annotated[list[Path], typer.Argument(metavar="OTHER.sqlite …", help="Files to add.")],
) -> None:
    """Add other stations' files to this one, made if not there; merging again changes nothing."""
    from squeezefilm.study.record.merge import merge as add
    from squeezefilm.study.record.merge import open_or_begin
    from squeezefilm.study.report.terminal import show_merge

    with open_or_begin(store, others[0]) as found:
        for other in others:
            show_merge(add(found, other), str(other))


@study.command()
def backup(store: Store) -> None:
    """Copy the study's file, as it is now, into the folder of backups beside it."""
    from squeezefilm.study.record.store import StudyStore

    with StudyStore.open(store) as found:
        typer.echo(f"wrote {found.back_up()}")


@study.command()
def delete_participant(
    store: Store,
    participant: Annotated[str, typer.Argument(help="The pseudonym.")],
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask.")] = False,
) -> None:
    """Take a participant out of the file, its traces, backups and exports, without a trace."""
    from squeezefilm.study.record.deletion import delete_participant as take_out
    from squeezefilm.study.record.store import StudyStore
    from squeezefilm.study.report.terminal import show_deletion

    with StudyStore.open(store) as found:
        if not yes:
            typer.confirm(f"Delete every answer and trace of {participant} for good?", abort=True)
        show_deletion(take_out(found, participant), participant)


@study.command()
def analyze(
    store: Annotated[
        Path,
        typer.Argument(
            metavar="STUDY.sqlite|ANSWERS",
            help="The study's file; or answers of another program, a file or a folder of them.",
        ),
    ],
    design: Annotated[
        str | None,
        typer.Option(help="Design to which answers of another program were given."),
    ] = None,
    columns: Annotated[
        str,
        typer.Option(help='Names of its columns, like "participant_id=who, choice=key_resp.keys".'),
    ] = "",
    values: Annotated[
        str,
        typer.Option(
            help='Meanings of its words for answers and stimuli, like "left=first, right=second".'
        ),
    ] = "",
    decimal_comma: Annotated[
        bool, typer.Option("--decimal-comma", help="Read numbers with decimal commas.")
    ] = False,
    out: Annotated[
        Path | None,
        written_to("Folder for numbers, figures and a page per display."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of bootstraps.")] = 0,
    as_json: AsJson = False,
) -> None:
    """Analyse what was recorded: thresholds, sensitivity, exponents or confusions, with
    intervals, and how people worked."""
    from squeezefilm.core.errors import InputError
    from squeezefilm.study.design.study_design import load_design
    from squeezefilm.study.record.foreign import SUFFIXES, columns_of
    from squeezefilm.study.report.terminal_analysis import show_analyses
    from squeezefilm.study.tasks.analyze import analyze_study

    if design is None and (columns or values or store.suffix.lower() in SUFFIXES or store.is_dir()):
        raise InputError(
            f"{store} is analysed as answers of another program; say to which study they were "
            "given by --design NAME|FILE"
        )
    with working(as_json) as step:
        analyses = analyze_study(
            store,
            design=None if design is None else load_design(design),
            columns=columns_of(columns),
            values=columns_of(values, "values"),
            decimal_comma=decimal_comma,
            seed=seed,
            progress=step,
        )
        page = None
        if out is not None:
            from squeezefilm.study.report.page import write_overview

            page = write_overview(analyses, out, step)
    found = {name: each.summary() for name, each in analyses.items()} if as_json else analyses
    answer(as_json, found, show_analyses, page=page)
