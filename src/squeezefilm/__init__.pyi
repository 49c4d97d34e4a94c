"""The front door for type checkers; `tools/front_door_stub.py` writes it."""

from typing import TYPE_CHECKING

# Every module depends on this one: so marked, a checker reads it last and meets no circle.
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path
    from typing import Any, Literal

    from numpy.typing import ArrayLike

    from squeezefilm.core.distributions import Distribution
    from squeezefilm.core.errors import SqueezefilmError as SqueezefilmError
    from squeezefilm.core.presets import display_names as display_names
    from squeezefilm.core.presets import study_names as study_names
    from squeezefilm.core.presets import texture_names as texture_names
    from squeezefilm.core.presets.materials import materials as materials
    from squeezefilm.core.progress import Pace, SayProgress
    from squeezefilm.core.quantities import (
        Dimensionless,
        FloatArray,
        Hertz,
        Metre,
        MetrePerSecond,
        MetrePerSecondArray,
        MetrePerVolt,
        Newton,
        NewtonArray,
        Pascal,
        Radian,
        Second,
        Volt,
        VoltArray,
    )
    from squeezefilm.design.analysis.analysis import Analysis
    from squeezefilm.design.analysis.sensitivities import Effort
    from squeezefilm.design.fabrication.fabricate import Fabrication
    from squeezefilm.design.film import FilmAnswer
    from squeezefilm.design.friction import FrictionAnalysis
    from squeezefilm.design.plate.command import PlateAnalysis
    from squeezefilm.design.plate.modes import ModeList
    from squeezefilm.design.plate.ring import RingAnalysis
    from squeezefilm.design.search.found import DesignSearch
    from squeezefilm.design.search.requirements import NamedRequirements
    from squeezefilm.design.sweep.swept import Sweep
    from squeezefilm.instruments.bench.play import PlayResult
    from squeezefilm.instruments.session.loop.plan import LoopCompensation
    from squeezefilm.instruments.session.play.plan import PlayMode, PlayView
    from squeezefilm.instruments.session.record.trace import read_trace as read_trace
    from squeezefilm.measure.calibration.blind import BlindPrediction, Score
    from squeezefilm.measure.calibration.folder import FolderCalibration
    from squeezefilm.measure.fits.by_kind import NamedRecording
    from squeezefilm.measure.fits.estimate import FitResult
    from squeezefilm.measure.recordings.read import check_recording as check_recording
    from squeezefilm.measure.recordings.read import read_recording as read_recording
    from squeezefilm.physics.chain.pad_law import FrictionModel
    from squeezefilm.physics.chain.pad_place import FacePlace
    from squeezefilm.physics.chain.prediction import Prediction
    from squeezefilm.physics.chain.rendered_texture import RenderAnalysis
    from squeezefilm.physics.chain.wanted_voltage import WantedFriction, WantedVoltage
    from squeezefilm.physics.display import Display, NamedDisplay
    from squeezefilm.physics.display import load_display as load_display
    from squeezefilm.physics.display import save_display as save_display
    from squeezefilm.physics.film.periodic.profile import GapFunction, GapProfile
    from squeezefilm.physics.perception.observer import NamedObserver
    from squeezefilm.physics.plate.working_mode import PlateTheory
    from squeezefilm.physics.render.motion.estimator import SensorModel
    from squeezefilm.physics.render.motion.stroke import Stroke as _Stroke
    from squeezefilm.physics.render.texture.image import Image as _Image
    from squeezefilm.physics.render.texture.image import Noise as _Noise
    from squeezefilm.physics.render.texture.image import Share
    from squeezefilm.physics.render.texture.levels import Amplitude as _Amplitude
    from squeezefilm.physics.render.texture.levels import FrictionShare, VibrationAmplitude
    from squeezefilm.physics.render.texture.levels import RelativeFriction as _RelativeFriction
    from squeezefilm.physics.render.texture.pattern import Coordinate, Length, Pattern, Place
    from squeezefilm.physics.render.texture.shapes import Band as _Band
    from squeezefilm.physics.render.texture.shapes import Bump as _Bump
    from squeezefilm.physics.render.texture.shapes import SineWave as _SineWave
    from squeezefilm.physics.render.texture.shapes import SquareWave as _SquareWave
    from squeezefilm.physics.render.texture.shapes import speed as speed
    from squeezefilm.physics.texture_files.texture_file import NamedTexture
    from squeezefilm.physics.texture_files.texture_file import load_texture as load_texture
    from squeezefilm.physics.texture_files.texture_file import save_texture as save_texture
    from squeezefilm.physics.texture_files.trajectories import NamedMotion
    from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction
    from squeezefilm.study.adaptive.bayesian import AdaptiveDesign as _AdaptiveDesign
    from squeezefilm.study.adaptive.bayesian import BayesianAdaptive as BayesianAdaptive
    from squeezefilm.study.adaptive.bayesian import Interest
    from squeezefilm.study.conduct.playback import Playable, Playback
    from squeezefilm.study.conduct.terminal_run import Examiner
    from squeezefilm.study.design.plan import StudyPlan
    from squeezefilm.study.design.study_design import NamedDesign
    from squeezefilm.study.psychometric.fit import PsychometricFit
    from squeezefilm.study.psychometric.function import Axis, Shape
    from squeezefilm.study.psychometric.function import (
        PsychometricFunction as _PsychometricFunction,
    )
    from squeezefilm.study.psychometric.function import PsychometricPrior as PsychometricPrior
    from squeezefilm.study.record.store import StudyStore
    from squeezefilm.study.simulated.answers import SimulatedStudy
    from squeezefilm.study.simulated.chain_tables import ChainTables
    from squeezefilm.study.tasks.analyze import StudyAnalysis, Tell
    from squeezefilm.subjects import plot as plot
    from squeezefilm.subjects import write_mode as write_mode
    from squeezefilm.subjects import write_report as write_report
    def replaced(display: NamedDisplay | str | Path, values: Mapping[str, float | str]) -> Display:
        """The display with other values at dotted paths: ``{"actuator.thickness": "1.5 mm"}``."""
    def with_finger(display: NamedDisplay | str | Path, finger: str | Path = ...) -> Display:
        """The display under another finger, which whatever draws a finger takes up."""
    def predict(
        display: NamedDisplay | str | Path,
        *,
        voltage: Volt | str | None = ...,
        frequency: Hertz | str | None = ...,
        normal_force: Newton | str | None = ...,
        surface: str | None = ...,
        vibration_amplitude: Metre | str | None = ...,
        model: FrictionModel | None = ...,
        speed: MetrePerSecond | str | None = ...,
        place: FacePlace | str | Path | None = ...,
        position: Metre | str | None = ...,
        theory: PlateTheory | None = ...,
        strict: bool = ...,
        pace: Pace = ...,
    ) -> Prediction:
        """The friction of a display driven with a voltage (V, zero-to-peak) at a frequency (Hz)."""
    def predict_grid(
        display: NamedDisplay | str | Path,
        *,
        voltage: Sequence[Volt] | VoltArray | str | None = ...,
        normal_force: Sequence[Newton] | NewtonArray | str | None = ...,
        speed: Sequence[MetrePerSecond] | MetrePerSecondArray | str | None = ...,
        place: Sequence[FacePlace | str] | str | Path | None = ...,
        model: FrictionModel | None = ...,
        progress: SayProgress | None = ...,
    ) -> Any:
        """The friction of a display at every combination of voltages (V), normal forces (N), speeds of"""
    def voltage_for_friction(
        display: NamedDisplay | str | Path,
        relative_friction: WantedFriction | str,
        *,
        frequency: Hertz | str | None = ...,
        normal_force: Newton | str | None = ...,
        surface: str | None = ...,
        theory: PlateTheory | None = ...,
        model: FrictionModel | None = ...,
        speed: MetrePerSecond | str | None = ...,
        place: FacePlace | str | Path | None = ...,
        position: Metre | str | None = ...,
    ) -> WantedVoltage:
        """The voltage (V, zero-to-peak) that brings µ′/µ down to a wanted value, and its amplitude (m)."""
    def analyze(
        display: NamedDisplay | str | Path,
        *,
        voltage: Volt | str | None = ...,
        frequency: Hertz | str | None = ...,
        normal_force: Newton | str | None = ...,
        surface: str | None = ...,
        vibration_amplitude: Metre | str | None = ...,
        model: FrictionModel | None = ...,
        speed: MetrePerSecond | str | None = ...,
        place: FacePlace | str | Path | None = ...,
        theory: PlateTheory | None = ...,
        strict: bool = ...,
        samples: int = ...,
        wanted_friction: WantedFriction | str | None = ...,
        sensitivities: Effort | None = ...,
        whole: bool = ...,
        progress: SayProgress | None = ...,
        budget: Second | str | None = ...,
    ) -> Analysis:
        """The whole analysis of a display at one working point."""
    def analyze_friction(
        display: NamedDisplay | str | Path,
        *,
        voltage: Volt | str | None = ...,
        frequency: Hertz | str | None = ...,
        normal_force: Newton | str | None = ...,
        surface: str | None = ...,
        vibration_amplitude: Metre | str | None = ...,
        model: FrictionModel | None = ...,
        speed: MetrePerSecond | str | None = ...,
        place: FacePlace | str | Path | None = ...,
        position: Metre | str | None = ...,
        ambient_pressure: Pascal | str | None = ...,
        wanted_friction: WantedFriction | str | None = ...,
        samples: int = ...,
        seed: int = ...,
        points: int = ...,
        progress: SayProgress | None = ...,
    ) -> FrictionAnalysis:
        """The friction of a display at a working point, with everything around it."""
    def list_modes(
        display: NamedDisplay | str | Path,
        band: tuple[Hertz, Hertz] | tuple[str, str] = ...,
        *,
        progress: SayProgress | None = ...,
    ) -> ModeList:
        """The modes of a display's plate, disc or stator in a band (Hz) that its drive can move."""
    def solve_plate(
        display: NamedDisplay | str | Path,
        *,
        mode: tuple[int, int] | None = ...,
        band: tuple[Hertz, Hertz] | tuple[str, str] | None = ...,
        points: int = ...,
        progress: SayProgress | None = ...,
        budget: Second | str | None = ...,
    ) -> PlateAnalysis | RingAnalysis:
        """The modes of a display's plate, disc or stator in a band (Hz), and its working mode's"""
    def solve_film(
        squeeze_number: Dimensionless | str,
        gap: Dimensionless | GapProfile | GapFunction | str,
        *,
        shape: str = ...,
        aspect_ratio: Dimensionless | str = ...,
        polytropic_exponent: Dimensionless | str = ...,
        knudsen_number: Dimensionless | str = ...,
        slip: str = ...,
        tolerance: Dimensionless | str = ...,
    ) -> FilmAnswer:
        """Solve a film. σ is on the width of a strip, the radius of a disc, the X side of a rectangle"""
    def sweep(
        display: NamedDisplay | Sequence[Display | str | Path] | str | Path,
        *,
        vary: Mapping[str, Any] | Sequence[str] = ...,
        ask: Sequence[str] | str = ...,
        over: str | Path | None = ...,
        sample: int | None = ...,
        seed: int = ...,
        jobs: int = ...,
        scheduler: str | None = ...,
        out: str | Path | None = ...,
        fresh: bool = ...,
        progress: SayProgress | None = ...,
    ) -> Sweep:
        """The numbers that verbs say of a display, at every point of a grid or of a file."""
    def search_designs(
        requirements: NamedRequirements | str | Path,
        *,
        screened: int = ...,
        solved: int = ...,
        seed: int = ...,
        jobs: int = ...,
        scheduler: str | None = ...,
        out: str | Path | None = ...,
        member: int = ...,
        progress: SayProgress | None = ...,
        watch: Callable[[DesignSearch], None] | None = ...,
    ) -> DesignSearch:
        """The plates that meet requirements and that none other beats, solved in three dimensions."""
    class Amplitude(_Amplitude):
        """A vibration amplitude: `low` (m, zero-to-peak) where the pattern is 0, `high` where it is 1."""
        def __init__(
            self,
            pattern: Pattern,
            low: VibrationAmplitude | str,
            high: VibrationAmplitude | str,
            type: Literal["amplitude"] = ...,
        ) -> None: ...

    class RelativeFriction(_RelativeFriction):
        """Friction over that of the surface at rest (1): `low` where the pattern is 0, else `high`."""
        def __init__(
            self,
            pattern: Pattern,
            low: FrictionShare | str,
            high: FrictionShare | str,
            type: Literal["relative_friction"] = ...,
        ) -> None: ...

    class Band(_Band):
        """1 from `start` to `end`, 0 outside, with edges linear over `fade`: a mask in space."""
        def __init__(
            self,
            start: Place | str,
            end: Place | str,
            fade: Metre | str = ...,
            along: Coordinate = ...,
            type: Literal["band"] = ...,
        ) -> None: ...

    class Bump(_Bump):
        """The slope of a Gaussian bump or hole, felt as its shape: ½ far away, 1 and 0 on its flanks."""
        def __init__(
            self,
            centre: Place | str,
            width: Length | str,
            kind: Literal["bump", "hole"] = ...,
            along: Coordinate = ...,
            type: Literal["bump"] = ...,
        ) -> None: ...

    class SineWave(_SineWave):
        """½ + ½ sin(2πs/spatial_period + phase), s being the coordinate `along`."""
        def __init__(
            self,
            spatial_period: Length | str,
            phase: Radian | str = ...,
            along: Coordinate = ...,
            type: Literal["sine_wave"] = ...,
        ) -> None: ...

    class SquareWave(_SquareWave):
        """1 over the first `duty` of every period, 0 over the rest."""
        def __init__(
            self,
            spatial_period: Length | str,
            duty: Dimensionless | str = ...,
            phase: Radian | str = ...,
            along: Coordinate = ...,
            type: Literal["square_wave"] = ...,
        ) -> None: ...

    class Noise(_Noise):
        """Seeded noise along one coordinate, with nothing finer than `finest_period`."""
        def __init__(
            self,
            finest_period: Metre | str,
            seed: int,
            octaves: int = ...,
            persistence: Dimensionless | str = ...,
            along: Coordinate = ...,
            type: Literal["noise"] = ...,
        ) -> None: ...

    class Image(_Image):
        """Values from 0 to 1 on a grid of square pixels, bilinear between their centres."""
        def __init__(
            self,
            values: tuple[tuple[Share, ...], ...] | str,
            pixel: Metre | str,
            left: Place | str = ...,
            bottom: Place | str = ...,
            outside: Literal["hold", "repeat", "zero"] = ...,
            type: Literal["image"] = ...,
        ) -> None: ...

    class Stroke(_Stroke):
        """A finger's motion along x: `passes` passes of `length` at constant `speed`, turning at once."""
        def __init__(
            self,
            speed: MetrePerSecond | str,
            length: Metre | str = ...,
            passes: int = ...,
            start: Metre | str = ...,
        ) -> None: ...

    def render_texture(
        display: NamedDisplay | str | Path,
        texture: NamedTexture | str | Path,
        motion: NamedMotion | str | Path,
        *,
        voltage: Volt | str | None = ...,
        normal_force: Newton | str | None = ...,
        surface: str | None = ...,
        model: FrictionModel | None = ...,
        place: FacePlace | str | Path | None = ...,
        sensor: str | SensorModel | None = ...,
        compensation: str = ...,
        braking: bool = ...,
        wave: str = ...,
        control_rate: Hertz | str = ...,
        seed: int = ...,
        progress: SayProgress | None = ...,
    ) -> RenderAnalysis:
        """Render a texture on a display under a finger."""
    def play_texture(
        target: str | Path | Display,
        texture: NamedTexture | str | Path,
        *,
        mode: PlayMode = ...,
        rate: Hertz | str = ...,
        voltage: Volt | str | None = ...,
        surface: str | None = ...,
        compensation: LoopCompensation = ...,
        hold: bool = ...,
        drive: str = ...,
        sensor: str = ...,
        stroke: str = ...,
        duration: Second | str = ...,
        amplitude_per_pickup: MetrePerVolt | str | None = ...,
        bench_only: bool = ...,
        sweep: str | Path | None = ...,
        out: str | Path | None = ...,
        seed: int = ...,
        show: Callable[[PlayView], None] | None = ...,
        tap: Callable[[FloatArray], None] | None = ...,
        progress: SayProgress | None = ...,
    ) -> PlayResult:
        """Play a texture on a device or on a twin of the display, in real time, and judge the record."""
    def play(
        display: str | Path,
        surface: Playable | str | Path,
        *,
        drive: str = ...,
        amplitude_per_pickup: MetrePerVolt | str | None = ...,
        stroke: str = ...,
        rate: Hertz | str = ...,
        out: str | Path | None = ...,
        lsl: bool | str = ...,
    ) -> Playback:
        """A handle on a surface that is started and stopped while a program goes on."""
    def fit_recording(
        recording: NamedRecording | str | Path,
        display: NamedDisplay | str | Path | None = ...,
        *,
        progress: SayProgress | None = ...,
    ) -> FitResult:
        """The fit that goes with the kind of a recording: a circuit with an impedance (constants of the"""
    def calibrate_display(
        display: NamedDisplay | str | Path,
        folder: str | Path,
        out: str | Path | None = ...,
        *,
        parameters: Mapping[str, Distribution | None] | None = ...,
        seed: int = ...,
        progress: SayProgress | None = ...,
    ) -> FolderCalibration:
        """A display's uncertain values learned from all recordings of a folder."""
    def predict_measurement(
        display: NamedDisplay | str | Path,
        ask: str | Sequence[str],
        out: str | Path,
        *,
        seed: int = ...,
        progress: SayProgress | None = ...,
    ) -> BlindPrediction:
        """Write what will be measured of a display, with its interval and a SHA-256, before it is."""
    def score_prediction(
        prediction: str | Path,
        folder: str | Path,
        display: NamedDisplay | str | Path,
        *,
        progress: SayProgress | None = ...,
    ) -> tuple[tuple[Score, ...], tuple[str, ...]]:
        """A prediction's file compared with a folder of recordings made since: error, inside its"""
    def fabricate(
        display: NamedDisplay | str | Path,
        *,
        prediction: Prediction | None = ...,
        uncertainty: UncertainFriction | None = ...,
        samples: int = ...,
        intervals: bool = ...,
        blind: BlindPrediction | None = ...,
        seed: int = ...,
        progress: SayProgress | None = ...,
    ) -> Fabrication:
        """Prepare to build a display and to measure it, with what is expected."""
    def plan_study(
        design: NamedDesign | str | Path,
        participants: int = ...,
        seed: int = ...,
        *,
        observer: NamedObserver | str | Path | None = ...,
        reach: bool = ...,
    ) -> StudyPlan:
        """The plan of a design for a number of participants, and what is doubtful of the design."""
    def run_study(
        design: str | Path,
        store: str | Path,
        participant: str | None = ...,
        *,
        drive: str = ...,
        amplitude_per_pickup: MetrePerVolt | str | None = ...,
        conditions: Path | None = ...,
        consent: bool = ...,
        acknowledge: Callable[[str], bool] = ...,
        tell: Callable[[str], None] = ...,
        examiner: Examiner | None = ...,
        seed: int | None = ...,
        station: int | None = ...,
        stations: int | None = ...,
        progress: Callable[[], AbstractContextManager[Callable[[str], None]]] | None = ...,
        by_hand: str = ...,
        lsl: bool | str = ...,
    ) -> str:
        """Run a session of a study; stopped by Ctrl-C, it goes on later where it stopped. Returns how"""
    def simulate_participants(
        design: NamedDesign | str | Path,
        observer: NamedObserver | str | Path,
        participants: int,
        seed: int,
        tables: ChainTables | None = ...,
        progress: Callable[[str], None] | None = ...,
    ) -> SimulatedStudy:
        """Answers of simulated participants to a design."""
    def analyze_study(
        store: StudyStore | str | Path,
        *,
        design: NamedDesign | str | Path | None = ...,
        columns: Mapping[str, str] | None = ...,
        values: Mapping[str, str] | None = ...,
        decimal_comma: bool = ...,
        resamples: int = ...,
        seed: int = ...,
        progress: Tell | None = ...,
    ) -> dict[str, StudyAnalysis]:
        """The analysis of a study's answers, by display."""
    class AdaptiveDesign(_AdaptiveDesign):
        """Start of a Bayesian choice of stimuli."""
        def __init__(
            self,
            stimuli: tuple[float, ...],
            prior: PsychometricPrior,
            shape: Shape = ...,
            axis: Axis = ...,
            guess_rate: Dimensionless | str = ...,
            cells: tuple[int, int, int] = ...,
            interest: Interest = ...,
            most_trials: int = ...,
        ) -> None: ...

    def fit_psychometric(
        intensity: ArrayLike,
        positive: ArrayLike,
        trials: ArrayLike | None = ...,
        *,
        shape: Shape = ...,
        axis: Axis = ...,
        guess_rate: Dimensionless | str | None = ...,
        prior: PsychometricPrior | None = ...,
        level: Dimensionless | str = ...,
    ) -> PsychometricFit:
        """Fit a psychometric function to answers."""
    class PsychometricFunction(_PsychometricFunction):
        """A psychometric function: ψ(x) = γ + (1 − γ − λ) S((x − threshold)/width)."""
        def __init__(
            self,
            shape: Shape,
            threshold: float,
            width: float,
            guess_rate: Dimensionless | str = ...,
            lapse_rate: Dimensionless | str = ...,
            axis: Axis = ...,
        ) -> None: ...

__version__: str
