"""Verbs about textures."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from squeezefilm.arguments import called_with
from squeezefilm.cli.app import (
    AsJson,
    Force,
    LargestVoltage,
    Model,
    OnDisplay,
    OnSurface,
    Texture,
    app,
    print_json,
    quantity,
    reachable,
    working,
)
from squeezefilm.errors import InputError


@dataclass(frozen=True)
class RenderOptions:
    """What `render` is asked for."""

    texture: Texture
    display: OnDisplay
    stroke: Annotated[
        str, typer.Option(help='Finger motion: STROKE.csv, or "60 mm/s over 4 cm, 2 passes".')
    ] = "60 mm/s over 4 cm, 2 passes"
    out: Annotated[
        Path | None,
        typer.Option(
            callback=reachable, help="Folder for trace, envelope, numbers, figures, a page."
        ),
    ] = None
    as_json: AsJson = False
    sensor: Annotated[
        str | None, typer.Option(help="How the loop sees the finger, like touch-panel-120-hz.")
    ] = None
    compensate: Annotated[
        str, typer.Option(help="Of the resonator's slowness: none, inverse or preview.")
    ] = "none"
    braking: Annotated[
        bool, typer.Option("--braking", help="The drive may invert the carrier's phase.")
    ] = False
    wave: Annotated[
        str, typer.Option(help="The standing wave's nodes: ignored, felt or compensated.")
    ] = "ignored"
    voltage: LargestVoltage = None
    force: Force = None
    surface: OnSurface = None
    model: Model = None
    table: Annotated[str, typer.Option(help="The trace as csv or parquet.")] = "csv"
    drive: Annotated[
        bool, typer.Option("--drive", help="Write the carrier as drive.wav, 192 kHz.")
    ] = False
    hjif: Annotated[
        bool, typer.Option("--hjif", help="Write the texture as MPEG haptics, texture.hjif.")
    ] = False
    seed: Annotated[int, typer.Option(help="Of the sensor's noise.")] = 0


@app.command()
@called_with(RenderOptions)
def render(asked: RenderOptions) -> None:
    """A texture on a display under a moving finger: what is asked for and what is rendered."""
    from squeezefilm.chain.rendered_texture import render_texture
    from squeezefilm.display import load_display
    from squeezefilm.formats.trajectories import motion_from
    from squeezefilm.quantities import Unit
    from squeezefilm.report.textures.terminal import show_lost, show_render
    from squeezefilm.texture_file import load_texture

    out, table, drive, hjif = asked.out, asked.table, asked.drive, asked.hjif
    if out is None and (drive or hjif or table != "csv"):
        raise InputError("--drive, --hjif and --table write files; say where with --out DIR")
    what, motion = load_texture(asked.texture), motion_from(asked.stroke)
    where = load_display(asked.display)
    with working(asked.as_json) as step:
        result = render_texture(
            where,
            what,
            motion,
            voltage=quantity(asked.voltage, "--voltage", Unit("V")),
            normal_force=quantity(asked.force, "--force", Unit("N")),
            surface=asked.surface,
            model=asked.model,  # type: ignore[arg-type] # checked with a message by FrictionLaw
            sensor=asked.sensor,
            compensation=asked.compensate,
            braking=asked.braking,
            wave=asked.wave,
            seed=asked.seed,
            progress=step,
        )
        written = None
        if out is not None:
            from squeezefilm.report.textures.page import hjif_export, write_render

            written = write_render(result, out, table=table, drive=drive, hjif=hjif, progress=step)
    if asked.as_json:
        print_json(result.summary())
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
    from squeezefilm.report.textures.terminal import show_textures
    from squeezefilm.texture_file import load_texture

    listing = []
    for name in texture_names():
        one = load_texture(name)
        listing.append({"name": name, "title": one.title, "quantity": one.texture.quantity})
    if as_json:
        print_json(listing)
    else:
        show_textures(listing)
