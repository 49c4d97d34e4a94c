"""squeezefilm: tactile displays that change the friction of a surface by ultrasonic vibration.

    import squeezefilm as sf

    sf.predict("biet2008-plate", voltage="15 V").relative_friction

The names below are all that most work needs; each is imported when it is first asked for, so that
importing the package costs next to nothing. Quantities may be written as text with a unit, and a
display, a texture or a study by its name. See ``docs/how-to/front-door.md``.
"""

__version__ = "0.2.0.dev0"

# Where each name lives. The stub beside this file says the same to type checkers; a test compares.
_NAMES = {
    # Displays, textures and studies by name
    "display_names": "presets",
    "study_names": "presets",
    "texture_names": "presets",
    "load_display": "display",
    "load_texture": "texture_file",
    "save_texture": "texture_file",
    "replaced": "analysis.parameters",
    "with_finger": "measure.fits.friction.person",
    # What a display does
    "predict": "chain.prediction",
    "voltage_for_friction": "chain.wanted_voltage",
    "analyze": "analysis.analyze",
    "analyze_friction": "analysis.friction.command",
    "solve_plate": "analysis.plate.command",
    "solve_film": "analysis.film.command",
    "sweep": "search.sweep",
    "search_designs": "search.design.run",
    # Textures, composed
    "Amplitude": "render.texture.levels",
    "RelativeFriction": "render.texture.levels",
    "Band": "render.texture.shapes",
    "Bump": "render.texture.shapes",
    "SineWave": "render.texture.shapes",
    "SquareWave": "render.texture.shapes",
    "Noise": "render.texture.noise",
    "Image": "render.texture.image",
    "speed": "render.texture.gates",
    "Stroke": "render.motion.stroke",
    # Rendered, played, recorded
    "render_texture": "chain.rendered_texture",
    "play_texture": "bench.play",
    "play": "study.conduct.playback",
    "read_trace": "session.record.trace",
    # Measured
    "read_recording": "measure.recordings.read",
    "check_recording": "measure.recordings.read",
    "fit_recording": "measure.fits.by_kind",
    "calibrate_display": "measure.calibration.folder",
    "predict_measurement": "measure.calibration.questions",
    "score_prediction": "measure.calibration.folder",
    # Built
    "fabricate": "measure.planned.fabricate",
    # Studies
    "plan_study": "study.design.plan",
    "run_study": "report.study.session",
    "simulate_participants": "study.simulated.answers",
    "analyze_study": "study.tasks.analyze",
    "AdaptiveDesign": "study.adaptive.bayesian",
    "BayesianAdaptive": "study.adaptive.bayesian",
    "fit_psychometric": "study.psychometric.fit",
    "PsychometricFunction": "study.psychometric.function",
    "PsychometricPrior": "study.psychometric.prior",
    # What came out
    "plot": "report.subjects",
    "write_mode": "report.subjects",
    "write_report": "report.subjects",
    # What it raises on purpose
    "SqueezefilmError": "errors",
}

__all__ = sorted(_NAMES)


def __getattr__(name: str) -> object:
    if name not in _NAMES:
        raise AttributeError(
            f"squeezefilm has no '{name}'; it has: {', '.join(__all__)}", name=name, obj=None
        )
    from importlib import import_module

    value = globals()[name] = getattr(import_module(f"squeezefilm.{_NAMES[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
