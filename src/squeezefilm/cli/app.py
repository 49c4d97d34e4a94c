"""The program of the command line, and the options that several verbs ask for in the same words."""

from __future__ import annotations

import sys
import typing
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.models import OptionInfo

from squeezefilm import __version__
from squeezefilm.core.errors import InputError

if TYPE_CHECKING:
    from squeezefilm.core.progress import SayProgress
    from squeezefilm.physics.display import Display

app = typer.Typer(
    name="squeezefilm",
    help="Design, predict and use tactile displays that change friction by ultrasonic vibration.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


@dataclass(frozen=True)
class In:
    """Unit in which an option's text is read, to stand beside its type."""

    unit: str


Target = Annotated[
    str, typer.Argument(metavar="PRESET|FILE", help="A preset's name or a TOML file.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
Strict = Annotated[
    bool, typer.Option("--strict", help="Refuse contradicting data and models out of range.")
]

# Who computes what is asked by the hundred.
Jobs = Annotated[
    int | None, typer.Option(help="Processes; as many as there are cores if not given.")
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="A Dask cluster's scheduler, tcp://HOST:8786: its workers answer, not this "
        "machine. Who reaches it can run any code there.",
    ),
]

# A texture on a display, and the device that plays it.
Texture = Annotated[
    str, typer.Argument(metavar="TEXTURE|FILE", help="A preset texture or a TOML file.")
]
OnDisplay = Annotated[str, typer.Option(help="A display: a preset's name or a TOML file.")]
LargestVoltage = Annotated[
    str | None, In("V"), typer.Option(help='Largest voltage amplitude, like "15 V".')
]
Pickup = Annotated[
    str | None,
    In("m/V"),
    typer.Option("--pickup", help='Amplitude per signal of the device\'s pickup: "2 um/V".'),
]

# A working point is asked for in the same words by every verb.
Voltage = Annotated[str | None, In("V"), typer.Option(help='Voltage amplitude, like "15 V".')]
Frequency = Annotated[
    str | None,
    In("Hz"),
    typer.Option(help='Drive frequency, like "34 kHz"; the resonance if not given.'),
]
Amplitude = Annotated[
    str | None,
    In("m"),
    typer.Option(
        "--amplitude",
        help='Vibration amplitude with the finger on it, like "2 um", in place of a voltage.',
    ),
]
Budget = Annotated[
    str | None,
    In("s"),
    typer.Option(
        help="Wall-clock time for the solve and what follows, without the start of the program: "
        'like "60 s". What has no time is left coarser, with its larger error, or out.'
    ),
]
Force = Annotated[str | None, In("N"), typer.Option("--force", help='Normal force, like "0.5 N".')]
Speed = Annotated[
    str | None,
    In("m/s"),
    typer.Option("--speed", help='Speed of the finger, like "80 mm/s"; default: the display\'s.'),
]
Finger = Annotated[
    str,
    typer.Option(
        "--finger",
        metavar="new|mean|FILE",
        help="Finger: a new person's (as described, with how people differ), the mean of people, "
        "or this person's, by a recording of friction over the amplitude.",
    ),
]
OnSurface = Annotated[str | None, typer.Option("--surface", help="Name of one of its surfaces.")]
OnPlace = Annotated[
    str | None,
    typer.Option(
        "--place",
        help="The finger's centre on the face, like \"30 mm, 20 mm\" (x, y from a plate's corner, "
        "a disc's middle, or along a stator's track); the best of the active area if not given.",
    ),
]
Model = Annotated[
    str | None,
    typer.Option(
        help="Friction model: levitation (the default), levitation-ridges, partial-levitation, "
        "levitation-2016, paper2008, paper2008-printed."
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


def written_to(help: str) -> Any:
    """An option that names a file or folder to write, see `reachable`."""
    return typer.Option(callback=reachable, help=help)


def given(asked: Any, leave: str) -> dict[str, Any]:
    """The options of a verb as the arguments of what it calls, quantities read in their unit.

    `leave` names, between blanks, the options that the verb keeps to itself. Raises `InputError`,
    with the option named, for a text that is no such quantity.
    """
    hints = typing.get_type_hints(type(asked), include_extras=True)
    kept = leave.split()
    return {
        name: _read(getattr(asked, name), name, typing.get_args(hint))
        for name, hint in hints.items()
        if name not in kept
    }


def _read(value: Any, name: str, marks: tuple[Any, ...]) -> Any:
    units = [mark.unit for mark in marks if isinstance(mark, In)]
    if not units or value is None:
        return value

    from squeezefilm.core.quantities import Unit, parse_quantity

    try:
        return parse_quantity(value, Unit(units[0]))
    except InputError as error:
        raise InputError(f"{option_of(name, marks)}: {error}") from error


def option_of(name: str, marks: Iterable[Any]) -> str:
    """An option as it is typed, by its argument's name and the marks beside its type."""
    for mark in marks:
        if isinstance(mark, OptionInfo):
            # Where an option has another name than its argument, typer holds it as a default.
            for said in (mark.default, *(mark.param_decls or ())):
                if isinstance(said, str) and said.startswith("--"):
                    return said
    return f"--{name.replace('_', '-')}"


def working(quiet: bool) -> AbstractContextManager[SayProgress]:
    """The listener to a verb's steps: at a terminal always, elsewhere unless it is to be quiet."""
    from squeezefilm.core.kit import terminal

    return terminal.progress(enabled=sys.stderr.isatty() or not quiet)


@typing.overload
def read_option(text: str, name: str, unit: str) -> float: ...
@typing.overload
def read_option(text: str | None, name: str, unit: str) -> float | None: ...
def read_option(text: str | None, name: str, unit: str) -> float | None:
    """The SI value of one option's text, None where it was not given.

    Raises `InputError`, with the option named, for a text that is no such quantity.
    """
    value: float | None = _read(text, name, (In(unit),))
    return value


def to_be_solved(
    target: str,
    voltage: str | None = None,
    *,
    amplitude: str | None = None,
    theory: str | None = None,
    quiet: bool = False,
) -> Display:
    """The display that a verb will solve, refused before any work where it cannot be right.

    What is doubtful of it, what to expect and how long its solve takes (where a `theory` does not
    go without) is told on standard error; `quiet` as in `working`. A vibration of a given
    `amplitude` needs no voltage. Raises what `foreseen` raises.
    """
    from squeezefilm.physics.plausibility.checks import foreseen

    volts = read_option(voltage, "voltage", "V") if amplitude is None else 0.0
    seen = foreseen(target, volts)
    if sys.stderr.isatty() or not quiet:
        for doubt in seen.doubts:
            typer.echo(f"doubtful: {doubt}", err=True)
        if seen.sentence and theory in (None, "solid"):
            typer.echo(seen.sentence, err=True)
    return seen.display


def answer(
    as_json: bool, found: Any, show: Callable[[Any], object], **written: Path | None
) -> None:
    """Print what was found as one JSON object, or in words, and then what was written by its kind:
    ``page: …``."""
    if as_json:
        print_json(found.summary() if hasattr(found, "summary") else found)
        return
    show(found)
    for kind, path in written.items():
        if path is not None:
            typer.echo(f"{kind}: {path}")


def print_json(value: Any) -> None:
    """Print one JSON object."""
    import json

    typer.echo(json.dumps(value, indent=2, ensure_ascii=False))
