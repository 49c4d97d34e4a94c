"""Texts that would keep a parser busy are refused before it sees them, by counted work."""

from __future__ import annotations

import itertools
import sys
import tomllib
from typing import Any

import pytest

from squeezefilm.core import presets
from squeezefilm.core.config import load_text
from squeezefilm.core.config import syntax as scanning
from squeezefilm.core.config.syntax import DEEPEST, locate, require_quick_toml
from squeezefilm.core.errors import ConfigError
from squeezefilm.physics.display import Display
from squeezefilm.physics.texture_files.texture_file import texture_from_text

N = 100_000
SLOW = {
    "a header of many parts": "[" + ".".join("a" * N) + "]\nx = 1\n",
    "a header of many quoted parts": "[" + " . ".join(['"a"'] * N) + "]\nx = 1\n",
    "a header of many literal parts": "[" + ".".join(["'a'"] * N) + "]\nx = 1\n",
    "an array of tables' header": "[[" + ".".join("1" * N) + "]]\n",
    "a dotted key": ".".join("a" * N) + " = 1\n",
    "a dotted key in a table of one line": "b = { " + ".".join("a" * N) + " = 1 }\n",
    "brackets": "b = " + "[" * 20_000,
    "braces": "b = " + "{a=" * 20_000,
    "brackets behind five quotes": 'a = ["""x"""", ' + "[" * 500 + "]" * 501,
    "brackets behind five single quotes": "a = ['''x'''', " + "[" * 500 + "]" * 501,
    "brackets behind an escaped quote": 'a = ["x\\"", ' + "[" * 500 + "]" * 501,
    "brackets behind a backslash": 'a = ["x\\\\", ' + "[" * 500 + "]" * 501,
    "keys": "\n".join(f"a{k} = 1" for k in range(N)),
    "keys in one line": "b = {" + ",".join(f"a{k} = 1" for k in range(N)) + "}",
    "tables": "\n".join(f"[a{k}]" for k in range(N)),
    "tables in one line": "a = [" + "{}," * N + "]",
    "comments": "#\n" * N,
    "length": "a = 1" + " " * 4_000_000,
}


@pytest.fixture
def no_parser(monkeypatch: pytest.MonkeyPatch) -> None:
    def parse(*_: Any, **__: Any) -> Any:
        raise AssertionError("the parser saw it")

    monkeypatch.setattr(tomllib, "loads", parse)


@pytest.mark.usefixtures("no_parser")
@pytest.mark.parametrize("kind", SLOW)
def test_what_takes_a_parser_long_is_refused_before_it(kind: str) -> None:
    for read in (lambda text: load_text(Display, text, file="x.toml"), texture_from_text):
        with pytest.raises(ConfigError, match=r"at most|larger"):
            read(SLOW[kind])


@pytest.mark.parametrize("name", [*presets.display_names(), *presets.texture_names()])
def test_presets_are_far_below_the_limits(name: str) -> None:
    file = (
        presets.path(name) if name in presets.display_names() else presets.resolve(name, "texture")
    )
    text = file.read_text(encoding="utf-8")
    require_quick_toml(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scanning, "MOST_LINES", 1000)
        patch.setattr(scanning, "DEEPEST", 20)
        require_quick_toml(text)


def test_what_stands_in_strings_and_comments_is_not_counted() -> None:
    dots, brackets = "." * 2 * DEEPEST, "[" * 2 * DEEPEST
    require_quick_toml(
        f'a = "{dots}\\"{brackets}"\nb = \'{brackets}{dots}\' # {brackets} " {dots}\n'
        f'c = """\n{brackets}"{dots}""{brackets}\\"""{brackets}"""\n'
        f"d = '''\n{brackets}''{dots}'''\n" + f"e = \"'''\" # {brackets}\n"
    )


def test_depth_is_the_one_that_a_parser_makes() -> None:
    deepest = "a = " + "[" * DEEPEST + "]" * DEEPEST
    require_quick_toml(deepest)
    tomllib.loads(deepest)
    with pytest.raises(ConfigError, match=f"nested {DEEPEST + 1} deep"):
        require_quick_toml(deepest.replace("[]", "[[]]"))


@pytest.mark.parametrize(
    "unended", ['a = """' + '\\"""' * N, 'a = """' + '"" ' * N, "a = '''" + "'' " * N, '"' * N,
                "a = '" * N, '\\"' * N, '"\\' * N, '"""\\', '"\\', "''''"],
)  # fmt: skip
def test_the_look_is_linear_in_what_has_no_end(unended: str) -> None:
    # Every quote begins a match, ended or not, so nothing is looked at twice.
    assert not set(scanning._STRING_OR_COMMENT.sub("s", unended)) & set("'\"#")


def test_many_errors_are_counted_and_the_first_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    looked = itertools.count()

    def counted(*arguments: Any) -> int | None:
        next(looked)
        return locate(*arguments)

    # The package names a function so too, which hides the module.
    monkeypatch.setattr(sys.modules["squeezefilm.core.config.load"], "locate", counted)
    with pytest.raises(
        ConfigError, match=r"(?s)30\d\d things are not right.*and \d+ more"
    ) as error:
        load_text(Display, "\n".join(f"a{k} = 1" for k in range(3000)))
    assert str(error.value).count("\n") < 30
    # Each looks through the whole text.
    assert next(looked) < 30


def test_a_line_that_looks_like_a_header_or_key_is_read_in_linear_time() -> None:
    # These took a minute at a thirtieth of the length: within a text, any line may stand.
    for line in ("[" + " " * N, " " * N, "a . " * N, "a" * N, "[[ a" + " " * N):
        assert locate(f'name = """\n{line}\n"""\nother = 1\n', ["other"]) == 4
    assert locate('[ a . "b" ]\n x = 1', ["a", "b", "x"]) == 2
