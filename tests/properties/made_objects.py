"""Objects of the domain, small and quick to solve, for calls that need one."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.actuators.motor.assembled import AssembledMotor, FaceMode, Working, assembled
from squeezefilm.actuators.motor.description import Cradle, Foot, FootContact, Motor
from squeezefilm.actuators.motor.force_law import ForceLaw, ForceState
from squeezefilm.actuators.skin_stretch.array import SkinStretchArray
from squeezefilm.actuators.skin_stretch.bimorph import Bender, Bimorph
from squeezefilm.actuators.skin_stretch.cradle import FingerCradle, Fingertip
from squeezefilm.actuators.skin_stretch.tissue import Tissue
from squeezefilm.core.distributions import Normal, Uniform
from squeezefilm.core.materials import ElasticMaterial, Gas, Piezoceramic, PiezoConstants
from squeezefilm.core.progress import Deadline
from squeezefilm.core.quantities import Unit
from squeezefilm.physics.chain.friction import (
    LAWS,
    AsymptoteLaw,
    FittedLaw,
    FrictionLaw,
    LiftedLaw,
)
from squeezefilm.physics.chain.pad_law import FrictionModel
from squeezefilm.physics.chain.pad_place import PadPlace
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.finger.fingertip import Finger, FingerpadDynamics, Skin
from squeezefilm.physics.contact.sharing.balance import LoadSharing, share_load
from squeezefilm.physics.contact.sharing.gas_table import FilmTable, film_table
from squeezefilm.physics.contact.sharing.pad import FrictionRipple
from squeezefilm.physics.contact.sliding.march import (
    DryFriction,
    Sliding,
    SpeedFriction,
    slide,
)
from squeezefilm.physics.display import Display, Surface, load_display
from squeezefilm.physics.film.gap import PaperGap
from squeezefilm.physics.film.periodic.profile import GapProfile, flexural_profile
from squeezefilm.physics.film.planar.grid import PlanarGap
from squeezefilm.physics.plate.beam_modes import BeamMode
from squeezefilm.physics.plate.beam_response import BeamResponse, beam_response
from squeezefilm.physics.plate.circuit import DrivenResponse, EquivalentCircuit
from squeezefilm.physics.plate.electronics import AMPLIFIERS, AmplifierPart
from squeezefilm.physics.plate.elements.box_model import Medium, isotropic_solid
from squeezefilm.physics.plate.heat_states import HeatSource
from squeezefilm.physics.plate.laminate import Laminate, LaminateLayer, plate_laminate
from squeezefilm.physics.plate.layout import Actuator, CeramicPatch, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.loaded_mode import LoadedMode
from squeezefilm.physics.plate.ring.body import (
    RingBody,
    RingResponse,
    StatorAssumptions,
    StatorFit,
    fit_stator,
    ring_response,
)
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc
from squeezefilm.physics.plate.ring.modes import AnnularMode, bending_mode
from squeezefilm.physics.plate.ring.section import (
    AnnularSection,
    RingLayer,
    SectorDrive,
    bonded_disc,
    full_drive,
)
from squeezefilm.physics.plate.solid.modes import PlateModes
from squeezefilm.physics.plate.solid.response import (
    HarmonicResponse,
    harmonic_response,
)
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.working import SolidMode, solid_mode
from squeezefilm.physics.plate.sound import RadiatingSurface, smooth_surface
from squeezefilm.physics.plate.surface_shape import (
    BeamSurface,
    DiscSurface,
    SurfaceShape,
    TrackSurface,
    surface_shape,
)
from squeezefilm.physics.plate.thermal import Thermal
from squeezefilm.physics.plate.working_mode import WorkingMode, working_mode
from squeezefilm.physics.render.motion.estimator import (
    LVDT_10_KHZ,
    MotionEstimator,
    MotionModel,
    SensorModel,
    SensorStream,
    sensor_stream,
)
from squeezefilm.physics.render.motion.stroke import (
    FingerPath,
    MinimumJerkStroke,
    OverPath,
    Stroke,
    Trajectory,
)
from squeezefilm.physics.render.program.inverse import (
    FrictionInverse,
    FrictionTable,
    WaveCompensation,
)
from squeezefilm.physics.render.program.lowering import Program, lower
from squeezefilm.physics.render.program.renderer import MadeForSpeed, Renderer
from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
)
from squeezefilm.physics.render.texture.composition import Composable, Texture
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.physics.render.texture.pattern import (
    AlongX,
    AlongY,
    Coordinate,
    Pattern,
    TexturePart,
)
from squeezefilm.physics.render.texture.shapes import SineWave, SquareWave
from squeezefilm.physics.texture_files.hjif import ReferenceDevice, hjif_of

BRASS = ElasticMaterial("brass", 100e9, 0.35, 8500.0, 200.0)
PZT = Piezoceramic("PZT", 67.9e9, 0.29, 23e9, 7700.0, -247e-12, 1900.0, 60.0)
TPAD = load_display("winfield2007-tpad").actuator
STATOR = load_display("biet2008-stator").actuator
PLATE = RectangularPlate(
    30e-3, 10e-3, 2e-3, 4, 60.0, BRASS, PZT, (CeramicPatch(12e-3, 0.0, 6e-3, 10e-3, 1e-3),)
)
SINE = SineWave(2e-3)
ENVELOPE = DrivenEnvelope(0.5e-3, 0.5e-3, 2e-6)
FINGER = Finger(10e-3, 50e-6, 350e-6, 0.5)
AIR = Gas(1.81e-5, 101325.0, 1.2, 68e-9)
WAYS = np.linspace(0.0, 1e-3, 9)


def falling_over_speeds(amplitude: Any, speed: Any) -> Any:
    return 1 - np.asarray(amplitude) / (4e-6 + 1e-6 * np.asarray(speed)[:, None])


def falling_friction(amplitude: Any, speed: Any = None) -> Any:
    return 1 - np.asarray(amplitude) / 4e-6


def _law(model: FrictionModel) -> FrictionLaw:
    return LAWS[model](Surface("bare", 1e-6, 0.6), FINGER, AIR, 8e-3, 30e3, 0.5, model)


def disc_section() -> AnnularSection:
    return bonded_disc(DiscPlate(25e-3, 1e-3, 60.0, BRASS, PZT, 15e-3, 0.5e-3))


def hjif_document() -> Any:
    return hjif_of(made(RelativeFriction), 0.0, 20e-3, device=made(ReferenceDevice)).document


def _capacitor() -> DrivenResponse:
    """The response of a capacitor that loses a little, from a hertz to ten megahertz."""
    response = DrivenResponse()
    response.frequencies = np.geomspace(1.0, 1e7, 50)
    response.admittance = (0.01 + 1j) * 2e-9 * np.pi * response.frequencies
    return response


@functools.cache
def some_motor() -> AssembledMotor:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    feet = (Foot(32.4e-3, 24.5e-3), Foot(56e-3, 24.5e-3))
    contact = FootContact(2e7, 1.6e7, 0.3, 0.3)
    return assembled(Motor(plate, feet, contact, Cradle(10.0), 0.05, 15.0), "timoshenko")


def some_force_law() -> ForceLaw:
    thrust = np.array([[-1.0, 2.0, 3.0], [-2.0, 1.0, 2.0]])
    speed, amplitude = np.array([0.0, 0.1]), np.array([0.0, 1e-6, 2e-6])
    return ForceLaw(speed, amplitude, thrust, 1e7, 5e-4, 5e-4, 4e-3, 5e-4, 30.0)


def fields_of(value: Any) -> dict[str, Any]:
    return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}


# By their type, made when first asked for.
MADE: dict[Any, Callable[[], Any]] = {
    AssembledMotor: some_motor,
    Motor: lambda: some_motor().motor,
    Working: lambda: Working(amplitude=1e-6),
    FaceMode: lambda: some_motor().modes[0],
    FootContact: lambda: some_motor().motor.contact,
    ForceLaw: some_force_law,
    ForceState: ForceState,
    Bimorph: lambda: Bimorph(20e-3, 1e-3, PZT, 0.3e-3, BRASS),
    Bender: lambda: Bender(4.6e-7, 1.8e3, 900.0, 5e-9),
    FingerCradle: lambda: FingerCradle(3, 2, 1.2e-3, 1.8e-3, 1e-3, 1.6e-3, 4e-3, 4e-3, 9e-3, 22e-3),
    Fingertip: Fingertip,
    Tissue: Tissue,
    SkinStretchArray: lambda: SkinStretchArray(MADE[Bimorph](), MADE[FingerCradle]()),
    AsperityLaw: AsperityLaw,
    DryFriction: lambda: DryFriction(1.2),
    SpeedFriction: lambda: SpeedFriction(np.array([0.0, 0.1]), np.array([0.2, 0.5])),
    Finger: lambda: FINGER,
    FingerpadDynamics: FingerpadDynamics,
    LoadSharing: lambda: share_load(MADE[FilmTable](), AsperityLaw(), 1e-6, 5e3),
    FilmTable: lambda: film_table(30e3, 250e-6, AIR),
    FrictionRipple: lambda: FrictionRipple(WAYS, np.linspace(0.5, 1, 9), 1e-2, 8e-3),
    Skin: Skin,
    Sliding: lambda: slide(np.linspace(0, 1e-2, 200), 1e-3, 0.6, 0.5),
    Display: lambda: load_display("biet2008-plate"),
    Surface: lambda: Surface("bare", 1e-6, 0.6),
    Normal: lambda: Normal(1.0, 0.1),
    Uniform: lambda: Uniform(0.5, 1.0),
    PaperGap: lambda: PaperGap(1e-6, 0.5e-6, 50e-6, 350e-6, 16e-3, 10e-3),
    PlanarGap: lambda: PlanarGap(0.2),
    GapProfile: lambda: flexural_profile(0.2),
    ReferenceDevice: lambda: ReferenceDevice("mine", 200.0, 5.0, 1e-4),
    FrictionLaw: lambda: _law("partial-levitation"),
    AsymptoteLaw: lambda: _law("paper2008"),
    LiftedLaw: lambda: _law("levitation-2016"),
    FittedLaw: lambda: _law("levitation"),
    ElasticMaterial: lambda: BRASS,
    Gas: lambda: AIR,
    Piezoceramic: lambda: PZT,
    PiezoConstants: lambda: PZT.full_constants,
    AnnularMode: lambda: bending_mode(disc_section(), 0, 1, degree=3),
    AnnularSection: disc_section,
    SectorDrive: full_drive,
    RingLayer: lambda: disc_section().layers[0],
    CeramicDisc: lambda: CeramicDisc(20e-3, 1e-3, 7700.0),
    BeamMode: lambda: beam_response(PLATE).mode,
    Laminate: lambda: plate_laminate(PLATE),
    LaminateLayer: lambda: LaminateLayer(1e-3, 100e9, 40e9, 8500.0),
    RectangularPlate: lambda: PLATE,
    Actuator: lambda: PLATE,
    Thermal: Thermal,
    Deadline: lambda: Deadline(ends=1e12),
    HeatSource: lambda: HeatSource(30e3, 60.0, 1e-6, 1.0),
    CeramicPatch: lambda: PLATE.patches[0],
    LoadedMode: lambda: LoadedMode(30e3, 60.0, 0.01 + 0.01j),
    EquivalentCircuit: lambda: EquivalentCircuit(30e3, 60.0, 1e-9, 100.0, 0.03, 1e-9),
    DrivenResponse: _capacitor,
    AmplifierPart: lambda: AMPLIFIERS[0],
    BeamResponse: lambda: beam_response(PLATE),
    Medium: lambda: isotropic_solid(BRASS),
    RadiatingSurface: lambda: smooth_surface(
        (0.02, 0.01), lambda x, y: np.ones((x.size, y.size)) + 0j, 30e3, 0.01
    ),
    StatorAssumptions: StatorAssumptions,
    StatorFit: fit_stator,
    WorkingMode: lambda: working_mode(PLATE, "timoshenko"),
    PadPlace: lambda: PadPlace(made(SurfaceShape), 5e-3, 5e-3),
    SurfaceShape: lambda: surface_shape(PLATE, working_mode(PLATE, "timoshenko")),
    BeamSurface: lambda: surface_shape(PLATE, working_mode(PLATE, "timoshenko")),
    DiscSurface: lambda: surface_shape(TPAD, working_mode(TPAD)),
    TrackSurface: lambda: surface_shape(STATOR, working_mode(STATOR)),
    Unit: lambda: Unit("m"),
    DrivenEnvelope: lambda: ENVELOPE,
    Composable: lambda: RelativeFriction(SINE, 0.5, 0.9),
    RelativeFriction: lambda: RelativeFriction(SINE, 0.5, 0.9),
    Coordinate: AlongX,
    FingerPath: lambda: FingerPath(np.linspace(0, 1, 9), np.linspace(0, 0.02, 9), np.zeros(9)),
    MadeForSpeed: lambda: MadeForSpeed(0.08, -0.1, 0.05),
    FrictionTable: lambda: FrictionInverse.from_function(falling_friction, 2e-6),
    FrictionInverse: lambda: FrictionInverse.from_function(falling_friction, 2e-6),
    MotionEstimator: lambda: MotionEstimator.for_sensor(LVDT_10_KHZ),
    MotionModel: MotionModel,
    TexturePart: lambda: SINE,
    Pattern: lambda: SINE,
    Program: lambda: lower(Amplitude(SINE, 0.0, 1e-6), largest_amplitude=2e-6),
    Renderer: lambda: Renderer(MADE[Program]()),
    SensorModel: lambda: LVDT_10_KHZ,
    SensorStream: lambda: sensor_stream(LVDT_10_KHZ, lambda t: 0.1 * t, 0.05, 1),
    Stroke: lambda: Stroke(0.1, 0.02),
    Texture: lambda: Amplitude(SquareWave(2e-3), 0.0, 1e-6),
    Trajectory: lambda: Stroke(0.1, 0.02),
    MinimumJerkStroke: lambda: MinimumJerkStroke(0.02, 0.1),
    WaveCompensation: lambda: WaveCompensation(8e-3, (1.0, 0.9, 0.5, 0.9)),
    Path: lambda: Path("missing"),
    PlateModes: lambda: solve_modes(PLATE, near=60e3, count=1),
    SolidMode: lambda: solid_mode(PLATE),
    HarmonicResponse: lambda: harmonic_response(PLATE, np.array([30e3, 31e3])),
    RingBody: lambda: RingBody(disc_section(), full_drive(), (0, 1), None),
    RingResponse: lambda: ring_response(
        made(RingBody), made(AnnularMode), np.array([30e3]), (0,), 2
    ),
    OverPath: lambda: OverPath(made(FingerPath)),
    AlongX: AlongX,
    AlongY: AlongY,
}  # fmt: skip


@functools.cache
def made(kind: Any) -> Any:
    """The object of the domain of this type."""
    return MADE[kind]()
