"""Verbs of the lab, and of a study up to its answers: plan, simulate, rehearse, run."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import (
    AsJson,
    Finger,
    In,
    Pickup,
    answer,
    app,
    given,
    reachable,
    read_option,
    working,
    written_to,
)
from squeezefilm.core.called_with import called_with


@app.command()
def lab(
    folder: Annotated[
        Path, typer.Option(help="Folder of displays, textures, strokes and studies.")
    ] = Path("squeezefilm-lab"),
    port: Annotated[int, typer.Option(help="Port; the next free one if taken.")] = 8631,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")
    ] = True,
    lan: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Address of this computer in the local network, to pair tablets as participant "
            "stations by TLS.",
        ),
    ] = None,
) -> None:
    """Open the lab, a page on this computer: design, feel, drive and study."""
    from squeezefilm.core.errors import optional

    with optional("lab", "the lab"):
        from squeezefilm.lab.serve import serve

    serve(folder, port=port, browser=browser, lan=lan, say=lambda line: typer.echo(line))


study = typer.Typer(
    name="study",
    help="Studies with people: plan, run, export; and simulated participants.",
    no_args_is_help=True,
)
app.add_typer(study)

Design = Annotated[
    str, typer.Argument(metavar="NAME|FILE", help="A preset study or a design in TOML.")
]
Store = Annotated[Path, typer.Argument(metavar="STUDY.sqlite", help="The study's file.")]
NewStore = Annotated[Path, written_to("The study's file; made if not there.")]
Consent = Annotated[bool, typer.Option("--consent", help="The participant has consented.")]
Seed = Annotated[int, typer.Option(help="Seed of the trial orders.")]
SeedOfFile = Annotated[
    int | None,
    typer.Option(help="Seed of the trial orders of a new file; an existing file keeps its own."),
]
Display = Annotated[
    str | None,
    typer.Option(help="Name of one of the design's, or any other by name or file, like mine.toml."),
]
Observer = Annotated[str, typer.Option(help="Observer of people: a preset or a TOML file.")]


@study.command()
def new(
    file: Annotated[Path, typer.Argument(callback=reachable, help="The TOML file to write.")],
    source: Annotated[
        str,
        typer.Option("--from", help="The study to start from; study presets lists them."),
    ],
    display: Annotated[
        list[str] | None, typer.Option(help="Display by name or file in place of the study's own.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")] = False,
) -> None:
    """Write a commented TOML file of your own study, starting from a preset."""
    from squeezefilm.study.design.plan import new_study_file

    new_study_file(file, source, displays=display or (), replace=force)
    typer.echo(f"wrote {file}; edit it, then: squeezefilm study plan {file}")


@study.command()
def plan(
    design: Design,
    participants: Annotated[int, typer.Option(help="Number of participants.")] = 12,
    seed: Seed = 0,
    orders: Annotated[
        Path | None,
        written_to("Folder for each participant's order, as CSV (PsychoPy) and JSON (jsPsych)."),
    ] = None,
    reach: Annotated[
        bool,
        typer.Option("--reach", help="Solve each display: does it reach what stimuli ask for?"),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Show a design: what is presented, how often, in which orders, how long it takes, and what is
    doubtful of it: its range, its displays, catch trials."""
    from squeezefilm.study.design.plan import plan_study
    from squeezefilm.study.design.study_design import load_design
    from squeezefilm.study.record.exports import write_orders
    from squeezefilm.study.report.terminal import show_plan

    planned = plan_study(load_design(design), participants, seed, reach=reach)
    written = [] if orders is None else write_orders(planned, orders)
    answer(as_json, planned, show_plan)
    if written and not as_json:
        typer.echo(f"orders: {len(written)} files in {orders}")


@study.command()
def presets(as_json: AsJson = False) -> None:
    """List the studies that come with the package."""
    from squeezefilm.core.presets import study_names
    from squeezefilm.study.design.study_design import load_design

    listing = [{"name": name, "title": load_design(name).title} for name in study_names()]
    lines = "\n".join(f"{entry['name']}: {entry['title']}" for entry in listing)
    answer(as_json, listing, lambda _: typer.echo(lines))


@study.command()
def simulate(
    design: Design,
    participants: Annotated[int, typer.Option(help="Number of simulated people.")] = 12,
    seed: Annotated[int, typer.Option(help="Seed of orders, people and noise.")] = 0,
    out: Annotated[
        Path | None,
        written_to("Folder for answers, tables, figures and a page."),
    ] = None,
    observer: Observer = "fingertip",
    display: Display = None,
    finger: Finger = "new",
    as_json: AsJson = False,
) -> None:
    """Let simulated participants do a study; every number is simulated."""
    from squeezefilm.physics.perception.observer import load_observer
    from squeezefilm.study.design.study_design import load_design
    from squeezefilm.study.report.terminal_analysis import show_simulated
    from squeezefilm.study.simulated.answers import simulate_participants
    from squeezefilm.study.simulated.chain_tables import chain_tables

    planned, people = load_design(design), load_observer(observer)
    if display is not None:
        from squeezefilm.study.simulated.planned_power import on_one_display

        planned = on_one_display(planned, display)
    with working(as_json) as step:
        tables = chain_tables(planned, people, finger=finger, progress=step)
        found = simulate_participants(planned, people, participants, seed, tables, step)
        written = None
        if out is not None:
            from squeezefilm.study.report.page import write_simulated

            written = write_simulated(found, out, step)
    answer(as_json, found, show_simulated, page=written)


@dataclass(frozen=True)
class PowerOptions:
    """Options of `power`."""

    design: Design
    first: Annotated[
        str | None, typer.Argument(help='A stimulus, like "8 mm"; not with --precision.')
    ] = None
    second: Annotated[str | None, typer.Argument(help="The one to be told from it.")] = None
    precision: Annotated[
        str | None,
        In("1"),
        typer.Option(
            help="Half the 95 % interval that is wanted, in place of two stimuli, like 20% (of a "
            "Weber fraction) or 0.05 (of an exponent or a proportion correct)."
        ),
    ] = None
    against: Annotated[
        str | None,
        typer.Option(
            help="Display that is to be shown to differ from --display (or from the design's "
            "first), in place of two stimuli; adaptive series too."
        ),
    ] = None
    display: Display = None
    target: Annotated[str, In("1"), typer.Option(help='Power asked for, like 0.8 or "80 %".')] = (
        "0.8"
    )
    studies: Annotated[int, typer.Option(help="Simulated per number of people.")] = 400
    observer: Observer = "fingertip"
    finger: Finger = "new"
    seed: Annotated[int, typer.Option(help="Seed of people, answers and studies.")] = 0
    out: Annotated[Path | None, written_to("A PNG of the curve to write.")] = None
    as_json: AsJson = False


@study.command()
@called_with(PowerOptions)
def power(asked: PowerOptions) -> None:
    """Find how many people tell two stimuli or two displays apart, or make a threshold, exponent or
    share of right answers as precise as asked; by simulated participants."""
    from squeezefilm.core.errors import InputError
    from squeezefilm.core.kit.style import png
    from squeezefilm.core.results import write_whole
    from squeezefilm.physics.perception.observer import load_observer
    from squeezefilm.study.design.study_design import load_design
    from squeezefilm.study.report.terminal_analysis import show_power, show_precision
    from squeezefilm.study.simulated.planned_power import planned_power
    from squeezefilm.study.simulated.planned_precision import planned_contrast, planned_precision
    from squeezefilm.subjects import plot

    design, people = load_design(asked.design), load_observer(asked.observer)
    options = given(asked, leave="design observer first second against out as_json")
    wanted = options.pop("precision")
    with working(asked.as_json) as step:
        if wanted is not None:
            if asked.against is not None:
                raise InputError("--precision and --against ask two things; give one of them")
            if asked.first is not None:
                raise InputError("--precision asks of the whole design; leave the stimuli out")
            precise = planned_precision(design, people, wanted, **options, progress=step)
        elif asked.against is not None:
            if asked.first is not None:
                raise InputError("--against asks of the whole design; leave the stimuli out")
            here = options.pop("display") or design.displays[0]
            found = planned_contrast(design, people, here, asked.against, **options, progress=step)
        elif asked.first is None or asked.second is None:
            names = ", ".join(f'"{stimulus.name}"' for stimulus in design.stimuli)
            raise InputError(
                f"name two stimuli of '{design.name}' to be told apart ({names}), or give "
                "--precision 20%, or --against with another display"
            )
        else:
            found = planned_power(
                design, people, asked.first, asked.second, **options, progress=step
            )
    result, show = (found, show_power) if wanted is None else (precise, show_precision)
    if asked.out is not None:
        write_whole(asked.out, png(plot(result)))
    answer(asked.as_json, result, show)


@study.command()
def gratings(
    design: Design,
    out: Annotated[Path, written_to("Folder for drawings and numbers.")],
    tolerance: Annotated[
        str,
        In("m"),
        typer.Option(help="Tolerance of ridge and groove widths; the default is assumed."),
    ] = "20 um",
) -> None:
    """Write what a workshop needs to make the real gratings that a study compares with: drawing,
    DXF, widths with tolerances, and what the design calls period."""
    from squeezefilm.study.design.study_design import load_design
    from squeezefilm.study.report.boards import board_rows, boards, write_boards
    from squeezefilm.study.report.terminal import show_boards

    found = load_design(design)
    within = read_option(tolerance, "tolerance", "m")
    page = write_boards(found, out, within)
    made = boards(found)
    show_boards(*board_rows(made, within), [difference.says for difference in made])
    typer.echo(f"page: {page}")


@study.command()
def rehearse(
    design: Design,
    store: NewStore,
    participants: Annotated[
        int, typer.Option(help="Number of simulated people that the file is to have.")
    ] = 3,
    observer: Observer = "fingertip",
    seed: SeedOfFile = None,
) -> None:
    """Let simulated participants do every trial of a study's file, to try analysis and exports;
    stopped or killed, it goes on where it stopped when it is asked again."""
    from squeezefilm.physics.perception.observer import load_observer
    from squeezefilm.study.conduct.rehearsal import rehearse as run_through
    from squeezefilm.study.conduct.terminal_run import open_study

    with (
        open_study(store, design, seed, 0, 1) as found,
        working(quiet=True) as step,
    ):
        people = run_through(found, load_observer(observer), participants, progress=step)
    typer.echo(f"{len(people)} simulated participants answered everything; look at it with:")
    typer.echo(f"squeezefilm study analyze {store}")


@dataclass(frozen=True)
class RunOptions:
    """Options of `run`."""

    design: Design
    store: NewStore
    participant: Annotated[
        str | None, typer.Option(help="Person who goes on; somebody new if not given.")
    ] = None
    conditions: Annotated[
        Path | None, typer.Option(help="Conditions of the session in TOML: consent, room, skin …")
    ] = None
    consent: Consent = False
    drive: Annotated[
        str,
        typer.Option(
            help="serial:PORT (a device), twin (a simulated one behind a port, in real time) or "
            "none."
        ),
    ] = "none"
    amplitude_per_pickup: Pickup = None
    acknowledge: Annotated[
        bool,
        typer.Option("--acknowledge-ultrasound", help="The exposure was read and acknowledged."),
    ] = False
    seed: SeedOfFile = None
    by_hand: Annotated[
        str,
        typer.Option(
            help="Place where the experimenter is told what to present with --drive none: "
            "terminal, nowhere, or a file to watch in a second window."
        ),
    ] = "terminal"
    lsl: Annotated[
        bool,
        typer.Option("--lsl", help="Markers for the lab streaming layer; needs squeezefilm[lsl]."),
    ] = False
    station: Annotated[
        int | None,
        typer.Option(help="Number of this station, from 0; a file that is there knows its own."),
    ] = None
    stations: Annotated[
        int | None, typer.Option(help="Number of stations; 1 in a new file unless given.")
    ] = None


@study.command()
@called_with(RunOptions)
def run(asked: RunOptions) -> None:
    """Run a session at the terminal; stop with Ctrl-C, and go on later where it stopped."""
    from squeezefilm.study.conduct.terminal_run import ask_acknowledgement
    from squeezefilm.study.report.terminal import run_study

    ended = run_study(
        asked.design,
        asked.store,
        asked.participant,
        **given(asked, leave="design store participant acknowledge"),
        acknowledge=(lambda _: True) if asked.acknowledge else ask_acknowledgement,
        tell=typer.echo,
        progress=lambda: working(quiet=True),
    )
    typer.echo(ended)
