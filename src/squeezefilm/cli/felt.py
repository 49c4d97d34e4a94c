"""The verb that asks what a finger's own path would have felt like."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import AsJson, In, print_json, read_option, working, written_to
from squeezefilm.cli.study import Observer, study
from squeezefilm.core.arguments import called_with


@dataclass(frozen=True)
class FeltOptions:
    """What `felt` is asked for."""

    target: Annotated[
        str,
        typer.Argument(
            metavar="STUDY.sqlite|DESIGN",
            help="A study's file, for the path of an answer; or a design, for one by --path.",
        ),
    ]
    participant: Annotated[str | None, typer.Option(help="The pseudonym.")] = None
    trial: Annotated[int | None, typer.Option(help="Number of the answered trial.")] = None
    path: Annotated[
        str | None,
        typer.Option(
            help="With a design: a CSV of the finger's path (time_s, x_m, y_m, perhaps force_N), "
            'or words like "80 mm/s over 4 cm, 3 turns, at 30 deg".'
        ),
    ] = None
    stimulus: Annotated[
        str | None, typer.Option(help="With --path: which of the design's surfaces.")
    ] = None
    display: Annotated[
        str | None, typer.Option(help="With --path: another display than the design's first.")
    ] = None
    force: Annotated[
        str | None,
        In("N"),
        typer.Option(help="With --path: the normal force, like 0.5 N; assumed without it."),
    ] = None
    observer: Observer = "fingertip"
    out: Annotated[Path | None, written_to("A PNG of path and evidence to write.")] = None
    as_json: AsJson = False


@study.command()
@called_with(FeltOptions)
def felt(asked: FeltOptions) -> None:
    """Say what a finger's real path would have felt like, by an observer's senses; simulated."""
    from squeezefilm.core.errors import InputError
    from squeezefilm.core.kit.style import png
    from squeezefilm.core.results import write_whole
    from squeezefilm.physics.display import load_display
    from squeezefilm.physics.perception.observer import load_observer
    from squeezefilm.study.design.study_design import load_design
    from squeezefilm.study.record.store import StudyStore
    from squeezefilm.study.report.felt_path import show_all
    from squeezefilm.study.simulated.felt_paths import FeltPath, felt_on_path
    from squeezefilm.study.simulated.felt_trials import felt_in_trial
    from squeezefilm.subjects import plot

    people = load_observer(asked.observer)
    with working(asked.as_json) as step:
        if asked.path is not None:
            design = load_design(asked.target)
            if asked.stimulus is None:
                names = ", ".join(f'"{one.name}"' for one in design.stimuli)
                raise InputError(f"say by --stimulus which surface the path explores: {names}")
            only = felt_on_path(
                design,
                asked.stimulus,
                asked.path,
                observer=people,
                display=None if asked.display is None else load_display(asked.display),
                normal_force=read_option(asked.force, "force", "N"),
                progress=step,
            )
            found: tuple[FeltPath, ...] = (only,)
        else:
            if asked.participant is None or asked.trial is None:
                raise InputError(
                    "say whose path by --participant and --trial of a study's file, or give a "
                    "design with --path and --stimulus"
                )
            with StudyStore.open(asked.target) as store:
                found = felt_in_trial(store, asked.participant, asked.trial, people, progress=step)
    written = []
    if asked.out is not None:
        for number, one in enumerate(found, 1):
            name = (
                asked.out if len(found) == 1 else asked.out.with_stem(f"{asked.out.stem}-{number}")
            )
            write_whole(name, png(plot(one)))
            written.append(name)
    if asked.as_json:
        print_json([one.summary() for one in found])
        return
    show_all(found)
    for name in written:
        typer.echo(f"figure: {name}")
