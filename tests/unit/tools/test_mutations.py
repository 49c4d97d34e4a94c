"""The faults that mutants are made of: valid, different, where they should be, drawn by seed."""

import ast
import itertools
from pathlib import Path

import pytest

from mutant_report import counts, interval
from mutation_sites import KINDS
from mutations import Mutant, all_mutants, mutants_of, quantity_names, sample

ROOT = Path(__file__).parents[3]

SOURCE = '''"""A docstring with 3 numbers, 1 < 2."""

from typing import Annotated

_LIMIT: int = 4
_WORDS = "left" + "alone"


def decorated(factor: float = 2.0):
    return lambda function: function


@decorated(3.0)
def means(
    values: list[float], weight: Annotated[float, 5] | None
) -> tuple[float, list[float]]:
    """Docstring: 1 + 1."""
    if not values or weight is None or weight > 1.5:  # a comment with < and or
        raise ValueError(f"{len(values) + 7} values are fewer than {_LIMIT - 1}")
    total = 0.0
    for i in range(len(values)):
        if i >= 9:
            break
        total += (
            values[i]
            * weight  # µ, then more
        )
    _log.info("%d", 8 + 9)
    values[0] = -total
    return total / (len(values) + 1), values[1:]


def steps(count: int):
    yield from range(0, count)
'''


def _mutants(kind: str) -> list[Mutant]:
    return [m for m in mutants_of(SOURCE.encode(), "squeezefilm/film/a.py") if m.site.kind == kind]


def _changes(kind: str) -> set[tuple[str, str]]:
    return {(mutant.before, mutant.site.after) for mutant in _mutants(kind)}


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_yields_valid_code_that_differs_and_keeps_its_lines(kind: str) -> None:
    mutants = _mutants(kind)
    assert mutants
    for mutant in mutants:
        mutated = mutant.applied(SOURCE.encode())
        assert mutant.is_valid(SOURCE.encode()), mutant
        assert mutated.count(b"\n") == SOURCE.count("\n")
        assert ast.dump(ast.parse(mutated)) != ast.dump(ast.parse(SOURCE))
        assert SOURCE.encode()[mutant.site.start : mutant.site.end].decode() == mutant.before


def test_what_is_changed_and_into_what() -> None:
    assert _changes("arithmetic") == {("+=", "-="), ("*", "/"), ("/", "*"), ("+", "-"), ("-", "+")}
    # Only whole numbers are often equal.
    assert _changes("comparison") == {("is", "is not"), (">", "<"), (">=", ">")}
    assert _changes("tie") == {(">", ">=")}
    assert ("or", "and") in _changes("condition")
    test = "not values or weight is None or weight > 1.5"
    assert (test, f"not ({test})") in _changes("condition")
    # A seeded constant, a default; neither an annotation nor a message nor a decorator's argument.
    constants = {("4", "5"), ("2.0", "4.0"), ("0.0", "1.0"), ("1.5", "3.0"), ("1", "2"), ("0", "1")}
    assert _changes("constant") == constants | {("9", "10")}
    assert {("i", "i + 1"), ("0", "1"), ("1", "2"), ("count", "(count) - 1")} <= _changes("index")
    bodies = {mutant.site.function: mutant.site.after for mutant in _mutants("body")}
    assert bodies == {
        "decorated": "return None",
        "means": "return (0.0, [],)",
        "steps": "yield from ()",
    }


def test_messages_logging_and_annotations_are_left_alone() -> None:
    for mutant in mutants_of(SOURCE.encode(), "squeezefilm/film/a.py"):
        if mutant.site.kind not in ("body", "statement"):
            line = SOURCE.splitlines()[mutant.line - 1]
            assert not any(word in line for word in ("_log", "fewer", "Annotated[", "alone"))
    deleted = {before.split("(")[0].strip() for before, _ in _changes("statement")}
    assert deleted == {
        "raise ValueError",
        "break",
        "total +=",
        "values[0] = -total",
        "yield from range",
    }


def test_a_body_that_does_nothing_is_no_mutant() -> None:
    hollow = b"def f():\n    '''Only said.'''\n\ndef g():\n    raise NotImplementedError\n"
    assert [m for m in mutants_of(hollow, "squeezefilm/a.py") if m.site.kind == "body"] == []
    same = mutants_of(b"def f(a: int) -> int:\n    return a\n", "squeezefilm/a.py")
    assert [m.is_valid(b"def f(a: int) -> int:\n    return a\n") for m in same] == [False]


def test_quantities_are_floats() -> None:
    assert quantity_names(b"Metre = Annotated[float, Unit('m')]\nCount = int\n") == ["Metre"]
    source = b"def f() -> Metre:\n    return 2.0 * 3.0\n"
    bodies = [m for m in mutants_of(source, "squeezefilm/a.py", ["Metre"]) if m.site.kind == "body"]
    assert bodies[0].site.after == "return 0.0"


def test_identities_outlast_edits_elsewhere() -> None:
    before = {m.id for m in mutants_of(SOURCE.encode(), "squeezefilm/film/a.py")}
    longer = SOURCE.replace("_LIMIT: int = 4", "_MORE = set()\n\n_LIMIT: int = 4")
    after = {m.id for m in mutants_of(longer.encode(), "squeezefilm/film/a.py")}
    assert before <= after
    assert len(before) == len(mutants_of(SOURCE.encode(), "squeezefilm/film/a.py"))


def test_a_seed_draws_the_same_sample_and_a_longer_one_begins_with_it() -> None:
    mutants = all_mutants(ROOT / "src", ["actuators", "cli"])
    assert {mutant.room for mutant in mutants} == {"actuators", "cli"}

    def drawn(seed: int, count: int) -> list[str]:
        return [m.id for m in itertools.islice(sample(reversed(mutants), seed), count)]

    assert drawn(1, 40) == drawn(1, 40)
    assert drawn(1, 60)[:40] == drawn(1, 40)
    assert drawn(1, 40) != drawn(2, 40)
    kinds = [m.site.kind for m in itertools.islice(sample(mutants, 1), 2 * len(KINDS))]
    assert kinds == [*KINDS, *KINDS]


def test_equivalent_mutants_do_not_count() -> None:
    lines = [
        {"id": "a", "noticed": True, "marks": "not realtime and not nightly"},
        {"id": "b", "noticed": True, "marks": "nightly"},
        {"id": "c", "noticed": False, "marks": ""},
        {"id": "d", "noticed": False, "marks": ""},
    ]
    assert counts(lines, {"c": "changes nothing"}) == {
        "drawn": 4,
        "equivalent": 1,
        "counted": 3,
        "make test": 1,
        "noticed": 2,
    }
    # Wilson (1927), as in any table: 8 of 10.
    assert interval(8, 10) == pytest.approx((0.4902, 0.9433), abs=1e-4)
