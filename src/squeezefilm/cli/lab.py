"""The verb that opens the browser lab."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import app


@app.command()
def lab(
    folder: Annotated[
        Path, typer.Option(help="Where displays, textures, strokes and studies are saved.")
    ] = Path("squeezefilm-lab"),
    port: Annotated[int, typer.Option(help="On this computer; the next free one if taken.")] = 8631,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")
    ] = True,
    lan: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="This computer's address in the local network, to pair tablets as participant "
            "stations by TLS; needs squeezefilm[lan].",
        ),
    ] = None,
) -> None:
    """Open the lab, a page on this computer: design, feel, drive and study."""
    from squeezefilm.lab.serve import serve

    serve(folder, port=port, browser=browser, lan=lan, say=lambda line: typer.echo(line))
