"""Arrays and plain records as bytes, and back, without pickle.

A file holds numbers, texts and arrays in their order, and no name of a class or a function: what is
made of them says the type that the reader asks for, down to the annotations of its fields. So a
file can give a wrong number, and run nothing.
"""

from __future__ import annotations

import functools
import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

_DTYPES = {name: np.dtype(name) for name in ("<f8", "<c16", "<i8", "|b1")}


def packed(value: Any, given: Sequence[Any] = ()) -> bytes:
    """A value as bytes: None, numbers, texts, arrays, and tuples, lists, mappings of texts and
    dataclasses of such. A record that stands in it several times is written once, and those that
    whoever reads it has anyway, the `given`, are not.

    Raises `TypeError` for anything else.
    """
    writer = _Writer(given)
    head = json.dumps(writer.plain(value), separators=(",", ":")).encode()
    return b"\n".join([head, b"".join(writer.arrays)])


def unpacked(data: bytes, kind: Any, given: Sequence[Any] = ()) -> Any:
    """The value of type `kind` that `packed` made bytes of, with the same `given`.

    Raises `ValueError`, `TypeError`, `IndexError` or `RecursionError` where bytes are of nothing of
    that type, and what its dataclasses raise of values that they refuse.
    """
    head, _, arrays = data.partition(b"\n")
    return _Reader(arrays, given).value(json.loads(head), kind)


class _Writer:
    def __init__(self, given: Sequence[Any]) -> None:
        self.arrays: list[bytes] = []
        self._given = given
        # The records themselves, too: a number is another's once its own is gone.
        self._known = {id(record): (number, record) for number, record in enumerate(given)}

    def plain(self, value: Any) -> Any:
        """A value as JSON has it; arrays go to `arrays`."""
        if value is None or isinstance(value, bool | int | float | str):
            return value
        if isinstance(value, np.ndarray):
            return self._array(value)
        if isinstance(value, tuple | list):
            return [self.plain(part) for part in value]
        if isinstance(value, Mapping):
            return {key: self.plain(part) for key, part in value.items()}
        if is_dataclass(value) and not isinstance(value, type):
            return self._record(value)
        raise TypeError(f"a {type(value).__name__} is no number, text, array or record of such")

    def _array(self, value: NDArray[Any]) -> list[Any]:
        dtype = value.dtype.newbyteorder("<")
        if dtype.str not in _DTYPES:
            raise TypeError(f"an array of {value.dtype} is not kept")
        # The order in memory decides the last digit of a product.
        order: Literal["C", "F"] = "C" if value.flags.c_contiguous else "F"
        self.arrays.append(value.astype(dtype).tobytes(order))
        return [dtype.str, list(value.shape), order]

    def _record(self, value: Any) -> Any:
        for record in self._given:
            if type(record) is type(value) and record == value:
                return self._known[id(record)][0]
        if id(value) not in self._known:
            told = [self.plain(getattr(value, field.name)) for field in fields(value)]
            self._known[id(value)] = len(self._known), value
            return told
        return self._known[id(value)][0]


class _Reader:
    def __init__(self, arrays: bytes, given: Sequence[Any]) -> None:
        self._arrays, self._at = arrays, 0
        self._known = list(given)

    def value(self, told: Any, kind: Any) -> Any:
        """A value of a type from what JSON has."""
        origin, args = get_origin(kind), get_args(kind)
        if origin in (Union, UnionType):
            if told is None and NoneType in args:
                return None
            (kind,) = (argument for argument in args if argument is not NoneType)
            return self.value(told, kind)
        if origin is Literal and told in args:
            return told
        if origin is np.ndarray:
            return self._array(told, get_args(args[1])[0])
        if origin in (tuple, list) and isinstance(told, list):
            if origin is list or args[1:] == (...,):
                args = (args[0],) * len(told)
            return origin(
                self.value(part, argument) for part, argument in zip(told, args, strict=True)
            )
        if origin in (dict, Counter) and isinstance(told, dict):
            inner = args[1] if origin is dict else int
            return origin({key: self.value(part, inner) for key, part in told.items()})
        if is_dataclass(kind) and isinstance(kind, type):
            return self._record(told, kind)
        if type(told) is kind:
            return told
        if kind is float and type(told) is int:
            return float(told)
        raise TypeError(f"{told!r:.40} is no {kind}")

    def _array(self, told: Any, scalar: type) -> NDArray[Any]:
        name, shape, order = told
        dtype = _DTYPES[name]
        if not np.issubdtype(dtype, scalar) or any(size < 0 for size in shape):
            raise TypeError(f"an array of {name} and shape {shape} is not asked for")
        count = math.prod(shape)
        array = np.frombuffer(self._arrays, dtype, count, self._at)
        self._at += count * dtype.itemsize
        # Of this machine's own byte order, and in memory that is aligned and can be written to.
        return np.array(array.reshape(shape, order=order), dtype.newbyteorder("="), order="K")

    def _record(self, told: Any, kind: type) -> Any:
        if type(told) is int:
            known = self._known[told]
            if type(known) is not kind:
                raise TypeError(f"record {told} is no {kind.__name__}")
            return known
        wanted = _fields(kind)
        parts = zip(wanted.items(), told, strict=True)
        record = kind(**{name: self.value(part, one) for (name, one), part in parts})
        self._known.append(record)
        return record


@functools.cache
def _fields(kind: type) -> dict[str, Any]:
    """The types of a dataclass's fields by name, in order."""
    hints = get_type_hints(kind)
    return {field.name: hints[field.name] for field in fields(kind)}
