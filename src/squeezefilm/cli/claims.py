"""The verb that recomputes published claims."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.cli.app import AsJson, answer, app, working, written_to
from squeezefilm.core.errors import InputError


@app.command()
def reproduce(
    out: Annotated[Path | None, written_to("Write figures 4, 5, 10, 11 and a page.")] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Compare measured friction with every model instead: a folder, or "
            "'published' for the published curves that come with the program.",
        ),
    ] = None,
    as_json: AsJson = False,
    write_docs: Annotated[
        bool,
        typer.Option(
            "--write-docs",
            help="Rewrite docs/reference/validation.md, or published-friction.md (in a checkout).",
        ),
    ] = False,
) -> None:
    """Recompute every published claim: what the paper printed, what its formula gives, a verdict.

    Exit code 1 if a verdict differs from the one on record.
    """
    if data is not None:
        _measured_curves(data, out, as_json, write_docs)
        return
    from squeezefilm.core.kit.folder import checkout
    from squeezefilm.validation.command import reproduce as run
    from squeezefilm.validation.report.page import (
        show_claims,
        write_reproduction,
        write_validation_docs,
    )

    if write_docs:
        # Minutes of work lie before the writing.
        checkout()
    with working(as_json) as step:
        result = run(prototype=out is not None or write_docs, progress=step)
        written = None if out is None else write_reproduction(result, out, progress=step)
    if write_docs:
        typer.echo(f"wrote {write_validation_docs(result)}", err=True)
    answer(as_json, result, show_claims, report=written)
    if result.changed:
        for claim in result.changed:
            typer.echo(
                f"the verdict on '{claim.claim.name}' changed: {claim.claim.verdict} is on record, "
                f"{claim.verdict} was found",
                err=True,
            )
        raise typer.Exit(1)


def _measured_curves(data: Path, out: Path | None, as_json: bool, write_docs: bool) -> None:
    """Compare measured friction with every model: `reproduce --data`."""
    published = str(data) == "published" and not data.exists()
    if write_docs and not published:
        raise InputError("--write-docs writes a page of --data published, of no other data")
    from squeezefilm.core import presets
    from squeezefilm.core.kit.folder import checkout
    from squeezefilm.validation.published_friction import compare_folder
    from squeezefilm.validation.report.published import (
        show_comparisons,
        write_comparisons,
        write_friction_docs,
    )

    if write_docs:
        # Minutes of work lie before the writing.
        checkout()
    with working(as_json) as step:
        compared = compare_folder(presets.friction_folder() if published else data, step)
        written = None if out is None else write_comparisons(compared, out)
    if write_docs:
        typer.echo(f"wrote {write_friction_docs(compared)}", err=True)
    answer(as_json, compared, show_comparisons, page=written)
