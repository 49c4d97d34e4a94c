"""What is asked of the package checks its numbers as it is made; what the package found need not.

A record that is an input is called so: a name that ends in Request, Options, Requirements,
Description or Settings. The rows of the command line's options are checked by the command line.
"""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import math
import pkgutil
from collections.abc import Iterator
from typing import Any

import pytest

import squeezefilm
from squeezefilm.core.errors import InputError

from .public_calls import annotations_of, is_number

INPUTS = ("Request", "Options", "Requirements", "Description", "Settings")


def _inputs() -> Iterator[tuple[str, type[Any], list[str]]]:
    for module in pkgutil.walk_packages(squeezefilm.__path__, "squeezefilm."):
        if module.name.startswith("squeezefilm.cli") or module.name.endswith("__main__"):
            continue
        home = importlib.import_module(module.name)
        for key, item in vars(home).items():
            if getattr(item, "__module__", None) != module.name or not key.endswith(INPUTS):
                continue
            if inspect.isclass(item) and dataclasses.is_dataclass(item):
                hints = annotations_of(item.__init__, home, item)
                yield key, item, [name for name, hint in hints.items() if is_number(hint)]


FOUND = [(key, item, numbers) for key, item, numbers in _inputs() if numbers]


@pytest.mark.parametrize(("item", "numbers"), [row[1:] for row in FOUND], ids=[r[0] for r in FOUND])
def test_an_input_refuses_what_is_no_finite_number(item: type[Any], numbers: list[str]) -> None:
    others = {
        field.name: None
        for field in dataclasses.fields(item)
        if field.init
        and field.default is dataclasses.MISSING
        and field.default_factory is dataclasses.MISSING
    }
    for number in numbers:
        for wrong in (math.nan, math.inf, "2 um", [[1.0], [1.0, 2.0]], object()):
            with pytest.raises(InputError, match=number):
                item(**{**others, number: wrong})
