"""Output for films: the numbers of one, and the map over squeeze number and excursion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.terminal import say, show_rows
from squeezefilm.physics.film.planar.film import FilmPlanar

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.design.film import FilmAnswer, FilmMap


@style.drawn
def film_map(films: FilmMap) -> Figure:
    """Figure of over-pressure (left) and its share of the asymptote (right) over σ and ε."""
    request = films.request
    figure = style.new_figure(
        f"The {request.shape}'s over-pressure grows with both; below σ of about 100 it falls short "
        "of its asymptote",
        f"{films.model}, tolerance {request.tolerance:.1g} of the over-pressure, "
        f"n = {request.polytropic_exponent:.3g}, Kn = {request.knudsen_number:.3g}",
        4.8,
    )
    left, right = figure.subplots(1, 2, sharey=True)
    sigma, excursion = films.squeeze_number, films.excursion_ratio
    levels = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 3e-2, 0.1, 0.3, 1, 3]
    lines = left.contour(
        sigma, excursion, films.over_pressure.T, levels=levels, colors=style.INK, linewidths=1.1
    )
    left.clabel(lines, fmt=lambda v: f"{v:g}", fontsize=8.5)
    # The largest σ of the map stands for the asymptote: a polytropic one has no plain form.
    share = 100 * films.over_pressure / films.over_pressure[-1]
    parts = right.contourf(sigma, excursion, share.T, levels=np.arange(0, 101, 10), cmap="cividis")
    right.contour(
        sigma, excursion, share.T, levels=[90], colors=style.INK, linewidths=1.6, linestyles="--"
    )
    figure.colorbar(parts, ax=right, label="share of the over-pressure at σ = 10⁴ (%)")
    left.set_title("over-pressure W − 1 over ambient")
    right.set_title("dashed: 90 %")
    for axes in (left, right):
        axes.set(xscale="log", xlabel="squeeze number σ")
    left.set(ylabel="excursion ε = amplitude over mean gap")
    return figure


@style.drawn
def film_pressure(answer: FilmAnswer) -> Figure:
    """The mean pressure of one film along it (in the plane: near Y = 0), and the gap it has."""
    film = answer.film
    figure = style.new_figure(
        f"The film's over-pressure is {answer.over_pressure:.3g} of the ambient pressure, within "
        f"{answer.over_pressure_error:.1g}",
        f"{answer.model}, σ = {answer.squeeze_number:.4g}, ε = {answer.excursion_ratio:.3g}",
        4.4,
    )
    if isinstance(film, FilmPlanar):
        axes = figure.subplots()
        middle = np.abs(film.Y) <= np.abs(film.Y).min() + 1e-9
        order = np.argsort(film.X[middle])
        axes.plot(film.X[middle][order], film.mean_pressure[middle][order], color=style.BLUE)
        axes.set(xlabel="X over the reference length", ylabel="mean pressure over ambient")
        return figure
    top, axes = figure.subplots(2, 1, sharex=True, height_ratios=[1, 1.4])
    top.fill_between(film.position, film.gap.min(1), film.gap.max(1), color=style.BAND, lw=0)
    top.plot(film.position, film.gap.mean(1), color=style.MUTED, lw=1.2)
    top.set(ylabel="gap over H0", ylim=(0, None))
    axes.plot(film.position, film.mean_pressure, color=style.BLUE)
    axes.set(
        xlabel="r / R" if film.shape == "disc" else "x / l0", ylabel="mean pressure over ambient"
    )
    return figure


def write_film_map(films: FilmMap, folder: Path) -> Path:
    """Write film-map.json and film-map.png into `folder`; the picture's path."""
    data, picture = json_text(films.summary()), style.png(film_map(films))
    return write_folder(folder, {"film-map.json": data, "film-map.png": picture})


def show_film(answer: FilmAnswer) -> None:
    """Print one solved film."""
    error = f"± {answer.over_pressure_error:.1g} (estimated)"
    harmonic = f"± {answer.force_error:.1g}, of p0·A·ε, first harmonic"
    rows = [
        ("Mean load W", f"{answer.mean_load:.8g}", "over ambient pressure × area"),
        ("Over-pressure W − 1", f"{answer.over_pressure:.6g}", error),
        ("Stiffness", f"{answer.stiffness_relative:.6g}", harmonic),
        ("Damping", f"{answer.damping_relative:.6g}", harmonic),
    ]
    numbers = f"σ = {answer.squeeze_number:.4g}, ε = {answer.excursion_ratio:.4g}"
    show_rows(f"{answer.request.shape}, {numbers}", rows)
    say(answer.status)
