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
    "display_names": "core.presets",
    "study_names": "core.presets",
    "texture_names": "core.presets",
    "materials": "core.presets.materials",
    "load_display": "physics.display",
    "save_display": "physics.display",
    "load_texture": "physics.texture_files.texture_file",
    "save_texture": "physics.texture_files.texture_file",
    "replaced": "physics.uncertainty.parameters",
    "with_finger": "measure.fits.friction.friction_scores",
    # What a display does
    "predict": "physics.chain.prediction",
    "predict_grid": "physics.chain.prediction_grid",
    "voltage_for_friction": "physics.chain.wanted_voltage",
    "analyze": "design.analysis.analyze",
    "analyze_friction": "design.friction",
    "list_modes": "design.plate.modes",
    "solve_plate": "design.plate.command",
    "solve_film": "design.film",
    "sweep": "design.sweep.sweep",
    "search_designs": "design.search.run",
    # Textures, composed
    "Amplitude": "physics.render.texture.levels",
    "RelativeFriction": "physics.render.texture.levels",
    "Band": "physics.render.texture.shapes",
    "Bump": "physics.render.texture.shapes",
    "SineWave": "physics.render.texture.shapes",
    "SquareWave": "physics.render.texture.shapes",
    "Noise": "physics.render.texture.image",
    "Image": "physics.render.texture.image",
    "speed": "physics.render.texture.shapes",
    "Stroke": "physics.render.motion.stroke",
    # Rendered, played, recorded
    "render_texture": "physics.chain.rendered_texture",
    "play_texture": "instruments.bench.play",
    "play": "study.conduct.playback",
    "read_trace": "instruments.session.record.trace",
    # Measured
    "read_recording": "measure.recordings.read",
    "check_recording": "measure.recordings.read",
    "fit_recording": "measure.fits.by_kind",
    "calibrate_display": "measure.calibration.folder",
    "predict_measurement": "measure.calibration.blind",
    "score_prediction": "measure.calibration.folder",
    # Built
    "fabricate": "design.fabrication.fabricate",
    # Studies
    "plan_study": "study.design.plan",
    "run_study": "study.report.terminal",
    "simulate_participants": "study.simulated.answers",
    "analyze_study": "study.tasks.analyze",
    "AdaptiveDesign": "study.adaptive.bayesian",
    "BayesianAdaptive": "study.adaptive.bayesian",
    "fit_psychometric": "study.psychometric.fit",
    "PsychometricFunction": "study.psychometric.function",
    "PsychometricPrior": "study.psychometric.function",
    # What came out
    "plot": "subjects",
    "write_mode": "subjects",
    "write_report": "subjects",
    # What it raises on purpose
    "SqueezefilmError": "core.errors",
}

__all__ = sorted(_NAMES)


def __getattr__(name: str) -> object:
    if name not in _NAMES:
        from difflib import get_close_matches

        near = get_close_matches(name, __all__, n=1, cutoff=0.5)
        meant = f" Did you mean '{near[0]}'?" if near else ""
        raise AttributeError(
            f"squeezefilm has no '{name}'.{meant} It has: {', '.join(__all__)}", name=name, obj=None
        )
    from importlib import import_module

    value = globals()[name] = getattr(import_module(f"squeezefilm.{_NAMES[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
