"""The front door for type checkers: the same names as `__init__` loads when they are asked for."""

from typing import TYPE_CHECKING

# Every module depends on this one: so marked, a checker reads it last and meets no circle.
if TYPE_CHECKING:
    from squeezefilm.analysis.analyze import analyze as analyze
    from squeezefilm.analysis.film.command import solve_film as solve_film
    from squeezefilm.analysis.friction.command import analyze_friction as analyze_friction
    from squeezefilm.analysis.parameters import replaced as replaced
    from squeezefilm.analysis.plate.solve import solve_plate as solve_plate
    from squeezefilm.bench.play import play_texture as play_texture
    from squeezefilm.chain.prediction import predict as predict
    from squeezefilm.chain.prediction import voltage_for_friction as voltage_for_friction
    from squeezefilm.chain.rendered_texture import render_texture as render_texture
    from squeezefilm.display import load_display as load_display
    from squeezefilm.errors import SqueezefilmError as SqueezefilmError
    from squeezefilm.presets import display_names as display_names
    from squeezefilm.presets import study_names as study_names
    from squeezefilm.presets import texture_names as texture_names
    from squeezefilm.render.motion.stroke import Stroke as Stroke
    from squeezefilm.render.texture.gates import speed as speed
    from squeezefilm.render.texture.image import Image as Image
    from squeezefilm.render.texture.levels import Amplitude as Amplitude
    from squeezefilm.render.texture.levels import RelativeFriction as RelativeFriction
    from squeezefilm.render.texture.noise import Noise as Noise
    from squeezefilm.render.texture.shapes import Band as Band
    from squeezefilm.render.texture.shapes import Bump as Bump
    from squeezefilm.render.texture.shapes import SineWave as SineWave
    from squeezefilm.render.texture.shapes import SquareWave as SquareWave
    from squeezefilm.report.study.session import run_study as run_study
    from squeezefilm.report.subjects import plot as plot
    from squeezefilm.report.subjects import write_mode as write_mode
    from squeezefilm.report.subjects import write_report as write_report
    from squeezefilm.session.record.trace import read_trace as read_trace
    from squeezefilm.study.adaptive.bayesian import AdaptiveDesign as AdaptiveDesign
    from squeezefilm.study.adaptive.bayesian import BayesianAdaptive as BayesianAdaptive
    from squeezefilm.study.design.plan import plan_study as plan_study
    from squeezefilm.study.design.study_design import load_design as load_design
    from squeezefilm.study.identification.recorded import analyze_study as analyze_study
    from squeezefilm.study.psychometric.fit import fit_psychometric as fit_psychometric
    from squeezefilm.study.psychometric.function import PsychometricFunction as PsychometricFunction
    from squeezefilm.study.psychometric.prior import PsychometricPrior as PsychometricPrior
    from squeezefilm.study.simulated.participants import (
        simulate_participants as simulate_participants,
    )
    from squeezefilm.texture_file import load_texture as load_texture
    from squeezefilm.texture_file import save_texture as save_texture

__version__: str
