"""The driven modes of a display in the terminal, and the shapes of those that move most."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.numbers import HZ, PER_VOLT, SPEED, shown
from squeezefilm.core.kit.page_style import FigureOf, drawn_figures, picture_files
from squeezefilm.core.kit.terminal import bullets, heading, say, table
from squeezefilm.physics.chain.pad_place import place_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.figure import Figure

    from squeezefilm.design.plate.listed_modes import ListedMode
    from squeezefilm.design.plate.modes import ModeList
    from squeezefilm.design.plate.ring_pair import RingPair

_HEAD = ("mode", "frequency", "per volt", "neighbour", "away", "adds", "")
# So many shapes are drawn: those that move most.
_SHAPES = 12


def mode_list_rows(result: ModeList) -> list[tuple[str, ...]]:
    """A row a mode: label, frequency, amplitude per volt at an antinode, the neighbour that counts
    most, its distance in half-bandwidths, what it adds, and remarks."""
    working = result.working_mode
    rows: list[tuple[str, ...]] = []
    for mode in result.modes:
        far = mode.neighbour_distance
        rows.append(
            (
                ("→ " if mode is working else "  ") + mode.label,
                shown(mode.frequency, HZ, 4),
                shown(mode.alone_per_volt, PER_VOLT, 3),
                mode.neighbour or "",
                "" if far is None else f"{far:.3g}",
                "" if far is None else _percent(mode.neighbour_share),
                ", ".join(_remarks(mode)),
            )
        )
    return rows


def _remarks(mode: ListedMode) -> Iterator[str]:
    if mode.audible:
        yield "audible"
    if mode.perhaps_audible:
        yield "perhaps audible"
    if mode.hidden:
        yield "hidden"
    elif mode.crowded:
        yield "crowded"
    if not mode.unique:
        yield "label not unique"
    if mode.choice is not None:
        yield mode.choice


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 0.995 else f"{100 * share:.0f} %"


def mode_list_sentences(result: ModeList) -> list[tuple[str, str, str]]:
    """Sentences to read beside the table: a word for the kind, the sentence, a style."""
    said = [("symmetry", rule, "cyan") for rule in result.rules]
    own = result.working_mode
    if result.forbidden is not None:
        text = f"The display asks for {result.working}, and {result.forbidden}."
        said.append(("doubt", text, "yellow"))
    elif own is None:
        text = (
            f"The display's mode {result.working} is not in this list: it lies outside of the "
            "band, is hardly driven, or its nodal lines are so bent that it has another label."
        )
        said.append(("doubt", text, "yellow"))
    elif not own.unique:
        text = (
            f"More than one mode is labelled {own.label}. To say which is meant, write "
            "working_frequency beside nodal_lines; without it the most strongly driven is taken."
        )
        said.append(("doubt", text, "yellow"))
    said.append(("suggested", result.suggestion.text, "green"))
    return said


def show_mode_list(result: ModeList) -> None:
    """Print the driven modes of a display, and what follows for the choice of one."""
    display, (low, high) = result.display, result.band
    heading(f"{display.title} [{display.name}]")
    say(
        f"Driven modes: {len(result.modes)}, from {shown(low, HZ)} to {shown(high, HZ)}; amplitude "
        "of each alone, zero to peak, at its antinode, at resonance, without a finger"
    )
    rows = mode_list_rows(result)
    table(_HEAD, rows, fixed=range(len(_HEAD) - 1))
    say(
        "→ is the display's mode. The neighbour is the mode that counts most at this one's "
        "resonance: how many half-bandwidths (its f/2Q) it is away, and how much it adds to the "
        "amplitude there. From 20 % on a mode is crowded, from 100 % on hidden."
    )
    if (solved := result.solved) is not None:
        say(
            f"{solved.label} with the contribution of all other modes: "
            f"{shown(solved.amplitude_per_volt, PER_VOLT)} at its antinode "
            f"({place_words(solved.lobe)}); squeezefilm plate and analyze give the same."
        )
    bullets(mode_list_sentences(result))
    if result.pair is not None:
        show_pair(result.pair)
    say(
        f"{result.model}; frequencies "
        + (
            f"up to {100 * result.frequency_error:.2g} % high, so that the list reaches as far "
            "above the band; the display's own mode is solved, mostly to 0.3 %"
            if result.screened
            else f"within {100 * result.frequency_error:.2g} % (estimated)"
        )
    )


def pair_rows(pair: RingPair) -> list[tuple[str, str, str, str]]:
    """Rows of a pair's distance and of the worst that follows: ratio, share, crests' speed."""
    return [
        (
            f"{shown(at.split, HZ, 3)} ({at.half_bandwidths:.3g} half-bandwidths)",
            f"{at.standing_wave_ratio:.3g}",
            f"{100 * at.travelling:.2g} %",
            shown(at.crest_speed, SPEED, 2),
        )
        for at in pair.splits
    ]


def show_pair(pair: RingPair) -> None:
    """Print what one channel makes of a ring's pair of modes."""
    heading(f"One channel on the pair {pair.label}")
    bullets([("–", sentence, "cyan") for sentence in pair.sentences])
    table(
        ("pair apart by", "standing-wave ratio", "travels", "along the ring at crests"),
        pair_rows(pair),
    )


@style.drawn
def shapes(result: ModeList) -> Figure:
    """The modes of a plate that move most, from above, in the order of frequency."""
    strongest = sorted(result.screened, key=lambda mode: -mode.alone_per_volt)[:_SHAPES]
    chosen = sorted(strongest, key=lambda mode: mode.frequency)
    columns = 4
    rows = -(-len(chosen) // columns)
    figure = style.new_figure(
        f"The {len(chosen)} modes that move most, from above",
        f"{result.model}; up and down in two colours, each mode to its own scale",
        1.0 + 1.7 * rows,
    )
    extent = [1e3 * side for side in result.display.actuator.extent]
    for axes, mode in zip(style.panels(figure, len(chosen), columns), chosen, strict=True):
        axes.set_axis_off()
        x = np.linspace(0, extent[0], mode.shape.shape[0])
        y = np.linspace(0, extent[1], mode.shape.shape[1])
        axes.contourf(x, y, mode.shape.T, [-1.01, 0, 1.01], colors=[style.MINUS, style.PLUS])
        axes.contour(x, y, mode.shape.T, [-0.5, 0.5], colors=style.MUTED, linewidths=0.6)
        axes.contour(x, y, mode.shape.T, [0], colors=style.INK, linewidths=0.9)
        per_volt = shown(mode.alone_per_volt, PER_VOLT, 3)
        axes.set_title(f"{mode.name}  {mode.frequency / 1e3:.2f} kHz\n{per_volt}", fontsize=9)
        axes.set(aspect="equal")
    return figure


FIGURES = (FigureOf("shapes", "Shapes", shapes, has=lambda listed: listed.screened),)


def write_modes(result: ModeList, folder: Path) -> Path:
    """Write modes.json, and shapes.png where shapes are known, into a folder; the folder."""
    files = picture_files(drawn_figures(FIGURES, result))
    files["modes.json"] = json_text(result.summary())
    write_folder(folder, files)
    return folder
