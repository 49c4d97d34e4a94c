"""The verbs of the command line. Each gathers its arguments, calls one function and shows the
result; physics, plots and pydantic are imported only by the verb that needs them."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from squeezefilm import __version__
from squeezefilm.errors import InputError, SqueezefilmError

if TYPE_CHECKING:
    from squeezefilm.quantities import Unit

app = typer.Typer(
    name="squeezefilm",
    help="Design, predict and use tactile displays that change friction by ultrasonic vibration.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

Target = Annotated[
    str, typer.Argument(metavar="PRESET|FILE", help="A preset's name or a TOML file.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
Strict = Annotated[
    bool, typer.Option("--strict", help="Refuse contradicting data and models out of range.")
]

# A working point is asked for in the same words by every verb.
Voltage = Annotated[str | None, typer.Option(help='Voltage amplitude, like "15 V".')]
Frequency = Annotated[
    str | None, typer.Option(help='Drive frequency, like "34 kHz"; the resonance if not given.')
]
Force = Annotated[str | None, typer.Option(help='Normal force, like "0.5 N".')]
OnSurface = Annotated[str | None, typer.Option("--surface", help="Which of its surfaces.")]
Model = Annotated[
    str | None,
    typer.Option(
        help="Friction model: partial-levitation (the default), partial-levitation-one-gap, "
        "paper2008, film-sealed, film-open, film-plateau, film-smooth."
    ),
]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    pass


def _quantity(text: str | None, option: str, unit: Unit) -> float | None:
    """The value of an option that is a quantity text, with the option named in the error."""
    if text is None:
        return None
    from squeezefilm.quantities import parse_quantity

    try:
        return parse_quantity(text, unit)
    except InputError as error:
        raise InputError(f"{option}: {error}") from error


def _print_json(value: Any) -> None:
    import json

    typer.echo(json.dumps(value, indent=2, ensure_ascii=False))


@app.command()
def presets(as_json: AsJson = False) -> None:
    """List the displays that come with the package."""
    from squeezefilm.report.terminal import preset_list, show_presets

    listing = preset_list()
    if as_json:
        _print_json(listing)
    else:
        show_presets(listing)


@app.command()
def show(target: Target, as_json: AsJson = False) -> None:
    """Show every value of a display, with its source and what is assumed."""
    from squeezefilm.report import terminal

    values = terminal.display_values(target)
    if as_json:
        _print_json(values)
    else:
        terminal.show_values(values)


@app.command()
def new(
    file: Annotated[Path, typer.Argument(help="The TOML file to write.")],
    source: Annotated[str, typer.Option("--from", help="The preset to start from.")],
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")] = False,
) -> None:
    """Write a commented TOML file of your own, starting from a preset."""
    from squeezefilm.display import new_display_file

    new_display_file(file, source, replace=force)
    typer.echo(f"wrote {file}; edit it, then: squeezefilm analyze {file}")


@app.command()
def analyze(
    target: Target,
    out: Annotated[
        Path | None, typer.Option(help="Write result.json and report.html to this folder.")
    ] = None,
    as_json: AsJson = False,
    voltage: Voltage = None,
    frequency: Frequency = None,
    amplitude: Annotated[
        str | None,
        typer.Option(help='Vibration amplitude, like "2 um", in place of voltage and plate.'),
    ] = None,
    force: Force = None,
    surface: OnSurface = None,
    model: Model = None,
    samples: Annotated[
        int, typer.Option(help="Base samples of the friction's interval, a power of two; 0: none.")
    ] = 32,
    theory: Annotated[
        str | None,
        typer.Option(
            help="How a plate is computed: solid (three-dimensional piezoelectric elements, the "
            "default), timoshenko or euler_bernoulli (beams)."
        ),
    ] = None,
    strict: Strict = False,
) -> None:
    """From the display's description to resonance, amplitude, friction and textures."""
    from squeezefilm.analysis.analyze import analyze as run
    from squeezefilm.display import load_display
    from squeezefilm.quantities import Unit
    from squeezefilm.report import terminal

    display = load_display(target)
    with terminal.progress(enabled=sys.stderr.isatty() or not as_json) as step:
        result = run(
            display,
            voltage=_quantity(voltage, "--voltage", Unit("V")),
            frequency=_quantity(frequency, "--frequency", Unit("Hz")),
            vibration_amplitude=_quantity(amplitude, "--amplitude", Unit("m")),
            normal_force=_quantity(force, "--force", Unit("N")),
            surface=surface,
            samples=samples,
            theory=theory,  # type: ignore[arg-type] # checked with a message by working_mode
            model=model,  # type: ignore[arg-type] # checked with a message by FrictionLaw
            strict=strict,
            progress=step,
        )
        written = None
        if out is not None:
            from squeezefilm.report.page import write_report

            written = write_report(result, out, progress=step)
    if as_json:
        _print_json(result.summary())
        return
    terminal.show_analysis(result)
    if written is not None:
        typer.echo(f"report: {written}")
    else:
        typer.echo("add --out DIR to write result.json and a report with figures")


@app.command()
def friction(
    target: Target,
    voltage: Voltage = None,
    frequency: Frequency = None,
    amplitude: Annotated[
        str | None,
        typer.Option(help='Amplitude with the finger on it, like "2 um", in place of a voltage.'),
    ] = None,
    force: Force = None,
    surface: OnSurface = None,
    model: Model = None,
    position: Annotated[
        str, typer.Option(help="The pad's centre from an antinode, along the wave.")
    ] = "0 mm",
    speed: Annotated[
        str, typer.Option(help="Of the finger, for the competing mechanism: intermittent contact.")
    ] = "80 mm/s",
    ambient_pressure: Annotated[
        str | None, typer.Option(help='Of the air around, like "2 kPa" for a vacuum experiment.')
    ] = None,
    wanted: Annotated[
        float | None, typer.Option(help="A relative friction: which voltage reaches it?")
    ] = None,
    samples: Annotated[
        int, typer.Option(help="Base samples of the uncertainty, a power of two; 0 for none.")
    ] = 64,
    seed: Annotated[int, typer.Option(help="Of the samples.")] = 1,
    out: Annotated[Path | None, typer.Option(help="Folder for friction.json and figures.")] = None,
    as_json: AsJson = False,
) -> None:
    """The friction a finger meets, how the load is shared, and how sure all of it is."""
    from squeezefilm.analysis.friction_command import analyze_friction
    from squeezefilm.display import load_display
    from squeezefilm.quantities import Unit
    from squeezefilm.report import terminal
    from squeezefilm.report.terminal_friction import show_friction

    display = load_display(target)
    with terminal.progress(enabled=sys.stderr.isatty() or not as_json) as step:
        result = analyze_friction(
            display,
            voltage=_quantity(voltage, "--voltage", Unit("V")),
            frequency=_quantity(frequency, "--frequency", Unit("Hz")),
            vibration_amplitude=_quantity(amplitude, "--amplitude", Unit("m")),
            normal_force=_quantity(force, "--force", Unit("N")),
            surface=surface,
            model=model,  # type: ignore[arg-type] # checked with a message by FrictionLaw
            position=_quantity(position, "--position", Unit("m")) or 0.0,
            speed=_quantity(speed, "--speed", Unit("m/s")) or 0.0,
            ambient_pressure=_quantity(ambient_pressure, "--ambient-pressure", Unit("Pa")),
            wanted_friction=wanted,
            samples=samples,
            seed=seed,
            progress=step,
        )
        written = None
        if out is not None:
            from squeezefilm.report.friction_report import write_friction

            written = write_friction(result, out)
    if as_json:
        _print_json(result.summary())
        return
    show_friction(result)
    if written is not None:
        typer.echo(f"figures: {written}")


@app.command()
def film(
    squeeze_number: Annotated[
        float | None, typer.Option("--squeeze-number", help="σ on width, radius or X semi-axis.")
    ] = None,
    excursion: Annotated[
        float | None, typer.Option("--excursion", help="ε, amplitude over mean gap, below 1.")
    ] = None,
    shape: Annotated[str, typer.Option(help="strip, disc, rectangle or ellipse.")] = "strip",
    aspect: Annotated[float, typer.Option(help="Length ratio of rectangle or ellipse.")] = 1.0,
    polytropic: Annotated[float, typer.Option(help="1 isothermal to 1.4 adiabatic.")] = 1.0,
    knudsen: Annotated[float, typer.Option(help="Mean free path over mean gap.")] = 0.0,
    slip: Annotated[str, typer.Option(help="first, second, fukui-kaneko or veijola.")] = "first",
    tolerance: Annotated[float, typer.Option(help="Relative, on the over-pressure.")] = 1e-3,
    sweep: Annotated[
        bool, typer.Option("--sweep", help="Draw the map over squeeze number and excursion.")
    ] = False,
    out: Annotated[Path | None, typer.Option(help="Folder for the map and its numbers.")] = None,
    as_json: AsJson = False,
) -> None:
    """Solve the periodic gas film of one shape, or map it over squeeze number and excursion."""
    from squeezefilm.analysis.film_command import FilmRequest, solve_film, sweep_film
    from squeezefilm.report import terminal
    from squeezefilm.report.terminal_solvers import show_film

    request = FilmRequest(shape, aspect, polytropic, knudsen, slip, tolerance)
    with terminal.progress(enabled=sys.stderr.isatty() or not as_json) as step:
        if sweep:
            from squeezefilm.report.film_map import write_film_map

            if out is None:
                raise InputError("--sweep draws a map into a folder; say which with --out DIR")
            found = sweep_film(request, progress=step)
            path = write_film_map(found, out)
        else:
            if squeeze_number is None or excursion is None:
                raise InputError(
                    "film needs --squeeze-number and --excursion, or --sweep --out DIR for a map"
                )
            step("solving the film")
            answer = solve_film(squeeze_number, excursion, request)
    if sweep:
        if as_json:
            _print_json(found.summary())
        else:
            typer.echo(f"map: {path}")
    elif as_json:
        _print_json(answer.summary())
    else:
        show_film(answer)


@app.command()
def plate(
    target: Target,
    band: Annotated[str | None, typer.Option(help='Modes in a band, like "25 kHz:45 kHz".')] = None,
    mode: Annotated[
        str | None,
        typer.Option(
            help="Working mode by nodal lines, like 8,0; of discs and rings circles, diameters."
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for a page with figures.")] = None,
    vtu: Annotated[
        Path | None, typer.Option(help="Write the solved volume for ParaView to this .vtu file.")
    ] = None,
    sensitivity: Annotated[
        bool, typer.Option("--sensitivity", help="What other materials and sizes would change.")
    ] = False,
    track: Annotated[
        str | None, typer.Option(help="Follow the modes over a parameter, like ceramic_thickness.")
    ] = None,
    start: Annotated[str | None, typer.Option("--from", help='Its first value: "0.5 mm".')] = None,
    stop: Annotated[str | None, typer.Option("--to", help='Its last value: "1.5 mm".')] = None,
    values: Annotated[int, typer.Option(help="How many values of it.")] = 9,
    as_json: AsJson = False,
) -> None:
    """Solve a plate, disc or stator in three dimensions: modes, amplitude per volt, admittance."""
    from squeezefilm.analysis.plate_command import analyze_plate, parse_band, parse_mode
    from squeezefilm.analysis.plate_tracking import parse_track
    from squeezefilm.analysis.ring_command import analyze_ring
    from squeezefilm.display import load_display
    from squeezefilm.report import terminal
    from squeezefilm.report.terminal_ring import show_ring
    from squeezefilm.report.terminal_solvers import show_plate

    display = load_display(target)
    wanted = None if mode is None else parse_mode(mode)
    limits = None if band is None else parse_band(band)
    over = None if track is None else parse_track(track, start, stop, values)
    rectangle = display.actuator.type == "rectangular_plate"
    if not rectangle and (vtu is not None or sensitivity or over is not None):
        raise InputError(
            f"--vtu, --sensitivity and --track are for rectangular plates; '{display.name}' is a "
            f"{display.actuator.type.replace('_', ' ')}"
        )
    with terminal.progress(enabled=sys.stderr.isatty() or not as_json) as step:
        written = []
        if rectangle:
            result = analyze_plate(
                display, mode=wanted, band=limits, sensitivity=sensitivity, track=over,
                progress=step,
            )  # fmt: skip
            if out is not None or vtu is not None:
                from squeezefilm.report.solved_plate import write_mode, write_plate

                step("figures")
                written += [] if out is None else [write_plate(result, out)]
                written += [] if vtu is None else [write_mode(result, vtu)]
        else:
            ring = analyze_ring(display, mode=wanted, band=limits, progress=step)
            if out is not None:
                from squeezefilm.report.solved_ring import write_ring

                step("figures")
                written.append(write_ring(ring, out))
    if as_json:
        _print_json((result if rectangle else ring).summary())
        return
    if rectangle:
        show_plate(result)
    else:
        show_ring(ring)
    for path in written:
        typer.echo(f"wrote {path}")


@app.command()
def render(
    texture: Annotated[
        str, typer.Argument(metavar="TEXTURE|FILE", help="A preset texture or a TOML file.")
    ],
    display: Annotated[str, typer.Option(help="A display: a preset's name or a TOML file.")],
    stroke: Annotated[
        str, typer.Option(help='Finger motion: STROKE.csv, or "60 mm/s over 4 cm, 2 passes".')
    ] = "60 mm/s over 4 cm, 2 passes",
    out: Annotated[
        Path | None, typer.Option(help="Folder for trace, envelope, numbers, figures, a page.")
    ] = None,
    as_json: AsJson = False,
    sensor: Annotated[
        str | None, typer.Option(help="How the loop sees the finger, like touch-panel-120-hz.")
    ] = None,
    compensate: Annotated[
        str, typer.Option(help="Of the resonator's slowness: none, inverse or preview.")
    ] = "none",
    braking: Annotated[
        bool, typer.Option("--braking", help="The drive may invert the carrier's phase.")
    ] = False,
    wave: Annotated[
        str, typer.Option(help="The standing wave's nodes: ignored, felt or compensated.")
    ] = "ignored",
    voltage: Annotated[
        str | None, typer.Option(help='Largest voltage amplitude, like "15 V".')
    ] = None,
    force: Force = None,
    surface: OnSurface = None,
    model: Model = None,
    table: Annotated[str, typer.Option(help="The trace as csv or parquet.")] = "csv",
    drive: Annotated[
        bool, typer.Option("--drive", help="Write the carrier as drive.wav, 192 kHz.")
    ] = False,
    hjif: Annotated[
        bool, typer.Option("--hjif", help="Write the texture as MPEG haptics, texture.hjif.")
    ] = False,
    seed: Annotated[int, typer.Option(help="Of the sensor's noise.")] = 0,
) -> None:
    """A texture on a display under a moving finger: what is asked for and what is rendered."""
    from squeezefilm.analysis.render_command import analyze_render
    from squeezefilm.display import load_display
    from squeezefilm.formats.trajectories import motion_from
    from squeezefilm.quantities import Unit
    from squeezefilm.report import terminal
    from squeezefilm.report.terminal_render import show_lost, show_render
    from squeezefilm.texture_file import preset_texture

    if out is None and (drive or hjif or table != "csv"):
        raise InputError("--drive, --hjif and --table write files; say where with --out DIR")
    what, motion, where = preset_texture(texture), motion_from(stroke), load_display(display)
    with terminal.progress(enabled=sys.stderr.isatty() or not as_json) as step:
        result = analyze_render(
            where,
            what,
            motion,
            voltage=_quantity(voltage, "--voltage", Unit("V")),
            normal_force=_quantity(force, "--force", Unit("N")),
            surface=surface,
            model=model,  # type: ignore[arg-type] # checked with a message by FrictionLaw
            sensor=sensor,
            compensation=compensate,
            braking=braking,
            wave=wave,
            seed=seed,
            progress=step,
        )
        written = None
        if out is not None:
            from squeezefilm.report.render_report import hjif_export, write_render

            written = write_render(
                result, out, table=table, drive=drive, hjif=hjif, progress=step
            )  # fmt: skip
    if as_json:
        _print_json(result.summary())
        return
    show_render(result)
    if hjif:
        show_lost(hjif_export(result))
    if written is not None:
        typer.echo(f"page: {written}")


@app.command()
def textures(as_json: AsJson = False) -> None:
    """List the textures that come with the package, for `render`."""
    from squeezefilm.presets import texture_names
    from squeezefilm.report.terminal_render import show_textures
    from squeezefilm.texture_file import preset_texture

    listing = []
    for name in texture_names():
        one = preset_texture(name)
        listing.append({"name": name, "title": one.title, "quantity": one.texture.quantity})
    if as_json:
        _print_json(listing)
    else:
        show_textures(listing)


@app.command()
def reproduce(
    out: Annotated[Path | None, typer.Option(help="Write figures 4, 5, 10, 11 and a page.")] = None,
    as_json: AsJson = False,
    write_docs: Annotated[
        bool, typer.Option("--write-docs", help="In a checkout: rewrite docs/validation.md.")
    ] = False,
) -> None:
    """Recompute every published claim: what the paper printed, what its formula gives, a verdict.

    Exit code 1 if a verdict differs from the one on record.
    """
    from squeezefilm.analysis.claims import reproduce as run
    from squeezefilm.report import terminal
    from squeezefilm.report.validation import write_reproduction, write_validation_docs

    with terminal.progress(enabled=sys.stderr.isatty() or not as_json) as step:
        result = run(prototype=out is not None or write_docs, progress=step)
        if out is not None:
            written = write_reproduction(result, out, progress=step)
    if write_docs:
        typer.echo(f"wrote {write_validation_docs(result)}", err=True)
    if as_json:
        _print_json(result.summary())
    else:
        terminal.show_claims(result)
        if out is not None:
            typer.echo(f"report: {written}")
    if result.changed:
        for claim in result.changed:
            typer.echo(
                f"the verdict on '{claim.claim.id}' changed: {claim.claim.verdict} is on record, "
                f"{claim.verdict} was found",
                err=True,
            )
        raise typer.Exit(1)


def _show_announcements() -> None:
    """What the library has to say while it works (that it compiles, once), on standard error."""
    import logging

    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("  %(message)s"))
    logger = logging.getLogger("squeezefilm")
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)


def main() -> None:
    """Run the command line: a person's mistake is one message and exit code 2, no traceback."""
    # Before NumPy loads: its linear algebra on our small blocks is slower with threads, by far.
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    _show_announcements()
    try:
        app()
    except SqueezefilmError as error:
        typer.echo(f"error: {error}", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        typer.echo("interrupted; nothing half-written was left", err=True)
        sys.exit(130)
    except BrokenPipeError:
        sys.exit(0)
