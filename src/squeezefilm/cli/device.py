"""Verbs about a real device and its twin: play on it, check it, export what was recorded."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.arguments import called_with
from squeezefilm.cli.app import (
    AsJson,
    LargestVoltage,
    OnDisplay,
    OnSurface,
    Pickup,
    Texture,
    app,
    print_json,
    quantity,
    reachable,
    working,
)

device_app = typer.Typer(
    help="A device on a serial port, or the twin of a display.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
)
app.add_typer(device_app, name="device")

OnDrive = Annotated[
    str, typer.Option("--drive", help="twin, or a port like serial:/dev/ttyACM0[@baud].")
]


@dataclass(frozen=True)
class PlayOptions:
    """What `play` is asked for."""

    texture: Texture
    display: OnDisplay
    drive: OnDrive = "twin"
    sensor: Annotated[
        str,
        typer.Option(
            help="device: its own sensor; replay:STROKE.csv; or what its sensor is like, such as "
            "touch-panel-240-hz."
        ),
    ] = "device"
    mode: Annotated[
        str, typer.Option(help="stream: the loop here renders; tile: the device by itself.")
    ] = "stream"
    stroke: Annotated[
        str, typer.Option(help='The twin\'s finger, to and fro: "60 mm/s over 4 cm", or a CSV.')
    ] = "60 mm/s over 4 cm"
    duration: Annotated[str, typer.Option(help='How long, like "10 s".')] = "4 s"
    rate: Annotated[str, typer.Option(help='Of the loop, like "5 kHz".')] = "5 kHz"
    voltage: LargestVoltage = None
    surface: OnSurface = None
    compensate: Annotated[
        str, typer.Option(help="Of the resonator's slowness: none or inverse.")
    ] = "none"
    pickup: Pickup = None
    bench_only: Annotated[
        bool, typer.Option("--bench-only", help="Allow a drive that does not stop by itself.")
    ] = False
    out: Annotated[
        Path | None,
        typer.Option(
            callback=reachable, help="Folder for the record, numbers, figures and a page."
        ),
    ] = None
    seed: Annotated[int, typer.Option(help="Of the twin's noise.")] = 0
    as_json: AsJson = False


@app.command()
@called_with(PlayOptions)
def play(asked: PlayOptions) -> None:
    """Play a texture under a moving finger: in real time, on a device or its twin.

    Ctrl-C stops safely. Exit code 1 where the device faulted, the link broke or the loop died.
    """
    from squeezefilm.bench.play import play_texture
    from squeezefilm.quantities import Unit
    from squeezefilm.report.played.terminal import live_view, show_play
    from squeezefilm.texture_file import load_texture

    what = load_texture(asked.texture)

    def step(text: str) -> None:
        # Lines, since only one thing at a time may move on a terminal, and that is the session.
        if not asked.as_json:
            typer.echo(f"  {text} …", err=True)

    with live_view(not asked.as_json) as show:
        result = play_texture(
            asked.display,
            what,
            drive=asked.drive,
            sensor=asked.sensor,
            mode=asked.mode,
            stroke=asked.stroke,
            duration=quantity(asked.duration, "--duration", Unit("s")) or 0.0,
            rate=quantity(asked.rate, "--rate", Unit("Hz")) or 0.0,
            voltage=quantity(asked.voltage, "--voltage", Unit("V")),
            surface=asked.surface,
            compensation=asked.compensate,
            amplitude_per_pickup=quantity(asked.pickup, "--pickup", Unit("m/V")),
            bench_only=asked.bench_only,
            out=asked.out,
            seed=asked.seed,
            show=show,
            progress=step,
        )
    page = None
    if asked.out is not None:
        from squeezefilm.report.played.page import write_play

        page = write_play(result, asked.out)
    if asked.as_json:
        print_json(result.summary())
    else:
        show_play(result)
        typer.echo("add --out DIR to keep the record" if page is None else f"page: {page}")
    if result.outcome.failed:
        if asked.as_json:
            typer.echo(f"{result.outcome.ending.value}: {result.outcome.message}", err=True)
        raise typer.Exit(1)


@app.command()
def export(
    trace: Annotated[Path, typer.Argument(help="A trace that a session recorded.")],
    to: Annotated[
        Path, typer.Option(callback=reachable, help="The file to write, .csv or .parquet.")
    ],
    as_json: AsJson = False,
) -> None:
    """Write a recorded trace as CSV or Parquet, with its metadata, and say what it had lost."""
    from squeezefilm.report.played.terminal import show_export
    from squeezefilm.results import to_json
    from squeezefilm.session.record.trace import export_trace

    done = export_trace(trace, to)
    if as_json:
        print_json(to_json(done))
    else:
        show_export(done)


@device_app.command()
def check(
    drive: OnDrive = "twin",
    display: Annotated[
        str, typer.Option(help="The display on it: a preset's name or a TOML file.")
    ] = "biet2008-plate",
    rate: Annotated[str, typer.Option(help='Of the loop here, like "5 kHz".')] = "5 kHz",
    as_json: AsJson = False,
) -> None:
    """Check a device: link, round trip, timing, limits, watchdog, readings.

    At no more than 1 V. Exit code 1 if a check fails.
    """
    from squeezefilm.bench.play import check_drive
    from squeezefilm.quantities import Unit
    from squeezefilm.report.played.terminal import show_check
    from squeezefilm.results import to_json

    hertz = quantity(rate, "--rate", Unit("Hz")) or 0.0
    with working(as_json) as step:
        result = check_drive(drive, display, rate=hertz, progress=step)
    if as_json:
        print_json({**to_json(result), "passed": result.passed})
    else:
        show_check(result)
    if not result.passed:
        raise typer.Exit(1)
