"""Verbs about a display: what there is, what it says, and what follows from it."""

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
    Strict,
    Target,
    Voltage,
    app,
    print_json,
    quantity,
    reachable,
    working,
)


@app.command()
def presets(as_json: AsJson = False) -> None:
    """List the displays that come with the package."""
    from squeezefilm.report.kit.terminal import preset_list, show_presets

    listing = preset_list()
    if as_json:
        print_json(listing)
    else:
        show_presets(listing)


@app.command()
def show(target: Target, as_json: AsJson = False) -> None:
    """Show every value of a display, with its source and what is assumed."""
    from squeezefilm.report.kit import terminal

    values = terminal.display_values(target)
    if as_json:
        print_json(values)
    else:
        terminal.show_values(values)


@app.command()
def new(
    file: Annotated[Path, typer.Argument(callback=reachable, help="The TOML file to write.")],
    source: Annotated[str, typer.Option("--from", help="The preset to start from.")],
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")] = False,
) -> None:
    """Write a commented TOML file of your own, starting from a preset."""
    from squeezefilm.display import new_display_file

    new_display_file(file, source, replace=force)
    typer.echo(f"wrote {file}; edit it, then: squeezefilm analyze {file}")


@dataclass(frozen=True)
class AnalyzeOptions:
    """What `analyze` is asked for."""

    target: Target
    out: Annotated[
        Path | None,
        typer.Option(callback=reachable, help="Write result.json and report.html to this folder."),
    ] = None
    as_json: AsJson = False
    voltage: Voltage = None
    frequency: Frequency = None
    amplitude: Annotated[
        str | None,
        typer.Option(help='Vibration amplitude, like "2 um", in place of voltage and plate.'),
    ] = None
    force: Force = None
    surface: OnSurface = None
    model: Model = None
    samples: Annotated[
        int, typer.Option(help="Base samples of the friction's interval, a power of two; 0: none.")
    ] = 32
    theory: Annotated[
        str | None,
        typer.Option(
            help="How a plate is computed: solid (three-dimensional piezoelectric elements, the "
            "default), timoshenko or euler_bernoulli (beams)."
        ),
    ] = None
    strict: Strict = False


@app.command()
@called_with(AnalyzeOptions)
def analyze(asked: AnalyzeOptions) -> None:
    """From the display's description to resonance, amplitude, friction and textures."""
    from squeezefilm.analysis.analyze import analyze as run
    from squeezefilm.display import load_display
    from squeezefilm.quantities import Unit
    from squeezefilm.report.kit import terminal

    display = load_display(asked.target)
    with working(asked.as_json) as step:
        result = run(
            display,
            voltage=quantity(asked.voltage, "--voltage", Unit("V")),
            frequency=quantity(asked.frequency, "--frequency", Unit("Hz")),
            vibration_amplitude=quantity(asked.amplitude, "--amplitude", Unit("m")),
            normal_force=quantity(asked.force, "--force", Unit("N")),
            surface=asked.surface,
            samples=asked.samples,
            theory=asked.theory,  # type: ignore[arg-type] # checked with a message by working_mode
            model=asked.model,  # type: ignore[arg-type] # checked with a message by FrictionLaw
            strict=asked.strict,
            progress=step,
        )
        written = None
        if asked.out is not None:
            from squeezefilm.report.display.page import write_analysis

            written = write_analysis(result, asked.out, progress=step)
    if asked.as_json:
        print_json(result.summary())
        return
    terminal.show_analysis(result)
    if written is not None:
        typer.echo(f"report: {written}")
    else:
        typer.echo("add --out DIR to write result.json and a report with figures")
