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
    "film", "plate", "contact", "render", "friction", "prediction", "touch", "materials",
    "quantities", "distributions", "formats",
}  # fmt: skip
_REAL_ARRAY = np.ndarray[tuple[Any, ...], np.dtype[np.float64]]
_NUMBERS = (int, float, _REAL_ARRAY)


NOT_CALLED = {
    "a record of what was computed, which only the package makes": """
    contact.film_load.FilmLoad contact.pad.PadFriction contact.sharing.LoadSharing
    contact.sharing.TiedSharing contact.skin_vibration.SkinVibration contact.sliding.Sliding
    contact.tapping.Tapping film.balance.LevitationLimit film.balance.LoadBalance
    film.batch.FilmBatch film.edge.EdgeLayer film.periodic.FilmSolution
    film.planar.FilmPlanar film.settling.FilmSettled film.teeth.ToothedFilm
    film.transient.FilmTransient film.validity.FilmValidity film.validity.ValidityCheck
    formats.hjif.HjifExport formats.hjif_read.HjifImport plate.annular.AnnularMode
    plate.beam.BeamMode plate.plate_modes.PlateModes plate.plate_response.HarmonicResponse
    plate.plate_volume.PlateVolume plate.response.BeamResponse plate.ring_body.RingBody
    plate.ring_body.RingWorkingMode plate.ring_response.RingResponse
    plate.shear_plate.ShearMode plate.solid_mode.SolidMode plate.sound.ExposureGuidance
    plate.sound.SoundField plate.working_mode.ModeLine plate.working_mode.WorkingMode
    prediction.Prediction render.compensation.CompensatedDrive
    render.fidelity_report.FidelityReport render.motion.MotionCounts
    render.motion.MotionEstimate render.rendered_stroke.RenderedStroke
    render.renderer.Counters render.renderer.Rendered touch.Touch
    """,
    "inside a solver: meshes, matrices and indices, made by calls that are checked": """
    film.batch.check_film film.batch.solve_all film.line_grid.LineGrid
    film.line_grid.edge_graded film.line_grid.edge_layer film.line_grid.gap_table
    film.line_grid.line_grid film.line_grid.mean_over film.line_grid.refined_line
    film.line_grid.uniform_gap film.periodic.load_times film.planar_balance.Balance
    film.planar_balance.Balancer film.planar_balance.Balancer.solve film.planar_balance.Film
    film.planar_balance.derivative film.planar_balance.resampled film.planar_balance.times
    film.planar_cut.cut_ellipse_grid film.planar_gap.gap_values
    film.planar_gap.require_periodic film.planar_grid.PlanarGrid film.planar_grid.disc_grid
    film.planar_grid.ellipse_grid film.planar_grid.graded_line
    film.planar_grid.rectangle_grid film.planar_ladder.Climb film.planar_ladder.Extrapolated
    film.planar_ladder.Ladder film.planar_ladder.Ladder.grid film.planar_ladder.climb_to
    film.profile.GapProfile.grid film.profile.sampled_grid film.resolution.first_guess
    film.resolution.refined film.resolution.tables film.slip.slip_law
    film.transient.check_film plate.annular_elements.HarmonicSystem
    plate.annular_elements.HarmonicSystem.field plate.annular_elements.RingMesh
    plate.annular_elements.harmonic_system plate.block_ldl.PartialLDL
    plate.block_ldl.partial_ldl plate.box_model.BoxModel plate.box_model.Electrode
    plate.box_model.Foundation plate.box_model.Medium plate.box_model.Medium.gradient_matrix
    plate.coarse_modes.CoarseModes plate.coarse_modes.chosen_modes
    plate.coarse_modes.class_fits plate.coarse_modes.coarse_modes
    plate.coarse_modes.estimated_frequency plate.cross_section.CrossSection
    plate.cross_section.cross_section plate.electrode_circuits.open_values
    plate.electrode_circuits.shunted_frequencies plate.extrapolated_plate.extrapolated_class
    plate.krylov.Pairs plate.krylov.modes_below plate.krylov.modes_near
    plate.krylov.prolonged plate.krylov.with_open_electrodes plate.lobatto.LineMesh
    plate.lobatto.LineMesh.hierarchic_interpolation plate.lobatto.LineMesh.interpolation
    plate.lobatto.hierarchic_line_matrices plate.lobatto.hierarchic_values
    plate.lobatto.lagrange_basis plate.lobatto.line_matrices plate.lobatto.lobatto_nodes
    plate.mode_table.collected_modes plate.mode_table.energy_shares_of
    plate.nodal_basis.gauss_points plate.nodal_basis.graded_edges plate.nodal_basis.lagrange
    plate.nodal_basis.node_coordinates plate.plate_mesh.PlateModel
    plate.plate_mesh.Resolution plate.plate_mesh.plate_model plate.plate_mesh.wave_number
    plate.plate_modes.SolvedModel.field plate.plate_modes.SolvedModel.force
    plate.plate_modes.label_of plate.plate_modes.profiles plate.plate_modes.surface_shapes
    plate.plate_modes.zero_crossings plate.plate_symmetry.mirror_map
    plate.reduced_plate.ReducedClass plate.reduced_plate.harmonic_solution
    plate.reduced_plate.reduced_class plate.reduced_plate.resolved_frequency
    plate.reduced_plate.surface_values plate.refined_modes.RefinedModes
    plate.refined_modes.extrapolated plate.refined_modes.refined_modes
    plate.refined_modes.with_label plate.shear_elements.Axis
    plate.shear_elements.ShearSystem plate.shear_elements.ShearSystem.deflection
    plate.shear_elements.make_axis plate.shear_elements.shear_system
    plate.shear_guess.bare_frequency plate.shear_guess.screened_frequency
    plate.shear_guess.straightness plate.shear_section.ShearLayout.mirrored
    plate.slab_factor.SlabFactor plate.slabs.Slabs.grid plate.slabs.Slabs.mass_times
    plate.slabs.Slabs.places plate.slabs.Slabs.stiffness_times
    plate.slabs.Slabs.weighted_sections render.opcodes.Assembler.emit
    render.opcodes.Assembler.table render.pattern_noise.mixed render.coordinate.require_fade
    render.coordinate.require_place render.pattern_noise.field_noise
    render.pattern_noise.line_noise
    """,
    "no number but the index of what its other arguments hold, or an array the package made": """
    contact.gas_table.FilmTable.build film.compiled.announce
    plate.plate_volume.PlateVolume.displacement plate.plate_volume.PlateVolume.potential
    plate.plate_volume.harmonic_fields plate.plate_volume.mode_fields
    plate.plate_volume.plate_volume render.coordinate.Coordinate.at
    render.coordinate.FromPoint.at render.coordinate.AlongY.at render.coordinate.AlongX.at
    render.coordinate.AlongDirection.at render.fidelity_report.fidelity_report
    render.motion.MotionCounts.of render.renderer.counters_of
    """,
    "the real-time tick: it takes any floats, flags what it cannot use and never raises": """
    render.renderer.Renderer.tick
    """,
    "the check of numbers itself, whose bounds are the code's own, and its messages' text": """
    quantities.checks.require quantities.checks.require_valid quantities.units.format_quantity
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


def _hints(function: Callable[..., Any], home: object) -> dict[str, Any]:
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
    if cls.__init__ is not object.__init__ and not getattr(cls, "_is_protocol", False):
        yield PublicCall(name, cls, None, _hints(cls.__init__, home))
    for key, member in vars(cls).items():
        if key.startswith("_") and key != "__call__":
            continue
        if isinstance(member, classmethod | staticmethod):
            made = getattr(cls, key)
            yield PublicCall(f"{name}.{key}", made, None, _hints(made, home))
        elif inspect.isfunction(member):
            yield PublicCall(f"{name}.{key}", member, cls, _hints(member, home))


@functools.cache
def public_calls() -> dict[str, PublicCall]:
    """Every public call with numbers among its arguments, by its dotted name below the package."""
    found = {}
    for module in pkgutil.walk_packages(squeezefilm.__path__, "squeezefilm."):
        if module.name.split(".")[1] not in ROOMS:
            continue
        home = importlib.import_module(module.name)
        for key, item in vars(home).items():
            if key.startswith("_") or getattr(item, "__module__", None) != module.name:
                continue
            if inspect.isclass(item):
                calls = list(_calls_of_class(item, home))
            elif inspect.isroutine(inspect.unwrap(item)) and not is_kernel(item):
                name = f"{module.name}.{key}".removeprefix("squeezefilm.")
                calls = [PublicCall(name, item, None, _hints(inspect.unwrap(item), home))]
            else:
                calls = []
            found.update({call.name: call for call in calls if call.numbers})
    return found
