"""Verbs about a real device and its records."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import AsJson, app, print_json


@app.command()
def export(
    trace: Annotated[Path, typer.Argument(help="A trace that a session recorded.")],
    to: Annotated[Path, typer.Option(help="The file to write, .csv or .parquet.")],
    as_json: AsJson = False,
) -> None:
    """Write a recorded trace as CSV or Parquet, with its metadata, and say what it had lost."""
    from squeezefilm.report.terminal_play import show_export
    from squeezefilm.results import to_json
    from squeezefilm.session.export import export_trace

    done = export_trace(trace, to)
    if as_json:
        print_json(to_json(done))
    else:
        show_export(done)
