"""Figures and reports by the type of a result.

`plot` and `write_report` are the front door's; each draws and writes by what the folders beside
this file have.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.core.kit.sheet import sheet_figure
from squeezefilm.design.analysis.analysis import Analysis
from squeezefilm.design.analysis.report.figures import FIGURES
from squeezefilm.design.analysis.report.page import write_analysis
from squeezefilm.design.fabrication.fabricate import Fabrication
from squeezefilm.design.fabrication.report.page import drawing_sheet, write_fabrication
from squeezefilm.design.film import FilmAnswer, FilmMap
from squeezefilm.design.friction import FrictionAnalysis
from squeezefilm.design.plate.command import PlateAnalysis
from squeezefilm.design.plate.report import page as plate_page
from squeezefilm.design.plate.report.figures import PLATE_FIGURES, RING_FIGURES
from squeezefilm.design.plate.ring import RingAnalysis
from squeezefilm.design.report import film
from squeezefilm.design.report import friction as friction
from squeezefilm.design.report import texture_figures as textures
from squeezefilm.design.report.texture_page import write_render
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.report.figures import FIGURES as FIGURES_OF_DESIGN
from squeezefilm.design.search.report.page import write_design
from squeezefilm.design.sweep.report.figures import sweep_figure
from squeezefilm.design.sweep.report.page import write_sweep
from squeezefilm.design.sweep.swept import Sweep
from squeezefilm.instruments.bench.play import PlayResult
from squeezefilm.instruments.bench.played_session import PlayedSession
from squeezefilm.instruments.report import page as played
from squeezefilm.instruments.report.page import write_play
from squeezefilm.measure.calibration.folder import FolderCalibration
from squeezefilm.measure.report.calibration_page import FIGURES as CALIBRATION_FIGURES
from squeezefilm.measure.report.calibration_page import write_calibration
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.chain.rendered_texture import RenderAnalysis
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.texture_files.texture_file import TextureFile
from squeezefilm.study.identification.analysis import IdentificationAnalysis
from squeezefilm.study.psychometric.fit import PsychometricFit
from squeezefilm.study.report import figures
from squeezefilm.study.report.page import FIGURES as FIGURES_OF_STUDY
from squeezefilm.study.report.page import TASK_FIGURES, write_simulated, write_study
from squeezefilm.study.simulated.answers import SimulatedStudy
from squeezefilm.study.simulated.planned_power import PlannedPower
from squeezefilm.study.simulated.planned_precision import PlannedPrecision
from squeezefilm.study.tasks.findings import TaskAnalysis

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_Draw = Callable[[Any], "Figure"]


@dataclass(frozen=True)
class _Subject:
    """A type of result: its figures by name, the first one shown unless another is asked
    for, and what writes its report into a folder."""

    figures: Mapping[str, _Draw]
    write: Callable[..., Path] | None = None


def _by_key(figures: Iterable[FigureOf]) -> dict[str, _Draw]:
    return {figure.key: figure.draw for figure in figures}


def _of_session(draw: _Draw) -> _Draw:
    return lambda result: draw(result.session)


def _of_first_display(study: SimulatedStudy) -> Figure:
    """The first figure of the first display's analysis. Raises `InputError` where there is none."""
    for analysis in study.analyses.values():
        return plot(analysis)
    raise InputError("nothing is right or wrong in these answers, and there is no figure of them")


_ANALYSIS, _PLAYED = _by_key(FIGURES), _by_key(played.FIGURES)

SUBJECTS: Mapping[type, _Subject] = {
    Prediction: _Subject({"friction": lambda prediction: friction.predictions([prediction])}),
    Analysis: _Subject(_ANALYSIS, write_analysis),
    FrictionAnalysis: _Subject(_by_key(friction.FIGURES), friction.write_friction),
    FilmAnswer: _Subject({"pressure": film.film_pressure}),
    FilmMap: _Subject({"map": film.film_map}, film.write_film_map),
    PlateAnalysis: _Subject(_by_key(PLATE_FIGURES), plate_page.write_plate),
    RingAnalysis: _Subject(_by_key(RING_FIGURES), plate_page.write_plate),
    Sweep: _Subject({"sweep": sweep_figure}, write_sweep),
    DesignSearch: _Subject(_by_key(FIGURES_OF_DESIGN), write_design),
    TextureFile: _Subject({"texture": textures.picture}),
    Composable: _Subject({"texture": lambda texture: textures.picture(TextureFile.of(texture))}),
    RenderAnalysis: _Subject(_by_key(textures.FIGURES), write_render),
    PlayedSession: _Subject(_PLAYED),
    PlayResult: _Subject({key: _of_session(draw) for key, draw in _PLAYED.items()}, write_play),
    Fabrication: _Subject(
        {"drawing": lambda made: sheet_figure(drawing_sheet(made))}, write_fabrication
    ),
    FolderCalibration: _Subject(_by_key(CALIBRATION_FIGURES), write_calibration),
    IdentificationAnalysis: _Subject(_by_key(FIGURES_OF_STUDY), write_study),
    TaskAnalysis: _Subject(_by_key(TASK_FIGURES), write_study),
    SimulatedStudy: _Subject({"answers": _of_first_display}, write_simulated),
    PlannedPower: _Subject({"power": lambda planned: figures.power(planned.curve)}),
    PlannedPrecision: _Subject({"precision": figures.precision}),
    PsychometricFit: _Subject({"function": figures.psychometric_function}),
}
"""Figures and report of every type of result."""


def plot(result: Any, figure: str | None = None) -> Figure:
    """A matplotlib figure of a result, or of a list of predictions: a sweep.

    `figure` names another than the one shown without it; a wrong name is answered with those there
    are. Show it in a notebook, or `savefig` it.

    Raises `InputError` for what has no figure, or not this one.
    """
    if isinstance(result, Sequence) and result and isinstance(result[0], Prediction):
        drawn = friction.predictions(result)
    else:
        figures = _subject(result, "figure").figures
        name = next(iter(figures)) if figure is None else figure
        if name not in figures:
            raise InputError(
                f"a {type(result).__name__} has no figure "
                f"'{name}'.{si.did_you_mean(name, figures)} It has: {', '.join(figures)}"
            )
        drawn = figures[name](result)
    # Reports put figures on a ground of their own; alone, a figure brings one.
    drawn.set_facecolor("white")
    return drawn


def write_report(result: Any, folder: str | Path, **options: Any) -> Path:
    """Write the numbers and figures of a result, for most also a page, into a folder.

    `options` go to the writer of its type (for a rendering `drive=True`, `hjif=True`,
    `table="parquet"`). A study's analyses by display get a folder each. Returns the path of the
    page, or the folder where there is none.

    Raises `InputError` for what has no report, and where nothing can be written.
    """
    folder = Path(folder)
    if isinstance(result, Mapping):
        for name, one in result.items():
            write_report(one, folder / str(name), **options)
        return folder
    write = _subject(result, "report").write
    if write is None:
        raise InputError(
            f"a {type(result).__name__} has no report; take plot(result), or to_dict() and "
            "to_pandas() for its numbers"
        )
    return write(result, folder, **options)


def write_mode(result: PlateAnalysis | RingAnalysis, file: str | Path) -> Path:
    """Write a plate's working mode and its response at the display's voltage as .vtu, for ParaView.

    Raises `InputError` for a disc or stator, which is solved by Fourier harmonics and has no
    volume.
    """
    if not isinstance(result, PlateAnalysis):
        raise InputError(
            f"'{result.display.name}' is no rectangular plate: it was solved by Fourier harmonics, "
            "and there is no volume to write"
        )
    return plate_page.write_mode(result, Path(file))


def _subject(result: Any, wanted: str) -> _Subject:
    for kind in type(result).__mro__:
        if kind in SUBJECTS:
            return SUBJECTS[kind]
    raise InputError(
        f"a {type(result).__name__} has no {wanted}; these have: "
        f"{', '.join(kind.__name__ for kind in SUBJECTS)}"
    )
