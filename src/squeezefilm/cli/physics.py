"""Verbs of the single rooms: friction, film, plate."""

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.arguments import called_with
from squeezefilm.cli.app import (
    AsJson,
    Force,
    Frequency,
    Model,
    OnSurface,
    Target,
    Voltage,
    app,
    print_json,
    quantity,
    reachable,
    working,
)
from squeezefilm.errors import InputError


@dataclass(frozen=True)
class FrictionOptions:
    """What `friction` is asked for."""

    target: Target
    voltage: Voltage = None
    frequency: Frequency = None
    amplitude: Annotated[
        str | None,
        typer.Option(help='Amplitude with the finger on it, like "2 um", in place of a voltage.'),
    ] = None
    force: Force = None
    surface: OnSurface = None
    model: Model = None
    position: Annotated[
        str, typer.Option(help="The pad's centre from an antinode, along the wave.")
    ] = "0 mm"
    speed: Annotated[
        str, typer.Option(help="Of the finger, for the competing mechanism: intermittent contact.")
    ] = "80 mm/s"
    ambient_pressure: Annotated[
        str | None, typer.Option(help='Of the air around, like "2 kPa" for a vacuum experiment.')
    ] = None
    wanted: Annotated[
        float | None, typer.Option(help="A relative friction: which voltage reaches it?")
    ] = None
    samples: Annotated[
        int, typer.Option(help="Base samples of the uncertainty, a power of two; 0 for none.")
    ] = 64
    seed: Annotated[int, typer.Option(help="Of the samples.")] = 1
    out: Annotated[
        Path | None, typer.Option(callback=reachable, help="Folder for friction.json and figures.")
    ] = None
    as_json: AsJson = False


@app.command()
@called_with(FrictionOptions)
def friction(asked: FrictionOptions) -> None:
    """The friction a finger meets, how the load is shared, and how sure all of it is."""
    from squeezefilm.analysis.friction.command import analyze_friction
    from squeezefilm.display import load_display
    from squeezefilm.quantities import Unit
    from squeezefilm.report.friction.terminal import show_friction

    display = load_display(asked.target)
    with working(asked.as_json) as step:
        result = analyze_friction(
            display,
            voltage=quantity(asked.voltage, "--voltage", Unit("V")),
            frequency=quantity(asked.frequency, "--frequency", Unit("Hz")),
            vibration_amplitude=quantity(asked.amplitude, "--amplitude", Unit("m")),
            normal_force=quantity(asked.force, "--force", Unit("N")),
            surface=asked.surface,
            model=asked.model,  # type: ignore[arg-type] # checked with a message by FrictionLaw
            position=quantity(asked.position, "--position", Unit("m")) or 0.0,
            speed=quantity(asked.speed, "--speed", Unit("m/s")) or 0.0,
            ambient_pressure=quantity(asked.ambient_pressure, "--ambient-pressure", Unit("Pa")),
            wanted_friction=asked.wanted,
            samples=asked.samples,
            seed=asked.seed,
            progress=step,
        )
        written = None
        if asked.out is not None:
            from squeezefilm.report.friction.figures import write_friction

            written = write_friction(result, asked.out)
    if asked.as_json:
        print_json(result.summary())
        return
    show_friction(result)
    if written is not None:
        typer.echo(f"figures: {written}")


@dataclass(frozen=True)
class FilmOptions:
    """What `film` is asked for."""

    squeeze_number: Annotated[
        float | None, typer.Option("--squeeze-number", help="σ on width, radius or X semi-axis.")
    ] = None
    excursion: Annotated[
        float | None, typer.Option("--excursion", help="ε, amplitude over mean gap, below 1.")
    ] = None
    shape: Annotated[str, typer.Option(help="strip, disc, rectangle or ellipse.")] = "strip"
    aspect: Annotated[float, typer.Option(help="Length ratio of rectangle or ellipse.")] = 1.0
    polytropic: Annotated[float, typer.Option(help="1 isothermal to 1.4 adiabatic.")] = 1.0
    knudsen: Annotated[float, typer.Option(help="Mean free path over mean gap.")] = 0.0
    slip: Annotated[str, typer.Option(help="first, second, fukui-kaneko or veijola.")] = "first"
    tolerance: Annotated[float, typer.Option(help="Relative, on the over-pressure.")] = 1e-3
    sweep: Annotated[
        bool, typer.Option("--sweep", help="Draw the map over squeeze number and excursion.")
    ] = False
    out: Annotated[
        Path | None, typer.Option(callback=reachable, help="Folder for the map and its numbers.")
    ] = None
    as_json: AsJson = False


@app.command()
@called_with(FilmOptions)
def film(asked: FilmOptions) -> None:
    """Solve the periodic gas film of one shape, or map it over squeeze number and excursion."""
    from squeezefilm.analysis.film.command import FilmRequest, solve_film, sweep_film
    from squeezefilm.report.plate.terminal import show_film

    request = FilmRequest(
        asked.shape, asked.aspect, asked.polytropic, asked.knudsen, asked.slip, asked.tolerance
    )
    with working(asked.as_json) as step:
        if asked.sweep:
            from squeezefilm.report.film_map import write_film_map

            if asked.out is None:
                raise InputError("--sweep draws a map into a folder; say which with --out DIR")
            found = sweep_film(request, progress=step)
            path = write_film_map(found, asked.out)
        else:
            if asked.squeeze_number is None or asked.excursion is None:
                raise InputError(
                    "film needs --squeeze-number and --excursion, or --sweep --out DIR for a map"
                )
            step("solving the film")
            answer = solve_film(
                asked.squeeze_number, asked.excursion, **dataclasses.asdict(request)
            )
    if asked.sweep:
        if asked.as_json:
            print_json(found.summary())
        else:
            typer.echo(f"map: {path}")
    elif asked.as_json:
        print_json(answer.summary())
    else:
        show_film(answer)


@dataclass(frozen=True)
class PlateOptions:
    """What `plate` is asked for."""

    target: Target
    band: Annotated[str | None, typer.Option(help='Modes in a band, like "25 kHz:45 kHz".')] = None
    mode: Annotated[
        str | None,
        typer.Option(
            help="Working mode by nodal lines, like 8,0; of discs and rings circles, diameters."
        ),
    ] = None
    out: Annotated[
        Path | None, typer.Option(callback=reachable, help="Folder for a page with figures.")
    ] = None
    vtu: Annotated[
        Path | None,
        typer.Option(
            callback=reachable, help="Write the solved volume for ParaView to this .vtu file."
        ),
    ] = None
    sensitivity: Annotated[
        bool, typer.Option("--sensitivity", help="What other materials and sizes would change.")
    ] = False
    track: Annotated[
        str | None, typer.Option(help="Follow the modes over a parameter, like ceramic_thickness.")
    ] = None
    start: Annotated[str | None, typer.Option("--from", help='Its first value: "0.5 mm".')] = None
    stop: Annotated[str | None, typer.Option("--to", help='Its last value: "1.5 mm".')] = None
    values: Annotated[int, typer.Option(help="How many values of it.")] = 9
    as_json: AsJson = False


@app.command()
@called_with(PlateOptions)
def plate(asked: PlateOptions) -> None:
    """Solve a plate, disc or stator in three dimensions: modes, amplitude per volt, admittance."""
    from squeezefilm.analysis.plate.command import PlateAnalysis, parse_band, parse_mode
    from squeezefilm.analysis.plate.solve import solve_plate
    from squeezefilm.analysis.plate.tracking import parse_track
    from squeezefilm.display import load_display
    from squeezefilm.report.plate.terminal import show_plate

    display, out, vtu = load_display(asked.target), asked.out, asked.vtu
    mode = None if asked.mode is None else parse_mode(asked.mode)
    band = None if asked.band is None else parse_band(asked.band)
    track = None
    if asked.track is not None:
        track = parse_track(asked.track, asked.start, asked.stop, asked.values)
    if vtu is not None and display.actuator.type != "rectangular_plate":
        raise InputError(
            f"--vtu is for rectangular plates; the actuator of '{display.name}' is of the type "
            f"{display.actuator.type.replace('_', ' ')}"
        )
    with working(asked.as_json) as step:
        written = []
        result = solve_plate(
            display,
            mode=mode,
            band=band,
            sensitivity=asked.sensitivity,
            track=track,
            progress=step,
        )
        if out is not None or vtu is not None:
            from squeezefilm.report.plate.plate import write_mode, write_plate

            step("figures")
            written += [] if out is None else [write_plate(result, out)]
            if vtu is not None and isinstance(result, PlateAnalysis):
                written.append(write_mode(result, vtu))
    if asked.as_json:
        print_json(result.summary())
        return
    show_plate(result)
    for path in written:
        typer.echo(f"wrote {path}")
