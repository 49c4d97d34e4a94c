"""The verb that shows and clears what is kept on disk between runs."""

from typing import Annotated

import typer

from squeezefilm.cli.app import AsJson, app, print_json


@app.command()
def cache(
    clear: Annotated[
        bool, typer.Option("--clear", help="Delete it; what is needed again takes its time again.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Show what is kept on disk so that it need not be computed twice, or clear it."""
    from squeezefilm.core.kept.store import CACHE_VARIABLE, cache_folder, clear_kept, kept_sizes

    folder = cache_folder()
    cleared = clear_kept() if clear else None
    sizes = kept_sizes()
    if as_json:
        print_json(
            {
                "folder": None if folder is None else str(folder),
                "cleared_files": cleared,
                "kept": {
                    kind: {"files": count, "bytes": size} for kind, (count, size) in sizes.items()
                },
            }
        )
        return
    if folder is None:
        typer.echo(f"Nothing is kept: {CACHE_VARIABLE} is off.")
        return
    if cleared is not None:
        typer.echo(f"{cleared} files deleted from {folder}")
        return
    typer.echo(f"{folder} ({CACHE_VARIABLE} names another folder, or off)")
    for kind, (count, size) in sizes.items():
        typer.echo(f"  {kind}: {count} files, {size / 1e6:.1f} MB")
    typer.echo(f"In all {sum(size for _, size in sizes.values()) / 1e6:.1f} MB; clear it: --clear")
