"""Every public call of the physics and rendering rooms that takes numbers, by its annotations.

`public_calls` walks the rooms; `good_arguments` makes a call of each that works.
"""

from __future__ import annotations

import collections.abc
import functools
import importlib
import inspect
import pkgutil
import sys
import typing
from collections import ChainMap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import squeezefilm
from squeezefilm.core.quantities import unit_of

ROOMS = {
    "physics.film",
    "physics.plate",
    "physics.contact",
    "physics.render",
    "physics.chain.friction",
    "physics.chain.prediction",
    "physics.chain.touch",
    "physics.chain.pad_place",
    "actuators.skin_stretch",
    "actuators.motor",
    "core.materials",
    "physics.texture_files",
    "core.quantities",
    "core.distributions",
    "core.formats",
    "core.calibration_record",
    "measure.recordings.kinds",
    "measure.fits.circuit.branches",
    "design.sweep.sweep",
    "measure.fits.ceramic.constants.compliances",
    "measure.fits.vibration.solved_shapes.DrivenShape",
    "measure.fits.vibration.solved_shapes.line_by_shape",
}
_REAL_ARRAY = np.ndarray[tuple[Any, ...], np.dtype[np.float64]]
_NUMBERS = (int, float, _REAL_ARRAY)


_ROOMS = tuple(f"{room}." for room in ROOMS)

NOT_CALLED = {
    "a record of what was computed, which only the package makes": """
    actuators.motor.averaged.AveragedMotor actuators.motor.in_time.MotorMotion
    actuators.motor.in_time.Motion actuators.motor.plane.PlaneMotion
    actuators.motor.curves.MotorMap
    actuators.motor.closed_loop.TrackedForce
    actuators.motor.assembled.FaceMode
    physics.plate.electronics.AmplifierPart
    physics.plate.electronics.ElectricalLoad physics.plate.electronics.RingAdmittance
    physics.film.periodic.solution.FilmQuestion physics.film.periodic.solution.Found
    physics.contact.sharing.pad.PadFriction
    physics.contact.sharing.balance.LoadSharing
    physics.contact.sliding.march.Sliding
    physics.film.periodic.batch.FilmBatch physics.film.periodic.solution.FilmSolution
    physics.film.periodic.solution.SolvedFilm
    physics.film.planar.film.FilmPlanar
    physics.film.validity.FilmValidity physics.film.validity.ValidityCheck
    physics.texture_files.hjif.HjifExport physics.plate.ring.modes.AnnularMode
    physics.plate.solid.resonances.DrivenMode
    physics.plate.beam_modes.BeamMode physics.plate.solid.modes.PlateModes
    physics.plate.solid.response.HarmonicResponse physics.plate.thermal.ThermalBody
    physics.plate.warming.Warming physics.plate.heat_states.WarmState
    physics.plate.solid.volume.PlateVolume
    physics.plate.ring.body.RingBody physics.plate.ring.body.RingResponse
    physics.plate.solid.working.SolidMode physics.plate.sound.ExposureGuidance
    physics.plate.sound.SoundField physics.plate.working_mode.ModeLine
    physics.plate.working_mode.WorkingMode physics.plate.surface_shape.BeamSurface
    physics.plate.surface_shape.DiscSurface physics.plate.surface_shape.SolvedSurface
    physics.plate.surface_shape.SurfaceShape physics.plate.surface_shape.TrackSurface
    physics.plate.ring.body.StatorFit physics.chain.prediction.Prediction
    physics.render.fidelity.report.FidelityReport physics.render.motion.estimator.MotionCounts
    physics.render.motion.estimator.MotionEstimate
    physics.render.fidelity.rendered_stroke.LoopRun
    physics.render.fidelity.rendered_stroke.RenderedStroke physics.render.program.renderer.Counters
    physics.render.program.renderer.Rendered physics.chain.touch.Touch
    """,
    "inside a solver: meshes, matrices and indices, made by calls that are checked": """
    measure.fits.circuit.branches.Layout measure.fits.circuit.branches.Layout.branch
    measure.fits.circuit.branches.circuit_curve measure.fits.circuit.branches.relative_motion
    measure.fits.circuit.branches.start_at
    physics.contact.asperities.cubics physics.contact.sharing.balance.require_balanced
    physics.chain.friction.where_known
    physics.plate.solid.forecast.SolveSize.require_within
    actuators.motor.in_time.resting
    physics.plate.elements.slabs.require_countable
    physics.plate.heat_states.WarmCase.states physics.plate.heat_states.WarmCase.time_to_fall
    physics.film.periodic.batch.solve_all
    physics.film.planar.grid.edge_graded physics.film.planar.grid.edge_layer
    physics.film.planar.grid.refined_line
    physics.film.periodic.nested.load_times physics.film.periodic.nested.force_harmonics
    physics.film.periodic.nested.levels_of physics.film.periodic.nested.refine
    physics.film.periodic.nested.steadied physics.film.periodic.small.fill_small
    physics.film.periodic.small.reduced physics.film.periodic.solution.extrapolated_field
    physics.film.periodic.small.small_pressure
    physics.film.periodic.small.small_film physics.film.periodic.grids.gap_rows
    physics.film.periodic.profile.interpolant
    physics.film.periodic.small.flow_factor physics.film.periodic.small.SmallVibration
    physics.film.planar.balance.Balance physics.film.planar.balance.Balancer
    physics.film.planar.balance.Balancer.solve physics.film.planar.balance.Film
    physics.film.periodic.resolution.derivative physics.film.planar.balance.resampled
    physics.film.planar.balance.times
    physics.film.planar.grid.gap_values
    physics.film.planar.grid.PlanarGrid physics.film.planar.grid.disc_grid
    physics.film.planar.grid.ellipse_grid physics.film.planar.grid.graded_line
    physics.film.planar.grid.rectangle_grid physics.film.planar.film.Climb
    physics.film.planar.film.Extrapolated physics.film.planar.film.Ladder
    physics.film.planar.film.Ladder.grid physics.film.planar.film.climb_to
    physics.film.periodic.profile.GapProfile.grid physics.film.periodic.profile.sampled_grid
    physics.film.periodic.resolution.first_guess physics.film.periodic.resolution.refined
    physics.film.periodic.resolution.collocation_times physics.film.gas.slip_law
    physics.plate.ring.elements.HarmonicSystem physics.plate.ring.elements.HarmonicSystem.field
    physics.plate.ring.elements.RingMesh physics.plate.ring.elements.harmonic_system
    physics.plate.ring.ceramic_disc.DiscSystem physics.plate.ring.ceramic_disc.disc_system
    physics.plate.elements.elimination.PartialLDL physics.plate.elements.elimination.partial_ldl
    physics.plate.elements.elimination.MirroredElement
    physics.plate.elements.box_model.BoxModel physics.plate.elements.box_model.ModelElectrode
    physics.plate.elements.box_model.Foundation physics.plate.elements.box_model.Medium
    physics.plate.elements.box_model.Medium.gradient_matrix
    physics.plate.elements.box_model.kept_products physics.plate.elements.box_model.held_components
    physics.plate.elements.box_model.require_aspect physics.plate.elements.cross_section.slice_codes
    physics.plate.elements.elimination.LDLSteps physics.plate.ring.elements.shift_near
    physics.plate.solid.coarse_modes.CoarseModes physics.plate.solid.coarse_modes.chosen_modes
    physics.plate.solid.coarse_modes.class_fits physics.plate.solid.coarse_modes.coarse_modes
    physics.plate.solid.forecast.estimated_frequency
    physics.plate.elements.cross_section.CrossSection
    physics.plate.elements.cross_section.cross_section
    physics.plate.solid.coarse_modes.open_values
    physics.plate.solid.coarse_modes.shunted_frequencies
    physics.plate.solid.refined_modes.extrapolated_class
    physics.plate.elements.slab_modes.modes_near physics.plate.elements.slab_modes.prolonged
    physics.plate.elements.slab_modes.with_open_electrodes physics.plate.elements.lobatto.LineMesh
    physics.plate.elements.lobatto.LineMesh.interpolation
    physics.plate.elements.lobatto.LineMesh.located physics.plate.elements.lobatto.hierarchic_values
    physics.plate.elements.lobatto.lagrange_basis physics.plate.elements.lobatto.line_matrices
    physics.plate.elements.lobatto.lobatto_nodes physics.plate.solid.solve.collected_modes
    physics.plate.solid.solve.energy_shares_of physics.plate.elements.lobatto.gauss_points
    physics.plate.ring.elements.graded_edges physics.plate.elements.lobatto.lagrange
    physics.plate.ring.elements.nearest_modes physics.plate.ring.elements.entries
    physics.plate.ring.elements.gathered physics.plate.ring.elements.shifted_inverse
    physics.plate.ring.elements.node_coordinates physics.plate.solid.symmetry.PlateModel
    physics.plate.solid.resonances.driven_modes physics.plate.solid.resonances.antinode
    physics.plate.solid.symmetry.forbidden_by physics.plate.solid.layers.Resolution
    physics.plate.elements.lobatto.apart physics.plate.solid.layers.nearest
    physics.plate.solid.layers.snapped physics.plate.solid.mesh.plate_model
    physics.plate.solid.mesh.wave_number physics.plate.solid.symmetry.PlateModel.evaluation
    physics.plate.solid.symmetry.PlateModel.field physics.plate.solid.symmetry.PlateModel.force
    physics.plate.solid.modes.label_of physics.plate.elements.nodal_lines.profiles
    physics.plate.solid.modes.surface_shapes physics.plate.elements.nodal_lines.zero_crossings
    physics.plate.solid.symmetry.mirror_map physics.plate.solid.reduced.ReducedClass
    physics.plate.solid.reduced.harmonic_solution physics.plate.elements.slab_modes.orthonormal
    physics.plate.elements.box_model.require_half_wave physics.plate.solid.reduced.reduced_class
    physics.plate.solid.reduced.resolved_frequency physics.plate.solid.reduced.reduced_model
    physics.plate.solid.reduced.surface_values
    physics.plate.solid.refined_modes.RefinedModes physics.plate.solid.refined_modes.extrapolated
    physics.plate.solid.refined_modes.refined_modes physics.plate.solid.refined_modes.with_label
    physics.plate.solid.forecast.bare_frequency physics.plate.solid.forecast.pieced_frequency
    physics.plate.elements.nodal_lines.line_counts physics.plate.elements.nodal_lines.largest_lobe
    physics.plate.beam_modes.scaled_mode physics.plate.beam_modes.wave_numbers
    physics.plate.beam_pieces.pieced_beam_mode
    physics.plate.elements.slab_modes.SlabFactor physics.plate.elements.slabs.Slabs.grid
    physics.plate.elements.slabs.Slabs.mass_times
    physics.plate.elements.slabs.Slabs.places physics.plate.elements.slabs.Slabs.stiffness_times
    physics.plate.elements.slabs.Slabs.weighted_sections physics.render.opcodes.Assembler.emit
    physics.render.opcodes.Assembler.table physics.render.texture.pattern.require_fade
    physics.render.interpret.samples_of physics.render.interpret.values_of
    physics.film.periodic.resolution.resolution_of
    """,
    "no number but the index of what its other arguments hold, or an array the package made": """
    physics.contact.sharing.gas_table.FilmTable.build
    physics.contact.sharing.gas_table.Panel.at physics.contact.sharing.gas_table.Panel.films
    physics.contact.sharing.gas_table.Panel.octave_solved
    physics.contact.sharing.gas_table.Panel.solved
    physics.plate.solid.volume.PlateVolume.displacement
    physics.plate.solid.volume.PlateVolume.potential physics.plate.solid.volume.harmonic_fields
    physics.plate.solid.volume.mode_fields physics.plate.solid.volume.plate_volume
    physics.render.texture.pattern.Coordinate.at physics.render.texture.pattern.FromPoint.at
    physics.render.fidelity.report.fidelity_report physics.render.fidelity.report.strongest_lines
    physics.render.fidelity.rendered_stroke.friction_of
    physics.render.fidelity.rendered_stroke.per_sample
    physics.render.motion.estimator.MotionCounts.of physics.render.program.renderer.counters_of
    """,
    "the real-time tick: it takes any floats, flags what it cannot use and never raises": """
    physics.render.program.renderer.Renderer.tick
    """,
    "a verb that is called with the fields of a record, which is attacked itself": """
    design.sweep.sweep.sweep physics.plate.solid.solve.solve_modes
    """,
    "the check of numbers itself, whose bounds are the code's own, and its messages' text": """
    core.quantities.require.Rising core.quantities.require.require
    core.quantities.units.format_quantity
    core.quantities.units.typed_quantity
    """,
}
"""The public calls for which no good call is made here, by the reason. A new one must be named."""

NAMES_NOT_CALLED = frozenset(name for names in NOT_CALLED.values() for name in names.split())


@dataclass(frozen=True)
class PublicCall:
    """A public function, constructor or method with arguments that are numbers.

    `owner` is the class of a method that needs an instance; `hints` are the annotations of the
    arguments, `numbers` the names of those that are numbers.
    """

    name: str
    function: Callable[..., Any]
    owner: type[Any] | None
    hints: dict[str, Any]

    @property
    def numbers(self) -> tuple[str, ...]:
        return tuple(name for name, hint in self.hints.items() if is_number(hint))


def is_number(hint: Any) -> bool:
    """Whether an annotation stands for a number or an array of numbers, alone or beside None."""
    origin = typing.get_origin(hint)
    if origin in (collections.abc.Callable, collections.abc.Mapping, dict):
        return False
    if unit_of(hint) is not None or hint in _NUMBERS:
        return True
    return origin is not None and any(is_number(part) for part in typing.get_args(hint))


def is_kernel(item: Any) -> bool:
    """Whether something is compiled by numba: what is called from within checked functions."""
    return hasattr(item, "py_func") or type(item).__module__.startswith("numba")


def annotations_of(
    function: Callable[..., Any], home: object, made: type[Any] = object
) -> dict[str, Any]:
    """The annotations of what a function takes, by name; `home` is its module. What is `made` by
    it, or called with a record's fields, may inherit those of another module."""
    bases = getattr(function, "record", made).__mro__[:-1]
    homes = [vars(sys.modules[base.__module__]) for base in bases]
    # What a module imports for types only is not there at run time; it is no number either.
    names = dict(ChainMap(vars(home), *homes))
    for _ in range(20):
        try:
            hints = typing.get_type_hints(function, names, include_extras=True)
            break
        except NameError as error:
            names[str(error.name)] = object
    hints.pop("return", None)
    return {
        name: hints.get(name)
        for name in inspect.signature(function).parameters
        if name not in ("self", "cls")
    }


def _calls_of_class(cls: type[Any], home: object) -> Iterator[PublicCall]:
    name = f"{cls.__module__}.{cls.__qualname__}".removeprefix("squeezefilm.")
    if "__init__" in vars(cls) and not getattr(cls, "_is_protocol", False):
        yield PublicCall(name, cls, None, annotations_of(cls.__init__, home, cls))
    for key, member in vars(cls).items():
        if key.startswith("_") and key != "__call__":
            continue
        if isinstance(member, classmethod | staticmethod):
            made = getattr(cls, key)
            yield PublicCall(f"{name}.{key}", made, None, annotations_of(made, home))
        elif inspect.isfunction(member):
            yield PublicCall(f"{name}.{key}", member, cls, annotations_of(member, home))


@functools.cache
def public_calls() -> dict[str, PublicCall]:
    """Every public call with numbers among its arguments, by its dotted name below the package."""
    found = {}
    for module in pkgutil.walk_packages(squeezefilm.__path__, "squeezefilm."):
        place = f"{module.name.removeprefix('squeezefilm.')}."
        if not place.startswith(_ROOMS) and not any(room.startswith(place) for room in ROOMS):
            continue
        home = importlib.import_module(module.name)
        for key, item in vars(home).items():
            if key.startswith("_") or getattr(item, "__module__", None) != module.name:
                continue
            if inspect.isclass(item):
                calls = list(_calls_of_class(item, home))
            elif inspect.isroutine(inspect.unwrap(item)) and not is_kernel(item):
                name = f"{module.name}.{key}".removeprefix("squeezefilm.")
                taking = inspect.unwrap(
                    item, stop=lambda function: "__signature__" in vars(function)
                )
                calls = [PublicCall(name, item, None, annotations_of(taking, home))]
            else:
                calls = []
            attacked = [call for call in calls if f"{call.name}.".startswith(_ROOMS)]
            found.update({call.name: call for call in attacked if call.numbers})
    return found
