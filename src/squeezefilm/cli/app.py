"""The program of the command line, and the options that several verbs ask for in the same words."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from squeezefilm import __version__
from squeezefilm.errors import InputError

if TYPE_CHECKING:
    from squeezefilm.progress import SayProgress
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

# A texture on a display, and the device that plays it.
Texture = Annotated[
    str, typer.Argument(metavar="TEXTURE|FILE", help="A preset texture or a TOML file.")
]
OnDisplay = Annotated[str, typer.Option(help="A display: a preset's name or a TOML file.")]
LargestVoltage = Annotated[str | None, typer.Option(help='Largest voltage amplitude, like "15 V".')]
Pickup = Annotated[
    str | None, typer.Option(help='Amplitude per signal of the device\'s pickup: "2 um/V".')
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


def reachable(path: Path | None) -> Path | None:
    """The path of an option that is written to, refused before any work if nothing can be there.

    Raises `InputError` for a name too long for the system, or a way to it through a file.
    """
    if path is not None:
        try:
            path.lstat()
        except FileNotFoundError:
            pass
        except (OSError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) else error
            raise InputError(f"{path!s:.200}: nothing can be written there: {why}") from error
    return path


def quantity(text: str | None, option: str, unit: Unit) -> float | None:
    """The value of an option that is a quantity text, with the option named in the error."""
    if text is None:
        return None

    from squeezefilm.quantities import parse_quantity

    try:
        return parse_quantity(text, unit)
    except InputError as error:
        raise InputError(f"{option}: {error}") from error


def working(quiet: bool) -> AbstractContextManager[SayProgress]:
    """Where a verb tells its steps: at a terminal always, elsewhere unless it is to be quiet."""
    from squeezefilm.report.kit import terminal

    return terminal.progress(enabled=sys.stderr.isatty() or not quiet)


def print_json(value: Any) -> None:
    """Print one JSON object."""
    import json

    typer.echo(json.dumps(value, indent=2, ensure_ascii=False))
