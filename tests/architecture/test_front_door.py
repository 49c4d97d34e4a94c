"""The front door: its names, what importing it costs, and that text does where a number does."""

import ast
import inspect
import pkgutil
import subprocess
import sys
import typing
from pathlib import Path
from typing import Any

import pytest

import front_door_stub
import squeezefilm as sf
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import QuantityError
from squeezefilm.core.quantities import format_quantity, unit_of

NAMES = (
    "AdaptiveDesign",
    "Amplitude",
    "Band",
    "BayesianAdaptive",
    "Bump",
    "Image",
    "Noise",
    "PsychometricFunction",
    "PsychometricPrior",
    "RelativeFriction",
    "SineWave",
    "SquareWave",
    "SqueezefilmError",
    "Stroke",
    "analyze",
    "analyze_friction",
    "analyze_study",
    "calibrate_display",
    "check_recording",
    "display_names",
    "fabricate",
    "fit_psychometric",
    "fit_recording",
    "list_modes",
    "load_display",
    "load_texture",
    "materials",
    "plan_study",
    "play",
    "play_texture",
    "plot",
    "predict",
    "predict_grid",
    "predict_measurement",
    "read_recording",
    "read_trace",
    "render_texture",
    "replaced",
    "run_study",
    "save_display",
    "save_texture",
    "score_prediction",
    "search_designs",
    "simulate_participants",
    "solve_film",
    "solve_plate",
    "speed",
    "study_names",
    "sweep",
    "texture_names",
    "voltage_for_friction",
    "with_finger",
    "write_mode",
    "write_report",
)


def test_the_names_are_these_and_each_is_what_its_module_calls_so() -> None:
    assert tuple(sf.__all__) == NAMES
    assert 25 <= len(NAMES) <= 55
    for name in NAMES:
        assert name in dir(sf)
        found = getattr(sf, name)
        assert getattr(found, "__name__", name) == name


def test_a_name_that_is_not_there_is_refused_with_those_there_are() -> None:
    with pytest.raises(
        AttributeError, match=r"no 'predicts'\. Did you mean 'predict'\? It has: Ada"
    ):
        _ = sf.predicts  # type: ignore[attr-defined]


def test_no_name_hides_a_room() -> None:
    # Importing squeezefilm.physics.film puts the module `film` where a function of that name would
    # be.
    assert not {one.name for one in pkgutil.iter_modules(sf.__path__)} & set(NAMES)


def said(text: str) -> set[str]:
    """What a stub says, however it is set."""
    nodes = list(ast.walk(ast.parse(text)))
    return {
        ast.dump(node) for node in nodes if isinstance(node, ast.FunctionDef | ast.ClassDef)
    } | {
        f"{node.module} {one.name} {one.asname}"
        for node in nodes
        if isinstance(node, ast.ImportFrom)
        for one in node.names
    }


def test_the_stub_is_as_its_tool_writes_it_and_says_what_is_loaded() -> None:
    assert sf.__file__ is not None
    stub = Path(sf.__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    assert said(stub) == said(front_door_stub.stub()), "run python tools/front_door_stub.py"
    named = [
        getattr(node, "asname", None) or getattr(node, "name", None)
        for node in ast.walk(ast.parse(stub))
    ]
    assert set(named).issuperset(NAMES)


TYPED = """\
import squeezefilm as sf

amplitude: float = sf.predict("biet2008-plate", voltage="15 V").vibration_amplitude
texture = sf.RelativeFriction(sf.SquareWave("2 mm"), 0.5, 1.0)
sf.render_texture("biet2008-plate", texture, sf.Stroke("80 mm/s", length="40 mm", passes=2))
volts: float = sf.voltage_for_friction(sf.load_display("biet2008-plate"), 0.7)[0]
sf.solve_plate("plate.toml", band=("20 kHz", "40 kHz"))
sf.predict("biet2008-plate", voltage=b"15")
sf.predict("biet2008-plate", volts="15 V")
"""


@pytest.mark.slow
def test_a_type_checker_takes_text_where_the_program_does_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "typed.py").write_text(TYPED, encoding="utf-8")
    # Beside the whole source, with its options: what `make types` has read is read from its cache.
    command = [sys.executable, "-m", "mypy", str(tmp_path / "typed.py")]
    done = subprocess.run(
        command, cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False
    )
    complaints = [line for line in done.stdout.splitlines() if ": error: " in line]
    assert [line.split(":")[1] for line in complaints] == ["8", "9"], done.stdout + done.stderr


def test_importing_it_imports_nothing_and_asking_for_a_name_only_what_that_needs() -> None:
    code = (
        "import sys; before = set(sys.modules); import squeezefilm as sf; "
        "assert set(sys.modules) - before == {'squeezefilm'}, set(sys.modules) - before; "
        "sf.display_names(); "
        "heavy = {'scipy', 'numba', 'matplotlib', 'pydantic'} & set(sys.modules); "
        "assert not heavy, heavy"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def _hints(name: str) -> tuple[Any, dict[str, Any]]:
    """What is called, and the annotations of its parameters."""
    found = getattr(sf, name)
    called = found.__init__ if inspect.isclass(found) else found
    given = inspect.signature(called).parameters
    hints = typing.get_type_hints(getattr(found, "record", found), include_extras=True)
    return called, {key: hint for key, hint in hints.items() if key in given}


# Annotations that only a type checker can read, and no quantity among them.
UNREAD = {"plot", "write_mode", "write_report"}
CALLED = [
    name
    for name in NAMES
    if name not in UNREAD
    and (inspect.isclass(getattr(sf, name)) or callable(getattr(sf, name)))
    and not (inspect.isclass(getattr(sf, name)) and issubclass(getattr(sf, name), Exception))
]
WITH_UNITS = [
    (name, key)
    for name in CALLED
    for key, hint in _hints(name)[1].items()
    if unit_of(hint) is not None
]


@pytest.mark.parametrize(("name", "key"), WITH_UNITS)
def test_every_quantity_of_the_door_may_be_text(name: str, key: str) -> None:
    called, hints = _hints(name)
    assert hasattr(called, "__wrapped__"), f"{name} has a quantity and does not read text"
    unit = unit_of(hints[key])
    assert unit is not None

    def taken(**given: Any) -> Any:
        return given[key]

    # The same annotation on a function that gives back what reached it.
    taken.__annotations__ = {key: hints[key]}
    taken.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY)]
    )
    reads = reads_text(taken)
    assert reads(**{key: format_quantity(0.25, unit, 17)}) == 0.25
    assert reads(**{key: 0.25}) == 0.25
    with pytest.raises(QuantityError, match=f"^{key}: '3 kg\\*m7' has the wrong dimension"):
        reads(**{key: "3 kg*m7"})


def test_there_are_quantities_to_read() -> None:
    assert len(WITH_UNITS) > 40
    assert {name for name, _ in WITH_UNITS} >= {"predict", "Stroke", "SquareWave", "play_texture"}


EQUAL = {
    "SquareWave": (
        lambda q: sf.SquareWave(q("2 mm", 2e-3), q("40 %", 0.4), phase=q("90 deg", None))
    ),
    "SineWave": (lambda q: sf.SineWave(q("2 mm", 2e-3))),
    "Noise": (lambda q: sf.Noise(q("1 mm", 1e-3), seed=3)),
    "Band": (lambda q: sf.Band(q("1 mm", 1e-3), q("4 cm", 0.04), fade=q("100 um", 1e-4))),
    "Bump": (lambda q: sf.Bump(q("30 mm", 0.03), q("2 mm", 2e-3))),
    "Image": (lambda q: sf.Image(((0.0, 1.0),), q("0.1 mm", 1e-4))),
    "Amplitude": (lambda q: sf.Amplitude(sf.SineWave(1e-3), q("0 um", 0.0), q("1.5 um", 1.5e-6))),
    "RelativeFriction": (lambda q: sf.RelativeFriction(sf.SineWave(1e-3), q("60 %", 0.6), 1.0)),
    "constant": (lambda q: sf.Amplitude.constant(q("1 um", 1e-6))),
    "then": (
        lambda q: sf.Amplitude.constant(0.0).then(sf.Amplitude.constant(1e-6), q("2 cm", 0.02))
    ),
    "speed": (lambda q: sf.speed > q("5 mm/s", 5e-3)),
    "Stroke": (lambda q: sf.Stroke(q("60 mm/s", 0.06), q("4 cm", 0.04), start=q("1 mm", 1e-3))),
    "PsychometricFunction": (
        lambda q: sf.PsychometricFunction("logistic", 1.0, 0.5, q("50 %", 0.5))
    ),
}
RIGHT_ANGLE = 1.5707963267948966


@pytest.mark.parametrize("name", EQUAL)
def test_what_is_made_of_text_equals_what_is_made_of_numbers(name: str) -> None:
    make = EQUAL[name]
    number = make(lambda _, value: RIGHT_ANGLE if value is None else value)
    assert make(lambda text, _: text) == number
    with pytest.raises(QuantityError, match="has the wrong dimension"):
        make(lambda text, _: "3 V")


@pytest.mark.slow
def test_a_display_may_be_given_by_its_name_and_a_prediction_asked_in_words() -> None:
    asked = {"model": "paper2008", "vibration_amplitude": "2 um", "normal_force": "0.5 N"}
    by_text = sf.predict("biet2008-stator", **asked)
    by_number = sf.predict(
        sf.load_display("biet2008-stator"),
        model="paper2008",
        vibration_amplitude=2e-6,
        normal_force=0.5,
    )
    assert by_text.to_dict() == by_number.to_dict()
    with pytest.raises(QuantityError, match=r"^voltage: '2 mm' has the wrong dimension: .* of V"):
        sf.predict("biet2008-stator", voltage="2 mm")
    with pytest.raises(sf.SqueezefilmError, match="Did you mean 'biet2008-stator'"):
        sf.predict("biet2008-stater")


def test_other_values_in_a_display() -> None:
    thin = sf.replaced("biet2008-plate", {"actuator.thickness": "1.5 mm", "drive.voltage": 9.0})
    assert (thin.actuator.thickness, thin.drive.voltage) == (1.5e-3, 9.0)
    with pytest.raises(sf.SqueezefilmError, match=r"no 'thicknes'\. Did you mean 'thickness'"):
        sf.replaced(thin, {"actuator.thicknes": "1 mm"})
    with pytest.raises(sf.SqueezefilmError, match="is no number"):
        sf.replaced(thin, {"actuator.ceramic": 1.0})
    with pytest.raises(QuantityError, match="wrong dimension"):
        sf.replaced(thin, {"actuator.thickness": "1 V"})
