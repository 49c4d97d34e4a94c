"""Verbs about textures: computed, played on a device or its twin, and what was recorded."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import (
    AsJson,
    Finger,
    Force,
    In,
    LargestVoltage,
    Model,
    OnDisplay,
    OnPlace,
    OnSurface,
    Pickup,
    Texture,
    answer,
    app,
    given,
    working,
    written_to,
)
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError


@dataclass(frozen=True)
class RenderOptions:
    """Options of `render`."""

    texture: Texture
    display: OnDisplay
    stroke: Annotated[
        str, typer.Option(help='Finger motion: STROKE.csv, or "60 mm/s over 4 cm, 2 passes".')
    ] = "60 mm/s over 4 cm, 2 passes"
    out: Annotated[
        Path | None, written_to("Folder for trace, envelope, numbers, figures, a page.")
    ] = None
    as_json: AsJson = False
    sensor: Annotated[
        str | None, typer.Option(help="Sensor of the finger, like touch-panel-120-hz.")
    ] = None
    compensation: Annotated[
        str,
        typer.Option(
            "--compensate",
            help="Compensation of the slow resonator: none, inverse or preview.",
        ),
    ] = "none"
    braking: Annotated[
        bool, typer.Option("--braking", help="The drive may invert the carrier's phase.")
    ] = False
    wave: Annotated[
        str, typer.Option(help="The standing wave's nodes: ignored, felt or compensated.")
    ] = "ignored"
    voltage: LargestVoltage = None
    normal_force: Force = None
    surface: OnSurface = None
    model: Model = None
    place: OnPlace = None
    finger: Finger = "new"
    table: Annotated[str, typer.Option(help="The trace as csv or parquet.")] = "csv"
    drive: Annotated[
        bool, typer.Option("--drive", help="Write the carrier as drive.wav, 192 kHz.")
    ] = False
    hjif: Annotated[
        bool, typer.Option("--hjif", help="Write the texture as MPEG haptics, texture.hjif.")
    ] = False
    seed: Annotated[int, typer.Option(help="Seed of the sensor's noise.")] = 0


@app.command()
@called_with(RenderOptions)
def render(asked: RenderOptions) -> None:
    """A texture on a display under a moving finger: what is asked for and what is rendered."""
    from squeezefilm.design.report.texture_page import (
        hjif_export,
        show_lost,
        show_render,
        write_render,
    )
    from squeezefilm.measure.fits.friction.friction_scores import with_finger
    from squeezefilm.physics.chain.rendered_texture import render_texture
    from squeezefilm.physics.display import load_display
    from squeezefilm.physics.texture_files.texture_file import load_texture
    from squeezefilm.physics.texture_files.trajectories import motion_from

    out, table, drive, hjif = asked.out, asked.table, asked.drive, asked.hjif
    if out is None and (drive or hjif or table != "csv"):
        raise InputError("--drive, --hjif and --table write files; say where with --out DIR")
    what, motion = load_texture(asked.texture), motion_from(asked.stroke)
    where = with_finger(load_display(asked.display), asked.finger)
    options = given(asked, leave="texture display finger stroke out as_json table drive hjif")
    with working(asked.as_json) as step:
        result = render_texture(where, what, motion, **options, progress=step)
        written = None
        if out is not None:
            written = write_render(result, out, table=table, drive=drive, hjif=hjif, progress=step)

    def show(_: object) -> None:
        show_render(result)
        if hjif:
            show_lost(hjif_export(result))

    answer(asked.as_json, result, show, page=written)


@app.command()
def textures(as_json: AsJson = False) -> None:
    """List the textures that come with the package, for `render`."""
    from squeezefilm.core.presets import texture_names
    from squeezefilm.design.report.texture_page import show_textures
    from squeezefilm.physics.texture_files.texture_file import load_texture

    listing = []
    for name in texture_names():
        texture = load_texture(name)
        listing.append({"name": name, "title": texture.title, "quantity": texture.texture.quantity})
    answer(as_json, listing, show_textures)


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
OnSensor = Annotated[
    str, typer.Option(help="device, what its own is like (touch-panel-240-hz), or replay:FILE.")
]


@dataclass(frozen=True)
class PlayOptions:
    """Options of `play`."""

    texture: Texture
    display: OnDisplay
    drive: OnDrive = "twin"
    sensor: OnSensor = "device"
    mode: Annotated[
        str, typer.Option(help="stream: the loop here renders; tile: the device by itself.")
    ] = "stream"
    stroke: Annotated[
        str, typer.Option(help='The twin\'s finger, to and fro: "60 mm/s over 4 cm", or a CSV.')
    ] = "60 mm/s over 4 cm"
    duration: Annotated[str, In("s"), typer.Option(help='Duration, like "10 s".')] = "4 s"
    rate: Annotated[str, In("Hz"), typer.Option(help='Rate of the loop, like "5 kHz".')] = "5 kHz"
    voltage: LargestVoltage = None
    surface: OnSurface = None
    finger: Finger = "new"
    compensation: Annotated[
        str,
        typer.Option(
            "--compensate",
            help="Compensation of the slow resonator: none or inverse.",
        ),
    ] = "none"
    amplitude_per_pickup: Pickup = None
    bench_only: Annotated[
        bool, typer.Option("--bench-only", help="Allow a drive that does not stop by itself.")
    ] = False
    hold: Annotated[
        bool, typer.Option("--hold", help="The device's loops hold resonance and amplitude.")
    ] = False
    sweep: Annotated[Path | None, typer.Option(help="Sweep of its pickup, for --hold.")] = None
    out: Annotated[
        Path | None, written_to("Folder for the record, numbers, figures and a page.")
    ] = None
    seed: Annotated[int, typer.Option(help="Seed of the twin's noise.")] = 0
    as_json: AsJson = False


@app.command()
@called_with(PlayOptions)
def play(asked: PlayOptions) -> None:
    """Play a texture under a moving finger: in real time, on a device or its twin.

    Ctrl-C stops safely. Exit code 1 where the device faulted, the link broke, the loop died, or
    what was played cannot be used: too few ticks, too long a gap, too many late commands.
    """
    from squeezefilm.instruments.bench.play import play_texture
    from squeezefilm.instruments.report.terminal import line_a_second, show_play
    from squeezefilm.measure.fits.friction.friction_scores import with_finger
    from squeezefilm.physics.display import load_display
    from squeezefilm.physics.texture_files.texture_file import load_texture

    what = load_texture(asked.texture)

    def step(text: str) -> None:
        if not asked.as_json:
            typer.echo(f"  {text} …", err=True)

    result = play_texture(
        with_finger(load_display(asked.display), asked.finger),
        what,
        **given(asked, leave="texture display finger as_json"),
        show=None if asked.as_json else line_a_second(),
        progress=step,
    )
    page = None
    if asked.out is not None:
        from squeezefilm.instruments.report.page import write_play

        page = write_play(result, asked.out)
    answer(asked.as_json, result, show_play, page=page)
    if page is None and not asked.as_json:
        typer.echo("add --out DIR to keep the record")
    if not result.outcome.usable:
        if asked.as_json:
            typer.echo(f"{result.outcome.ending.value}: {result.outcome.said}", err=True)
        raise typer.Exit(1)


@app.command()
def export(
    trace: Annotated[Path, typer.Argument(help="A trace that a session recorded.")],
    to: Annotated[Path, written_to("The file to write, .csv or .parquet.")],
    as_json: AsJson = False,
) -> None:
    """Write a recorded trace as CSV or Parquet, with its metadata, and say what it had lost."""
    from squeezefilm.core.results import to_json
    from squeezefilm.instruments.report.terminal import show_export
    from squeezefilm.instruments.session.record.trace import export_trace

    with working(as_json) as step:
        done = export_trace(trace, to, step)
    answer(as_json, to_json(done), lambda _: show_export(done))


@dataclass(frozen=True)
class CheckOptions:
    """Options of `check`."""

    drive: OnDrive = "twin"
    display: Annotated[
        str, typer.Option(help="The display on it: a preset's name or a TOML file.")
    ] = "biet2008-plate"
    rate: Annotated[str, In("Hz"), typer.Option(help='Rate of this loop, like "5 kHz".')] = "5 kHz"
    sensor: OnSensor = "device"
    as_json: AsJson = False


@device_app.command()
@called_with(CheckOptions)
def check(asked: CheckOptions) -> None:
    """Check a device: link, round trip, timing, limits, watchdog, readings, position sensor.

    At no more than 1 V. Exit code 1 if a check fails; what is in doubt is told.
    """
    from squeezefilm.core.results import to_json
    from squeezefilm.instruments.bench.play import check_drive
    from squeezefilm.instruments.report.terminal import show_check

    with working(asked.as_json) as step:
        read = given(asked, leave="drive display as_json")
        result = check_drive(asked.drive, asked.display, **read, progress=step)
    summary = {**to_json(result), "passed": result.passed}
    answer(asked.as_json, summary, lambda _: show_check(result))
    if not result.passed:
        raise typer.Exit(1)
