"""Every public call of the physics and rendering rooms that takes numbers, by its annotations.

`public_calls` walks the rooms; `good_arguments` makes a call of each that works.
"""

from __future__ import annotations

import collections.abc
import functools
import importlib
import inspect
import pkgutil
import typing
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import squeezefilm
from squeezefilm.quantities import unit_of

ROOMS = {
    "film", "plate", "contact", "render", "chain.friction", "chain.prediction", "chain.touch",
    "chain.pad_place", "actuators.skin_stretch", "actuators.motor", "control",
    "materials",
    "quantities", "distributions", "formats", "calibration_record",
    "measure.recordings.kinds", "measure.fits.circuit.branches", "search.sweep",
    "measure.fits.ceramic.ceramic_prior", "measure.fits.vibration.driven_shape",
}  # fmt: skip
_REAL_ARRAY = np.ndarray[tuple[Any, ...], np.dtype[np.float64]]
_NUMBERS = (int, float, _REAL_ARRAY)


_ROOMS = tuple(f"{room}." for room in ROOMS)

NOT_CALLED = {
    "a record of what was computed, which only the package makes": """
    actuators.motor.averaged.AveragedMotor actuators.motor.in_time.MotorMotion
    actuators.motor.plane.PlaneMotion
    actuators.motor.curves.MotorMap actuators.motor.curves.ModelsCompared
    actuators.motor.curves.ModelsCompared.difference
    actuators.motor.closed_loop.TrackedForce actuators.motor.closed_loop.TrackedForce.mean_error
    actuators.motor.stator.FaceMode
    plate.electronics.Amplifier
    plate.electronics.ElectricalLoad plate.electronics.RingAdmittance
    film.periodic.solution.Asked film.periodic.solution.Found
    contact.sharing.pad.PadFriction
    contact.sharing.balance.LoadSharing
    contact.sliding.skin_vibration.SkinVibration
    contact.sliding.march.Sliding
    film.periodic.balance.LoadBalance
    film.periodic.batch.FilmBatch film.periodic.solution.FilmSolution
    film.planar.film.FilmPlanar film.transient.settling.FilmSettled
    film.transient.march.FilmTransient film.transient.march.MovedFilm
    film.validity.FilmValidity film.validity.ValidityCheck
    formats.hjif.HjifExport plate.ring.modes.AnnularMode
    plate.solid.resonances.DrivenMode
    plate.beam.modes.BeamMode plate.solid.modes.PlateModes plate.solid.response.HarmonicResponse
    plate.heat.thermal.ThermalBody plate.heat.warming.Warming plate.heat.states.WarmState
    plate.solid.volume.PlateVolume plate.beam.response.BeamResponse plate.ring.body.RingBody
    plate.ring.response.RingResponse
    plate.shear.modes.ShearMode plate.shear.working.ShearWorking
    plate.solid.working.SolidMode plate.exposure.ExposureGuidance
    plate.sound.SoundField plate.working_mode.ModeLine plate.working_mode.WorkingMode
    plate.surface_shape.BeamSurface plate.surface_shape.DiscSurface
    plate.surface_shape.SolvedSurface plate.surface_shape.SurfaceShape
    plate.surface_shape.TrackSurface
    plate.ring.stator.StatorFit
    chain.prediction.Prediction render.resonator.compensation.CompensatedDrive
    render.fidelity.report.FidelityReport render.motion.estimator.MotionCounts
    render.motion.estimator.MotionEstimate render.fidelity.rendered_stroke.RenderedStroke
    render.program.renderer.Counters render.program.renderer.Rendered chain.touch.Touch
    """,
    "inside a solver: meshes, matrices and indices, made by calls that are checked": """
    measure.fits.circuit.branches.Layout measure.fits.circuit.branches.Layout.branch
    measure.fits.circuit.branches.circuit_curve measure.fits.circuit.branches.relative_motion
    measure.fits.circuit.branches.start_at
    contact.asperities.cubics contact.sharing.balance.require_balanced
    plate.solid.size.SolveSize.require_within
    actuators.motor.in_time.resting
    plate.elements.slab_count.require_countable
    plate.heat.states.WarmCase.states plate.heat.states.WarmCase.time_to_fall
    film.periodic.batch.check_film film.periodic.batch.solve_all film.line_grid.LineGrid
    film.line_grid.edge_graded film.line_grid.edge_layer film.line_grid.gap_table
    film.line_grid.line_grid film.line_grid.mean_over film.line_grid.refined_line
    film.line_grid.uniform_gap film.periodic.nested.load_times film.periodic.nested.force_harmonics
    film.periodic.nested.levels_of film.periodic.nested.refine film.periodic.nested.steadied
    film.periodic.small.fill_small
    film.periodic.small.reduced film.periodic.solution.extrapolated_field
    film.closed.small.small_vibration film.closed.small.small_pressure
    film.closed.small.flow_factor film.closed.small.SmallVibration film.planar.balance.Balance
    film.planar.balance.Balancer film.planar.balance.Balancer.solve film.planar.balance.Film
    film.planar.balance.derivative film.planar.balance.resampled film.planar.balance.times
    film.planar.cut.cut_ellipse_grid film.planar.gap.gap_values
    film.planar.gap.require_periodic film.planar.grid.PlanarGrid film.planar.grid.disc_grid
    film.planar.grid.ellipse_grid film.planar.grid.graded_line
    film.planar.grid.rectangle_grid film.planar.ladder.Climb film.planar.ladder.Extrapolated
    film.planar.ladder.Ladder film.planar.ladder.Ladder.grid film.planar.ladder.climb_to
    film.periodic.profile.GapProfile.grid film.periodic.profile.sampled_grid
    film.periodic.resolution.first_guess
    film.periodic.resolution.refined film.periodic.resolution.collocation_times film.gas.slip_law
    plate.ring.elements.HarmonicSystem
    plate.ring.elements.HarmonicSystem.field plate.ring.elements.RingMesh
    plate.ring.elements.harmonic_system plate.ring.ceramic_disc.DiscSystem
    plate.ring.ceramic_disc.disc_system plate.elements.block_ldl.PartialLDL
    plate.elements.block_ldl.partial_ldl plate.elements.mirrored_element.MirroredElement
    plate.elements.slab_cells.Cell plate.elements.slab_cells.Group
    plate.elements.slab_cells.Group.inside plate.elements.slab_cells.Group.node
    plate.elements.slab_cells.mirrors
    plate.elements.box_model.BoxModel
    plate.elements.box_model.Electrode
    plate.elements.box_model.Foundation plate.elements.box_model.Medium
    plate.elements.box_model.Medium.gradient_matrix plate.elements.box_model.kept_products
    plate.elements.box_model.held_components plate.elements.box_model.require_aspect
    plate.elements.cross_section.slice_codes plate.elements.block_ldl.LDLSteps
    plate.solid.electrode_circuits.tied_electrodes
    plate.solid.coarse_modes.CoarseModes plate.solid.coarse_modes.chosen_modes
    plate.solid.coarse_modes.class_fits plate.solid.coarse_modes.coarse_modes
    plate.solid.guess.estimated_frequency plate.elements.cross_section.CrossSection
    plate.elements.cross_section.cross_section plate.solid.electrode_circuits.open_values
    plate.solid.electrode_circuits.shunted_frequencies plate.solid.refined_modes.extrapolated_class
    plate.elements.krylov.modes_below plate.elements.krylov.modes_near
    plate.elements.krylov.prolonged plate.elements.krylov.with_open_electrodes
    plate.elements.lobatto.LineMesh
    plate.elements.lobatto.LineMesh.interpolation
    plate.elements.lobatto.LineMesh.located
    plate.elements.lobatto.hierarchic_values
    plate.elements.lobatto.lagrange_basis plate.elements.lobatto.line_matrices
    plate.elements.lobatto.lobatto_nodes
    plate.solid.mode_table.collected_modes plate.solid.mode_table.energy_shares_of
    plate.elements.lobatto.gauss_points plate.ring.elements.graded_edges
    plate.elements.lobatto.lagrange plate.elements.sparse_modes.nearest_modes
    plate.elements.sparse_modes.entries plate.elements.sparse_modes.gathered
    plate.elements.sparse_modes.shifted_inverse plate.ring.elements.node_coordinates
    plate.solid.model.PlateModel plate.solid.resonances.driven_modes
    plate.solid.resonances.antinode plate.solid.screening.forbidden_by
    plate.solid.layers.Resolution plate.solid.layers.merged
    plate.solid.layers.nearest plate.solid.layers.snapped
    plate.solid.mesh.plate_model plate.solid.mesh.wave_number
    plate.solid.model.PlateModel.evaluation
    plate.solid.model.PlateModel.field plate.solid.model.PlateModel.force
    plate.solid.modes.label_of plate.elements.nodal_lines.profiles plate.solid.modes.surface_shapes
    plate.elements.nodal_lines.zero_crossings plate.solid.symmetry.mirror_map
    plate.solid.reduced.ReducedClass
    plate.solid.reduced.harmonic_solution plate.elements.krylov.orthonormal
    plate.elements.box_model.require_half_wave
    plate.solid.reduced.reduced_class plate.solid.reduced.resolved_frequency
    plate.solid.reduced.reduced_model plate.solid.solve.solve_for_response
    plate.solid.reduced.surface_values plate.solid.refined_modes.RefinedModes
    plate.solid.refined_modes.extrapolated plate.solid.refined_modes.refined_modes
    plate.solid.refined_modes.with_label plate.shear.elements.Axis
    plate.shear.elements.ShearSystem plate.shear.elements.ShearSystem.deflection
    plate.shear.elements.make_axis plate.shear.elements.shear_system
    plate.solid.guess.bare_frequency plate.solid.guess.screened_frequency
    plate.elements.nodal_lines.line_counts
    plate.beam.modes.scaled_mode plate.beam.modes.wave_numbers
    plate.beam.pieces.pieced_beam_mode
    plate.shear.section.ShearLayout.mirrored
    plate.elements.slab_factor.SlabFactor plate.elements.slabs.Slabs.grid
    plate.elements.slabs.Slabs.mass_times
    plate.elements.slabs.Slabs.places plate.elements.slabs.Slabs.stiffness_times
    plate.elements.slabs.Slabs.weighted_sections render.opcodes.Assembler.emit
    render.opcodes.Assembler.table render.texture.coordinate.require_fade
    render.texture.noise.field_noise
    render.texture.noise.line_noise film.periodic.resolution.resolution_of
    film.periodic.solution.assembled
    """,
    "no number but the index of what its other arguments hold, or an array the package made": """
    contact.sharing.gas_table.FilmTable.build
    contact.sharing.film_panels.Panel.at contact.sharing.film_panels.Panel.films
    contact.sharing.film_panels.Panel.octave_solved contact.sharing.film_panels.Panel.solved
    plate.solid.volume.PlateVolume.displacement plate.solid.volume.PlateVolume.potential
    plate.solid.volume.harmonic_fields plate.solid.volume.mode_fields
    plate.solid.volume.plate_volume render.texture.coordinate.Coordinate.at
    render.texture.coordinate.FromPoint.at render.fidelity.report.fidelity_report
    render.fidelity.report.strongest_lines
    render.fidelity.trace.friction_of render.fidelity.trace.per_sample
    render.motion.estimator.MotionCounts.of render.program.renderer.counters_of
    """,
    "the real-time tick: it takes any floats, flags what it cannot use and never raises": """
    render.program.renderer.Renderer.tick
    """,
    "the check of numbers itself, whose bounds are the code's own, and its messages' text": """
    quantities.require.require quantities.units.format_quantity
    quantities.units.typed_quantity
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


def annotations_of(function: Callable[..., Any], home: object) -> dict[str, Any]:
    """The annotations of what a function takes, by name; `home` is its module."""
    # What a module imports for types only is not there at run time; it is no number either.
    names = typing.cast(dict[str, Any], dict(vars(home)))
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
        yield PublicCall(name, cls, None, annotations_of(cls.__init__, home))
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
        if not f"{module.name.removeprefix('squeezefilm.')}.".startswith(_ROOMS):
            continue
        home = importlib.import_module(module.name)
        for key, item in vars(home).items():
            if key.startswith("_") or getattr(item, "__module__", None) != module.name:
                continue
            if inspect.isclass(item):
                calls = list(_calls_of_class(item, home))
            elif inspect.isroutine(inspect.unwrap(item)) and not is_kernel(item):
                name = f"{module.name}.{key}".removeprefix("squeezefilm.")
                calls = [PublicCall(name, item, None, annotations_of(inspect.unwrap(item), home))]
            else:
                calls = []
            found.update({call.name: call for call in calls if call.numbers})
    return found
