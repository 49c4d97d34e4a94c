"""A good value for every argument of the public calls: by its name, by its unit, or by its type.

Where one value will not do for a call, `FOR_ONE_CALL` says which does.
"""

from __future__ import annotations

import inspect
import typing
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from squeezefilm.actuators.motor.description import Motor
from squeezefilm.actuators.motor.force_law import ForceLaw
from squeezefilm.core.quantities import unit_of
from squeezefilm.measure.fits.vibration.solved_shapes import DrivenShape
from squeezefilm.physics.contact.sharing.pad import PadPoints
from squeezefilm.physics.film.planar.grid import PlanarGap
from squeezefilm.physics.plate.parts import Sector
from squeezefilm.physics.plate.solid.modes import PlateModes
from squeezefilm.physics.plate.sound import RadiatingSurface
from squeezefilm.physics.render.program.lowering import Program
from squeezefilm.physics.render.texture.composition import Texture
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction

from .made_objects import (
    MADE,
    PLATE,
    PZT,
    SINE,
    WAYS,
    disc_section,
    falling_friction,
    falling_over_speeds,
    fields_of,
    hjif_document,
    made,
)
from .public_calls import PublicCall, public_calls

_BY_UNIT = {
    "m": 1e-3, "m2": 1e-4, "s": 1e-3, "Hz": 30e3, "1": 0.5, "rad": 0.3, "N": 0.5, "N/m": 1e3,
    "N/V": 0.1, "N*s/m": 1.0, "N*m": 50.0, "Pa": 1e4, "Pa*s": 1.81e-5, "kg": 1e-3, "kg/m3": 1.2,
    "kg/m2": 10.0, "V": 10.0, "m/V": 1e-7, "F": 1e-9, "ohm": 100.0, "m/s": 0.1, "1/m": 100.0,
    "C/m2": -5.0, "m2/N": 1e-11, "Pa/m": 1e9, "Pa*s/m": 1e3, "m2/s3": 0.05, "m2/s5": 40.0,
    "W": 1.0, "K": 10.0, "K/W": 10.0, "1/K": 1e-4, "s/m": 1e-3, "V/m": 1e4, "J/kg/K": 400.0,
    "m/s2": 2.0, "A": 0.1, "V*s/A": 0.03, "m/N": 1e-3, "m3": 1e-6, "F/m": 1e-8,
}  # fmt: skip

_BY_NAME: dict[str, Any] = {
    "people": 15,
    "amplitude": 1e-6, "free_amplitude": 1e-6, "low": 0.0, "high": 1e-6, "roughness": 1e-6,
    "vibration_amplitude": 1e-6, "ridge_amplitude": 50e-6, "ridge_period": 350e-6,
    "plateau_width": 250e-6, "film_thickness": 5e-6, "mean_gap": 5e-6, "gap": 2e-6,
    "decay_length": 0.6e-6, "reference_gap": 2e-6, "mean_free_path": 68e-9,
    "ambient_pressure": 101325.0, "quality_factor": 60.0, "young_modulus": 100e9,
    "modulus": 100e9, "shear_modulus": 40e9, "density": 8500.0, "half_wavelength": 8e-3,
    "wavelength": 16e-3, "contact_length": 10e-3, "length": 30e-3, "width": 10e-3,
    "highest_amplitude": 2e-6, "largest_amplitude": 2e-6, "polytropic_exponent": 1.2,
    "squeeze_number": 100.0, "amplitude_ratio": 0.2,
    "excursion_ratio": 0.2, "ridge_ratio": 0.2, "relative_permittivity": 1000.0,
    "mean_pressure": 1.2, "harmonic": 1, "nodal_lines": 4, "count": 4, "cells": 16, "steps": 32,
    "points": 33, "seed": 1, "passes": 1, "degree": 3, "order": 3, "knots": 33, "tolerance": 1e-3,
    "duration": 0.05, "rate": 1e3, "sample_rate": 192e3, "command_rate": 1e3, "control_rate": 1e3,
    "spatial_period": 2e-3, "voltage": 10.0, "surface_roughness": 1e-6, "sensor_rate": 1e3,
    "reference_speed": 0.1, "command": np.full(64, 1e-6), "wanted": np.full(64, 1e-6),
    "initial": 0.0, "start": 0.0, "end": 20e-3, "time_step": 1e-4, "time_constant": 0.5e-3,
    "relative_friction": 0.7, "X": 0.25, "speed": 0.1, "voltage_limit": 20.0, "digits": 4,
    "amplitude_per_volt": 1e-7, "name": "some", "title": "some", "text": "2 um", "path": "none",
    "display": "biet2008-plate", "insulation": "glass", "slip": "first", "samples_per_command": 192,
    "poisson_ratio": 0.3, "samples": 4, "value": 0.5, "bits": 8,
}  # fmt: skip


@dataclass(frozen=True)
class Later:
    """A good value that is made when the call is first tried."""

    make: Callable[[], Any]


_GRID = np.linspace(0.0, 1.0, 9)
_FALL = {"relative_friction": falling_friction}
_BAND = {"band": (20e3, 40e3)}
_WAVE = np.linspace(0.0, 8e-3, 8, endpoint=False)
_EDGE = np.linspace(0.0, 0.01, 9)
_DRIVEN: dict[str, Any] = {
    "x": _EDGE,
    "y": _EDGE,
    "swing": np.outer(np.cos(600 * _EDGE), np.ones(9)),
    "rest": np.zeros((9, 9)),
    "lobe": (5e-3, 5e-3),
    "lengthwise": True,
    "half_wavelength": 5e-3,
}
_SERIES = {name: np.linspace(0.0, 0.01, 5) for name in ("x", "y", "v", "t")}

FOR_ONE_CALL: dict[str, dict[str, Any]] = {
    "actuators.skin_stretch.array.SkinStretchArray.answer": {"voltages": np.full(6, 10.0)},
    "actuators.skin_stretch.bimorph.Bimorph": {"width": 2e-3, "ceramic_thickness": 0.3e-3},
    "actuators.skin_stretch.cradle.FingerCradle": {
        "columns": 3,
        "rows": 2,
        "pitch_along": 1.2e-3,
        "pitch_across": 1.8e-3,
        "contactor_length": 1e-3,
        "contactor_width": 1.6e-3,
        "length": 4e-3,
        "width": 4e-3,
        "radius_along": 20e-3,
        "radius_across": 9e-3,
    },
    "actuators.skin_stretch.cradle.pattern_voltages": {"times": np.array([0.0, 0.01])},
    "actuators.skin_stretch.bimorph.solid_bender": {"more": 0},
    "actuators.skin_stretch.tissue.influence_matrix": {
        "x": np.array([0.0, 3e-3]),
        "y": np.array([0.0, 0.0]),
        "size": (1e-3, 1.6e-3),
    },
    "actuators.skin_stretch.tissue.strain_matrices": {
        "x": np.array([0.0, 3e-3]),
        "y": np.array([0.0, 0.0]),
        "size": (1e-3, 1.6e-3),
        "cell": 0.5e-3,
    },
    "actuators.motor.assembled.Working": {"amplitude": 1e-6},
    "actuators.motor.description.FootContact.stiffnesses": {"inclination": 0.1},
    "actuators.motor.description.Foot": {"x": 0.03, "y": 0.02},
    "actuators.motor.assembled.FaceMode.at": {"place": np.linspace(0.01, 0.07, 5)},
    "actuators.motor.averaged.averaged": {"samples": 64},
    "actuators.motor.in_time.simulate": {"periods": 4, "traced": 1},
    "actuators.motor.plane.simulate_plane": {"periods": 4, "velocity": (0.01, 0.0)},
    "actuators.motor.curves.motor_map": {
        "preloads": np.array([5.0]),
        "amplitudes": np.array([1e-6]),
    },
    "actuators.motor.curves.over_foot_position": {
        "shifts": np.array([0.0]),
        "theory": "timoshenko",
    },
    "actuators.motor.closed_loop.inverted_law": {
        "speeds": np.array([0.01]),
        "amplitudes": np.array([0.2e-6, 0.5e-6]),
    },
    "actuators.motor.closed_loop.track_force": {"wanted": np.array([0.5, 0.5]), "speed": 0.01},
    "actuators.motor.description.Motor": Later(lambda: fields_of(made(Motor))),
    "actuators.motor.force_law.ForceLaw": Later(lambda: fields_of(made(ForceLaw))),
    "physics.plate.electronics.amplifier_check": {"slew_rate": 1e6, "current": 0.01},
    "physics.contact.finger.load.finger_impedance": {"stiffness_per_area": 1e10 + 1e9j},
    "physics.contact.sliding.march.SpeedFriction": {
        "speed": np.array([0.0, 0.1]),
        "coefficient": np.array([0.2, 0.5]),
    },
    "physics.contact.sharing.levitation.least_amplitude": {
        "friction": falling_friction,
        "model": "by hand",
        "highest": 5e-5,
    },
    "physics.film.planar.film.solve_planar": {
        "shape": "rectangle",
        "gap": PlanarGap(0.5),
        "squeeze_number": 10.0,
    },
    "physics.film.planar.grid.PlanarGap.__call__": {"X": _GRID, "T": _GRID},
    "physics.texture_files.hjif.friction_along": {"document": Later(hjif_document)},
    "physics.texture_files.hjif.hjif_of": {"texture": Later(lambda: made(RelativeFriction))},
    "core.formats.drawing.Layer": {"colour": 7},
    "core.formats.drawing.Drawing": {"layers": {}},
    "core.formats.drawing.Drawing.line": {"layer": "BOARD", "points": ((0.0, 0.0), (1e-3, 0.0))},
    "core.formats.drawing.Drawing.rectangle": {"layer": "BOARD"},
    "core.formats.drawing.Drawing.arc": {"layer": "BOARD"},
    "core.formats.drawing.Drawing.text": {"text": "a board"},
    "core.formats.drawing.Drawing.dimension": {
        "start": (0.0, 0.0),
        "end": (1e-3, 0.0),
        "number": (0.0, 0.0),
    },
    "design.fabrication.step_file.stl_bytes": {
        "triangles": np.zeros((2, 3, 3)),
        "title": "a board",
    },
    "physics.texture_files.image_file.ImageFile": {"file": "picture.png"},
    "core.formats.traces.Table": {"columns": {"time_s": _GRID}},
    "core.formats.traces.Waveform": {"samples": _GRID * 1e-7, "unit": "m", "full_scale": 1e-6},
    "core.materials.PiezoConstants": Later(lambda: fields_of(PZT.full_constants)),
    "core.materials.Piezoceramic": {
        "in_plane_poisson_ratio": 0.29,
        "in_plane_stiffness": 68e9,
        "charge_coefficient": -247e-12,
    },
    "physics.plate.ring.modes.bending_mode": {"diameters": 0, "circles": 1},
    "physics.plate.ring.modes.bending_frequency": {"diameters": 2, "degree": 3},
    "physics.plate.ring.modes.annular_modes": {"harmonic": 1, "degree": 3, "count": 1},
    "physics.plate.ring.modes.annular_admittance": {"harmonics": (0,), "degree": 3, "modes": 2},
    "physics.plate.ring.ceramic_disc.CeramicDisc": {"diameter": 20e-3},
    "physics.plate.ring.ceramic_disc.disc_admittance": {
        "constants": np.array([120e9, 75e9, 75e9, 110e9, 21e9, -5.0, 16.0, 12.0, 8e-9, 7e-9]) + 0j,
        "frequency": np.array([60e3, 70e3]),
    },
    "design.plate.ring_pair.crest_speed": {"travelling": 1e-6},
    "physics.plate.solid.resonances.screened_modes": {"band": (30e3, 60e3)},
    "physics.plate.parts.Sector": {"inner_radius": 1e-3, "outer_radius": 2e-3},
    "physics.plate.parts.Part": {
        "kind": "glue",
        "number": 1,
        "material": "epoxy",
        "footprint": Sector(0.0, 1e-3),
        "bottom": 0.0,
        "top": 1e-3,
    },
    "physics.plate.ring.section.RingLayer": {
        "inner_radius": 1e-3,
        "outer_radius": 10e-3,
        "bottom": 0.0,
        "top": 1e-3,
    },
    "physics.plate.ring.section.AnnularSection": {"layers": Later(lambda: disc_section().layers)},
    "physics.plate.ring.section.SectorDrive": {"sectors": ((0.0, 1.0, 1),)},
    "physics.plate.beam_modes.BeamMode.deflection_at": {"x": WAYS},
    "physics.plate.beam_modes.BeamMode.rotation_at": {"x": WAYS},
    "physics.plate.laminate.Laminate.moment_arm": {"layer": 0},
    "physics.plate.layout.RectangularPlate": {
        "width": 10e-3,
        "thickness": 2e-3,
        "patches": PLATE.patches,
    },
    "plate.layout.AnnularStator": {
        "mean_diameter": 53.6e-3,
        "radial_width": 12e-3,
        "wavelength": 18.7e-3,
    },
    "plate.layout.DiscPlate": {
        "diameter": 25e-3,
        "ceramic_outer_diameter": 15e-3,
        "ceramic_thickness": 0.5e-3,
    },
    "physics.plate.loaded_mode.LoadedMode": {"load_ratio": 0.01 + 0.01j},
    "physics.plate.loaded_mode.loaded_mode": {"stiffness_per_area": 1e6 + 1e5j},
    "physics.plate.solid.modes.check_band": _BAND,
    "physics.plate.solid.reduced.resolved_frequency": _BAND,
    "physics.plate.solid.mesh.wave_number": {"frequency": 30e3},
    "physics.plate.solid.mesh.plate_model": {"frequency": 30e3},
    "physics.plate.solid.modes.PlateModes.index": {
        "label": Later(lambda: made(PlateModes).labels[0])
    },
    "physics.plate.solid.modes.PlateModes.field": {"mode": 0, "x": WAYS, "y": WAYS},
    "physics.plate.solid.modes.PlateModes.nodal_positions": {"mode": 0},
    "physics.plate.solid.modes.PlateModes.half_wavelength": {"mode": 0},
    "physics.plate.solid.response.HarmonicResponse.largest": {"at": 0},
    "physics.plate.solid.resonances.label_name": {"label": (4, 0)},
    "physics.plate.solid.response.harmonic_response": {"frequencies": np.array([30e3, 31e3])},
    "physics.plate.beam_response.BeamResponse.amplitude_at": {"position": 10e-3},
    "physics.plate.beam_response.BeamResponse.transfer": {
        "frequency": np.array([30e3]),
        "position": WAYS,
    },
    "physics.plate.ring.body.ring_response": {
        "frequencies": np.array([30e3]),
        "harmonics": (0,),
    },
    "physics.plate.sound.smooth_surface": {
        "sides": (0.02, 0.01),
        "velocity": lambda x, y: np.ones((x.size, y.size)) + 0j,
        "wave": 0.01,
    },
    "physics.plate.sound.ring_surface": {
        "radius": np.linspace(0, 0.02, 9),
        "velocity": np.ones(9) + 0j,
    },
    "physics.plate.sound.RadiatingSurface": Later(lambda: fields_of(made(RadiatingSurface))),
    "physics.plate.solid.response.HarmonicResponse.motion": {"at": 0},
    "actuators.skin_stretch.array.held_forces": {
        "compliance": np.eye(3) * 1e-3,
        "wanted": np.array([1e-4, 1e-3, 0.0]),
        "held": np.array([0.5, 0.5, 0.0]),
    },
    "measure.fits.ceramic.constants.compliances": {"p": np.linspace(-1.0, 1.0, 14)},
    "measure.fits.circuit.branches.poles": {
        "frequency": np.linspace(29e3, 31e3, 41),
        "response": 1 / (30e3 - np.linspace(29e3, 31e3, 41) + 200j),
        "count": 1,
    },
    "measure.fits.vibration.solved_shapes.DrivenShape": _DRIVEN,
    "measure.fits.vibration.solved_shapes.DrivenShape.along": {
        "self": Later(lambda: DrivenShape(**_DRIVEN)),
        "position": WAYS,
    },
    "measure.fits.vibration.solved_shapes.DrivenShape.at": {
        "self": Later(lambda: DrivenShape(**_DRIVEN)),
        "x": WAYS,
        "y": WAYS,
    },
    "measure.fits.vibration.solved_shapes.line_by_shape": {
        "shape": Later(lambda: DrivenShape(**_DRIVEN)),
        "x": np.linspace(1e-3, 9e-3, 20),
        "w": 1e-6 * np.cos(600 * np.linspace(1e-3, 9e-3, 20)),
        "reach": 1e-4,
    },
    "measure.recordings.kinds.ImpedanceSweep": {"admittance": np.ones(5) + 1j},
    "measure.recordings.kinds.FrequencyResponse": {"displacement_per_volt": np.ones(5) + 1j},
    "measure.recordings.kinds.FrictionCurve": {"friction": np.full(5, 0.5)},
    "measure.recordings.kinds.LineScan": {"displacement": np.ones(5) + 1j},
    "measure.recordings.kinds.GridScan": {
        "x": WAYS,
        "y": WAYS,
        "displacement": np.ones(9) + 1j,
    },
    "design.sweep.sweep.SweepRequest": {"display": "biet2008-plate"},
    "physics.chain.pad_place.pad_place": {"place": (5e-3, 5e-3)},
    "physics.chain.pad_place.place_words": {"place": (5e-3, 5e-3)},
    "physics.chain.pad_place.met_by_pads": {"points": PadPoints(*[WAYS] * 5)},
    "physics.plate.sound.sound_pressure": {"points": np.array([[0.0, 0.0, 0.3]])},
    "physics.plate.sound.pressure_level": {"pressure": np.array([1.0 + 1j])},
    "physics.plate.solid.solve.ModesRequest": {"count": 1, "near": 60e3},
    "physics.plate.solid.forecast.solve_size": {"label": (4, 0), "frequency": 60e3},
    "physics.plate.solid.forecast.band_seconds": {"highest": 60e3},
    "physics.plate.ring.body.stator_section": {"mean_diameter": 53.6e-3, "ring_thickness": 3e-3},
    "physics.chain.prediction.predict": {
        "theory": "timoshenko",
        "model": "paper2008",
        "place": None,
    },
    "physics.chain.wanted_voltage.voltage_for_friction": {
        "theory": "timoshenko",
        "model": "paper2008",
        "place": None,
    },
    "physics.render.texture.composition.Sequence": {
        "textures": Later(lambda: (made(RelativeFriction),) * 2),
        "edges": (1e-3,),
    },
    "physics.render.texture.composition.Sum": {
        "textures": Later(lambda: (made(RelativeFriction),) * 2)
    },
    "physics.render.texture.composition.Composable.then": {
        "other": Later(lambda: made(RelativeFriction))
    },
    "physics.render.texture.pattern.require_fade": {"value": 1e-4, "at_most": 1e-3},
    "core.calibration_record.CalibratedAnswer": {"said": "mass", "draws": (0.02, 0.021)},
    "core.calibration_record.ComparedAnswer": {
        "said": "mass",
        "measured": "0.1 kg",
        "error": 0.01,
        "before": (0.9, 1.0, 1.1),
        "after": (0.99, 1.0, 1.01),
        "relative_friction": 0.5,
        "vibration_amplitude": 1e-6,
    },
    "core.calibration_record.JointSpread": {"paths": ("a",), "draws": ((0.2,), (0.5,), (0.9,))},
    "core.calibration_record.JointSpread.picked": {"paths": ("a",), "points": np.full((3, 1), 0.5)},
    "core.calibration_record.JointSpread.moved": {"paths": ("a",), "points": np.full((3, 1), 0.5)},
    "physics.render.motion.stroke.FingerPath": {"time": _GRID, "x": WAYS, "y": WAYS},
    "physics.render.program.inverse.FrictionInverse.from_function": _FALL,
    "physics.render.program.inverse.FrictionTable": {
        "amplitude": 1e-6 * np.arange(4),
        "speed": np.array([0.01, 0.1, 1.0]),
        "relative_friction": falling_over_speeds(1e-6 * np.arange(4), np.array([0.01, 0.1, 1.0])),
        "nominal_speed": 0.1,
    },
    "physics.render.program.inverse.FrictionTable.inverse": {
        "law": falling_over_speeds,
        "largest_amplitude": 2e-6,
    },
    "physics.render.program.renderer.MadeForSpeed.of": {"law": falling_friction},
    "physics.render.texture.levels.Amplitude.constant": {"value": 1e-6},
    "physics.render.texture.levels.RelativeFriction": {"low": 0.4, "high": 0.8},
    "physics.render.texture.levels.FrictionReduction": {"low": 0.4, "high": 0.8},
    "physics.render.texture.shapes.SpeedGate": {"above": 0.05, "below": 0.2},
    "physics.render.texture.shapes.Periodic": {"frequency": 50.0},
    "physics.render.texture.image.Image": {"values": ((0.0, 1.0), (1.0, 0.0))},
    "physics.render.texture.image.Image.from_array": {"values": np.full((4, 4), 0.5)},
    "physics.render.opcodes.mixed": {"value": 5},
    "physics.render.program.lowering.Program": {"array": Later(lambda: made(Program).array)},
    "physics.render.program.lowering.checked": {"array": Later(lambda: made(Program).array)},
    "physics.render.program.lowering.lower": {
        "texture": Later(lambda: Amplitude(SINE, 0.0, 1e-6)),
        "largest_amplitude": 2e-6,
    },
    "physics.render.fidelity.rendered_stroke.rendered_stroke": {
        **_FALL,
        "texture": Later(lambda: made(Texture)),
    },
    "physics.render.program.renderer.render": _SERIES,
    "physics.render.program.renderer.evaluate": _SERIES,
    "physics.render.program.renderer.Renderer.tick": {"t": 0.001},
    "physics.render.motion.estimator.SensorModel": {"rate": 1e3, "noise": 1e-6},
    "physics.render.motion.estimator.sensor_stream": {"position": np.cos, "duration": 0.02},
    "physics.render.program.inverse.WaveCompensation": {"factors": (1.0, 1.0, 1.0, 1.0)},
    "physics.render.program.inverse.WaveCompensation.from_ripple": {
        "position": _WAVE,
        "relative_friction": np.full(8, 0.7),
    },
}
"""What a call needs besides, or in place of, what its arguments' names say."""


def _choices(hint: Any) -> tuple[Any, ...]:
    if typing.get_origin(hint) is Literal:
        return typing.get_args(hint)
    return ()


def good_value(name: str, hint: Any) -> Callable[[], Any]:
    """What makes a good value of an argument; raises LookupError where nothing is known to."""
    if typing.get_origin(hint) is typing.Annotated and unit_of(hint) is None:
        hint = hint.__origin__  # a count or a plain number with bounds
    if name in _BY_NAME and (unit_of(hint) or hint in (int, float, str)):
        value = _BY_NAME[name]
    elif (unit := unit_of(hint)) is not None:
        value = _BY_UNIT[unit.symbol]
    elif hint is float:
        value = 1.0
    else:
        kind = next(
            (p for p in (hint, *typing.get_args(hint)) if inspect.isclass(p) and p in MADE), None
        )
        if kind is not None:
            return lambda: made(kind)
        if choices := _choices(hint):
            return lambda: choices[0]
        raise LookupError(name)
    if unit_of(hint) is not None and "ndarray" in str(hint) and "float |" not in str(hint):
        return lambda: np.full(5, value) if np.ndim(value) == 0 else value
    return lambda: value


def wanted_values(call: PublicCall, given: Collection[str]) -> dict[str, Callable[[], Any]]:
    """What makes the arguments that a call needs beside those given by name."""
    return {
        name: good_value(name, call.hints[name])
        for name, parameter in inspect.signature(call.function).parameters.items()
        if name not in given
        and name != "self"
        and parameter.default is inspect.Parameter.empty
        and parameter.kind not in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD)
    }


def good_arguments(call: PublicCall) -> dict[str, Any]:
    """Arguments with which a call works, the instance it needs under "self".

    Raises LookupError with the name of the argument for which there is none.
    """
    given = _now(FOR_ONE_CALL.get(call.name, {}))
    given = {name: _now(value) for name, value in given.items()}
    arguments: dict[str, Any] = {}
    if call.owner is not None and "self" not in given:
        kind = call.owner if call.owner in MADE else None
        if kind is None:
            own = constructor_of(call.owner)
            arguments["self"] = own.function(**good_arguments(own))
        else:
            arguments["self"] = made(kind)
    arguments |= {name: make() for name, make in wanted_values(call, given).items()}
    return {**arguments, **given}


def _now(value: Any) -> Any:
    return value.make() if isinstance(value, Later) else value


def constructor_of(owner: type[Any]) -> PublicCall:
    return public_calls()[f"{owner.__module__}.{owner.__qualname__}".removeprefix("squeezefilm.")]


def invoke(call: PublicCall, arguments: dict[str, Any]) -> Any:
    """Call it, arguments that stand before a slash by position."""
    rest = dict(arguments)
    positional = [rest.pop("self")] if "self" in rest else []
    for name, parameter in inspect.signature(call.function).parameters.items():
        if parameter.kind is parameter.POSITIONAL_ONLY and name in rest:
            positional.append(rest.pop(name))
    return call.function(*positional, **rest)
