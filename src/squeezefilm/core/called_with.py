"""Arguments that travel together: a function of one record, called with the record's fields.

Verbs need it while `--help` is printed, which loads no numpy: it imports nothing of the package.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import ParamSpec, TypeVar

_Fields = ParamSpec("_Fields")
_Record = TypeVar("_Record")
_Answer = TypeVar("_Answer")


def called_with(
    record: Callable[_Fields, _Record],
) -> Callable[[Callable[[_Record], _Answer]], Callable[_Fields, _Answer]]:
    """Let a function that takes one `record`, a dataclass, be called with the record's fields.

    The signature is the record's: names, order, defaults and annotations.
    """

    def decorated(function: Callable[[_Record], _Answer]) -> Callable[_Fields, _Answer]:
        @functools.wraps(function)
        def called(*args: _Fields.args, **kwargs: _Fields.kwargs) -> _Answer:
            return function(record(*args, **kwargs))

        fields, back = inspect.signature(record), function.__annotations__["return"]
        called.__annotations__ = {
            **{name: parameter.annotation for name, parameter in fields.parameters.items()},
            "return": back,
        }
        vars(called)["__signature__"] = fields.replace(return_annotation=back)
        # By whose own modules its annotations are read.
        vars(called)["record"] = record
        # So that Python tells of a wrong call by the name of what was called.
        vars(record)["__init__"].__qualname__ = function.__qualname__
        return called

    return decorated
