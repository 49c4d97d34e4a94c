"""The one exception tree of squeezefilm, and its warnings.

Every message answers three questions: what was asked (with value and unit), what is allowed,
and what to do about it. `InputError` and its children are the user's to mend: the command line
turns them into one message and exit code 2.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any


class SqueezefilmError(Exception):
    """Anything squeezefilm raises on purpose."""


class InputError(SqueezefilmError, ValueError):
    """A value, a file or a combination of them that cannot be used.

    `quantity` names the argument or field at fault where there is one.
    """

    def __init__(self, message: str, *, quantity: str | None = None) -> None:
        super().__init__(message)
        self.quantity = quantity


class QuantityError(InputError):
    """A text that is no quantity, or a quantity of the wrong dimension."""


class ConfigError(InputError):
    """A configuration that cannot be used: names file, line, column and key where they
    are known."""

    def __init__(
        self,
        message: str,
        *,
        file: str | Path | None = None,
        line: int | None = None,
        column: int | None = None,
        key: str | None = None,
    ) -> None:
        self.message = message
        self.file = None if file is None else str(file)
        self.line = line
        self.column = column
        self.key = key
        super().__init__(str(self), quantity=key)

    def __str__(self) -> str:
        line = None if self.line is None else f"line {self.line}"
        column = None if self.column is None else f"column {self.column}"
        place = ", ".join(part for part in (self.file, line, column) if part)
        parts = [part for part in (place, self.key) if part]
        return ": ".join([*parts, self.message])


@contextlib.contextmanager
def errors_of(file: str | Path) -> Iterator[None]:
    """Let a `ConfigError` that names no file name this one."""
    try:
        yield
    except ConfigError as error:
        error.file = error.file or str(file)
        raise


class MissingPackageError(InputError):
    """A package that is not installed with squeezefilm alone."""


@contextlib.contextmanager
def optional(extra: str, what: str) -> Iterator[None]:
    """Let a failing import say what needs the package and which extra installs it.

    Raises `MissingPackageError`, also for a package whose own library cannot be loaded.
    """
    try:
        yield
    except (ImportError, RuntimeError, OSError) as error:
        raise MissingPackageError(
            f"{what} needs a package that is not installed or cannot be loaded ({error}); "
            f"run: pip install 'squeezefilm[{extra}]'"
        ) from error


class GeometryError(InputError):
    """A layout that cannot be built: overlap, overhang, a closed gap."""


class OutOfRangeError(InputError):
    """A model was asked outside the range in which it holds."""


class ContradictionError(InputError):
    """Data that contradict each other, refused because strictness was asked for."""


class UnreachableError(InputError):
    """A target (an amplitude, a friction) that the device cannot reach."""


class OutOfTimeError(InputError):
    """A solve that would take longer than the budget it was given."""


class ConvergenceError(SqueezefilmError):
    """A solve that did not converge; carries what it had.

    `partial` is the last iterate in the solver's own result type, `residual` its residual norm
    and `iterations` the number of iterations made.
    """

    def __init__(
        self,
        message: str,
        *,
        partial: Any = None,
        residual: float = float("nan"),
        iterations: int = 0,
    ) -> None:
        super().__init__(message)
        self.partial = partial
        self.residual = residual
        self.iterations = iterations


class DeviceError(SqueezefilmError):
    """A device that refused, went silent or vanished; says which command, why and what to do."""


class RefusedError(DeviceError):
    """A command that a device refused; `reason` is the number of its reason on the wire."""

    def __init__(self, message: str, *, reason: int | None = None) -> None:
        super().__init__(message)
        self.reason = reason


class RecordError(SqueezefilmError):
    """A record that cannot be written: a full disk, a file that exists, a folder that refuses."""


class WorkersError(SqueezefilmError):
    """Workers that were to answer cannot be reached or used, or are gone; says what to do."""


class LoopError(SqueezefilmError):
    """A real-time loop that could not start, or that died; says which and what to do."""


class SqueezefilmWarning(UserWarning):
    """Anything squeezefilm warns of."""


class OutOfRangeWarning(SqueezefilmWarning):
    """A model was used outside the range in which it holds, because the caller allowed it."""


class ContradictionWarning(SqueezefilmWarning):
    """Data that contradict each other; the message names both and says which one is used."""
