"""A function of one record: called with the record's fields, and so described."""

import inspect
import typing
from dataclasses import KW_ONLY, dataclass

import pytest

from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.quantities import Metre


@dataclass(frozen=True, slots=True)
class Asked:
    """A word, and how long it is."""

    word: str
    _: KW_ONLY
    length: Metre = 2e-3


@reads_text
@called_with(Asked)
def answered(asked: Asked) -> tuple[str, Metre]:
    """What reached it."""
    return asked.word, asked.length


def test_the_fields_arrive_and_text_is_read_where_they_have_a_unit() -> None:
    assert answered("a") == ("a", 2e-3)
    assert answered(word="a", length=1.0) == ("a", 1.0)
    assert answered("3 mm", length="3 mm") == ("3 mm", 3e-3)  # type: ignore[arg-type]


def test_it_is_described_as_if_it_had_these_arguments() -> None:
    given = inspect.signature(answered)
    assert list(given.parameters) == ["word", "length"]
    assert given.parameters["length"].default == 2e-3
    assert given.parameters["length"].kind is inspect.Parameter.KEYWORD_ONLY
    hints = typing.get_type_hints(answered, include_extras=True)
    assert hints == {"word": str, "length": Metre, "return": tuple[str, Metre]}
    assert (answered.__name__, answered.__doc__) == ("answered", "What reached it.")


def test_a_wrong_call_is_told_of_by_the_functions_name() -> None:
    with pytest.raises(TypeError, match=r"answered\(\) got an unexpected .* 'lengths'"):
        answered("a", lengths=1.0)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match=r"answered\(\) missing 1 required positional argument"):
        answered()  # type: ignore[call-arg]
