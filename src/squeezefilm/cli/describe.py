"""Verbs about a display: what there is, what it says, and what follows from it, room by room."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import (
    Amplitude,
    AsJson,
    Budget,
    Finger,
    Force,
    Frequency,
    In,
    Model,
    OnPlace,
    OnSurface,
    Speed,
    Strict,
    Target,
    Voltage,
    answer,
    app,
    given,
    reachable,
    read_option,
    to_be_solved,
    working,
    written_to,
)
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError


@app.command()
def presets(as_json: AsJson = False) -> None:
    """List the displays, motors and skin-stretch arrays that come with the package."""
    from squeezefilm.cli.described import preset_list, show_presets

    answer(as_json, preset_list(), show_presets)


@app.command()
def show(target: Target, as_json: AsJson = False) -> None:
    """Show every value of a display, motor or skin-stretch array, with its source, what is assumed
    and what has no source."""
    from squeezefilm.cli.described import display_values, show_values

    answer(as_json, display_values(target), show_values)


@app.command()
def materials(
    name: Annotated[
        str | None, typer.Argument(help="Any name of one of them: shows all its values.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """List the materials that a display's file may name, with their sources."""
    from squeezefilm.cli.described import material_list, show_materials

    answer(as_json, material_list(name), show_materials)


@app.command()
def new(
    file: Annotated[Path, typer.Argument(callback=reachable, help="The TOML file to write.")],
    source: Annotated[
        str | None,
        typer.Option("--from", help="The preset to start from; squeezefilm presets lists them."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")] = False,
) -> None:
    """Write a commented TOML file of your own, starting from a preset."""
    from squeezefilm.core.presets import display_names
    from squeezefilm.physics.display import new_display_file

    if source is None:
        raise InputError(
            f"a new file starts from a display's preset; say which: squeezefilm new {file} --from "
            f"biet2008-plate. There are {', '.join(display_names())}"
        )
    new_display_file(file, source, replace=force)
    typer.echo(f"wrote {file}; edit it, then: squeezefilm analyze {file}")


@dataclass(frozen=True)
class PointOptions:
    """The display and the working point that `analyze` and `friction` are asked for."""

    target: Target
    voltage: Voltage = None
    frequency: Frequency = None
    vibration_amplitude: Amplitude = None
    normal_force: Force = None
    surface: OnSurface = None
    model: Model = None
    speed: Speed = None
    finger: Finger = "new"
    place: OnPlace = None
    samples: Annotated[
        int, typer.Option(help="Base samples of the friction's interval, a power of two; 0: none.")
    ] = 16
    wanted_friction: Annotated[
        str | None,
        In("1"),
        typer.Option(
            "--wanted", help='A relative friction, like 0.5 or "50 %": which voltage reaches it?'
        ),
    ] = None
    as_json: AsJson = False


@dataclass(frozen=True)
class AnalyzeOptions(PointOptions):
    """Options of `analyze`."""

    out: Annotated[Path | None, written_to("Write result.json and report.html to this folder.")] = (
        None
    )
    sensitivities: Annotated[
        str | None,
        typer.Option(
            help="Say how much each value changes the result. quick: by a beam model, seconds for "
            "all values (as --all has it); solved: in three dimensions, two solves a value."
        ),
    ] = None
    theory: Annotated[
        str | None,
        typer.Option(
            help="Theory of the plate: solid (three-dimensional piezoelectric elements, the "
            "default), timoshenko or euler_bernoulli (beams)."
        ),
    ] = None
    strict: Strict = False
    budget: Budget = None
    whole: Annotated[
        bool,
        typer.Option(
            "--all",
            help="Print warnings in full; there and in the report: what each value does and what "
            "other models say.",
        ),
    ] = False


@app.command()
@called_with(AnalyzeOptions)
def analyze(asked: AnalyzeOptions) -> None:
    """Analyse a display from its description to resonance, amplitude, friction and textures. A
    motor's or a skin-stretch array's file is analysed as such; of the options it takes --voltage,
    --out and --json."""
    from squeezefilm.actuators.described import is_actuator

    if is_actuator(asked.target):
        from squeezefilm.cli.described import analyze_actuator

        analyze_actuator(asked)
        return
    from squeezefilm.core.blas_threads import one_blas_thread

    display = to_be_solved(
        asked.target,
        asked.voltage,
        amplitude=asked.vibration_amplitude,
        theory=asked.theory,
        quiet=asked.as_json,
    )
    with one_blas_thread(), working(asked.as_json) as step:
        from squeezefilm.design.analysis.analyze import analyze as run
        from squeezefilm.design.analysis.report import page
        from squeezefilm.measure.fits.friction.friction_scores import with_finger

        display = with_finger(display, asked.finger)
        options = given(asked, leave="target finger out as_json")
        result = run(display, **options, progress=step)
        written = None
        if asked.out is not None:
            written = page.write_analysis(result, asked.out, progress=step)
        elif not asked.as_json:
            page.compute_shown(result, step)
    answer(asked.as_json, result, page.show_analysis, report=written)
    if written is None and not asked.as_json:
        typer.echo("add --out DIR to write result.json and a report with figures")


@dataclass(frozen=True)
class FrictionOptions(PointOptions):
    """Options of `friction`."""

    position: Annotated[
        str | None,
        In("m"),
        typer.Option(help="The pad's centre from an antinode, along an even wave."),
    ] = None
    ambient_pressure: Annotated[
        str | None,
        In("Pa"),
        typer.Option(help='Ambient pressure, like "2 kPa" for a vacuum experiment.'),
    ] = None
    seed: Annotated[int, typer.Option(help="Seed of the random samples.")] = 1
    out: Annotated[Path | None, written_to("Folder for friction.json and figures.")] = None


@app.command()
@called_with(FrictionOptions)
def friction(asked: FrictionOptions) -> None:
    """The friction a finger meets, how the load is shared, and how sure all of it is."""
    from squeezefilm.design.friction import analyze_friction
    from squeezefilm.design.report.friction import show_friction, write_friction
    from squeezefilm.measure.fits.friction.friction_scores import with_finger

    display = to_be_solved(
        asked.target, asked.voltage, amplitude=asked.vibration_amplitude, quiet=asked.as_json
    )
    with working(asked.as_json) as step:
        display = with_finger(display, asked.finger)
        result = analyze_friction(
            display, **given(asked, leave="target finger out as_json"), progress=step
        )
        written = None if asked.out is None else write_friction(result, asked.out)
    answer(asked.as_json, result, show_friction, figures=written)


@dataclass(frozen=True)
class FilmOptions:
    """Options of `film`."""

    squeeze_number: Annotated[
        str | None,
        In("1"),
        typer.Option("--squeeze-number", help="σ on width, radius or X semi-axis."),
    ] = None
    excursion: Annotated[
        str | None,
        In("1"),
        typer.Option("--excursion", help="ε, amplitude over mean gap, below 1."),
    ] = None
    shape: Annotated[str, typer.Option(help="strip, disc, rectangle or ellipse.")] = "strip"
    aspect_ratio: Annotated[
        str, In("1"), typer.Option("--aspect", help="Length ratio of rectangle or ellipse.")
    ] = "1"
    polytropic_exponent: Annotated[
        str, In("1"), typer.Option("--polytropic", help="1 isothermal to 1.4 adiabatic.")
    ] = "1"
    knudsen_number: Annotated[
        str, In("1"), typer.Option("--knudsen", help="Mean free path over mean gap.")
    ] = "0"
    slip: Annotated[str, typer.Option(help="first, second, fukui-kaneko or veijola.")] = "first"
    tolerance: Annotated[
        str, In("1"), typer.Option(help='Relative tolerance of the over-pressure, like "0.1 %".')
    ] = "0.001"
    sweep: Annotated[
        bool, typer.Option("--sweep", help="Draw the map over squeeze number and excursion.")
    ] = False
    out: Annotated[Path | None, written_to("Folder for the map and its numbers.")] = None
    as_json: AsJson = False


@app.command()
@called_with(FilmOptions)
def film(asked: FilmOptions) -> None:
    """Solve the periodic gas film of one shape, or map it over squeeze number and excursion."""
    from squeezefilm.design.film import FilmRequest, solve_film, sweep_film
    from squeezefilm.design.report.film import show_film, write_film_map

    of_film = given(asked, leave="sweep out as_json")
    squeeze_number, excursion = of_film.pop("squeeze_number"), of_film.pop("excursion")
    with working(asked.as_json) as step:
        if asked.sweep:
            if asked.out is None:
                raise InputError("--sweep draws a map into a folder; say which with --out DIR")
            films = sweep_film(FilmRequest(**of_film), progress=step)
            path = write_film_map(films, asked.out)
        else:
            if squeeze_number is None or excursion is None:
                raise InputError(
                    "film needs --squeeze-number and --excursion, or --sweep --out DIR for a map"
                )
            step("solving the film")
            solved = solve_film(squeeze_number, excursion, **of_film)
    if asked.sweep:
        answer(asked.as_json, films, lambda _: None, map=path)
    else:
        answer(asked.as_json, solved, show_film)


@dataclass(frozen=True)
class PlateOptions:
    """Options of `plate`."""

    target: Target
    band: Annotated[str | None, typer.Option(help='Modes in a band, like "25 kHz..45 kHz".')] = None
    mode: Annotated[
        str | None,
        typer.Option(
            help="Working mode by nodal lines, like 8,0; of discs and rings circles, diameters."
        ),
    ] = None
    out: Annotated[Path | None, written_to("Folder for a page with figures.")] = None
    vtu: Annotated[
        Path | None, written_to("Write the solved volume for ParaView to this .vtu file.")
    ] = None
    budget: Budget = None
    as_json: AsJson = False


@app.command()
@called_with(PlateOptions)
def plate(asked: PlateOptions) -> None:
    """Solve a plate, disc or stator in three dimensions: modes, amplitude per volt, admittance."""
    from squeezefilm.design.plate.command import PlateAnalysis, parse_band, parse_mode, solve_plate
    from squeezefilm.design.plate.report.terminal import show_plate

    display, out, vtu = to_be_solved(asked.target, quiet=asked.as_json), asked.out, asked.vtu
    budget = read_option(asked.budget, "budget", "s")
    mode = None if asked.mode is None else parse_mode(asked.mode)
    band = None if asked.band is None else parse_band(asked.band)
    if vtu is not None and display.actuator.type != "rectangular_plate":
        raise InputError(
            f"--vtu is for rectangular plates; the actuator of '{display.name}' is of the type "
            f"{display.actuator.type.replace('_', ' ')}"
        )
    with working(asked.as_json) as step:
        written = []
        result = solve_plate(display, mode=mode, band=band, progress=step, budget=budget)
        if out is not None or vtu is not None:
            from squeezefilm.design.plate.report.page import write_mode, write_plate

            step("figures")
            written += [] if out is None else [write_plate(result, out)]
            if vtu is not None and isinstance(result, PlateAnalysis):
                written.append(write_mode(result, vtu))
    answer(asked.as_json, result, show_plate)
    for path in [] if asked.as_json else written:
        typer.echo(f"wrote {path}")


@dataclass(frozen=True)
class ModesOptions:
    """Options of `modes`."""

    target: Target
    band: Annotated[
        str | None,
        typer.Option(help='Range to look in, like "20 kHz..60 kHz"; 15 to 60 kHz if not given.'),
    ] = None
    out: Annotated[Path | None, written_to("Folder for modes.json and figures.")] = None
    as_json: AsJson = False


@app.command()
@called_with(ModesOptions)
def modes(asked: ModesOptions) -> None:
    """List the modes that the drive can move, in seconds, and suggest which to work in."""
    from squeezefilm.design.plate.command import parse_band
    from squeezefilm.design.plate.modes import DEFAULT_BAND, list_modes
    from squeezefilm.design.plate.report.modes import show_mode_list
    from squeezefilm.physics.display import load_display

    display = load_display(asked.target)
    band = DEFAULT_BAND if asked.band is None else parse_band(asked.band)
    with working(asked.as_json) as step:
        result = list_modes(display, band, progress=step)
        written = None
        if asked.out is not None:
            from squeezefilm.design.plate.report.modes import write_modes

            step("figures")
            written = write_modes(result, asked.out)
    answer(asked.as_json, result, show_mode_list, figures=written)
