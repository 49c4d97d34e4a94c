"""Solved state of many megabytes: left out of a pickle, and solved again where it is asked for."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar

_SOLVING = threading.RLock()


class SolvedAgain:
    """A result whose `_bulk` attributes stay behind when it is pickled or copied.

    `_again` solves for the same result; it is called at the first use of what stayed behind, and
    takes as long as it took the first time. Without `_again` all is pickled.
    """

    _bulk: ClassVar[tuple[str, ...]] = ()
    _again: Callable[[], Any] | None

    def __getstate__(self) -> dict[str, Any]:
        if self._again is None:
            return dict(vars(self))
        return {name: value for name, value in vars(self).items() if name not in self._bulk}

    if not TYPE_CHECKING:  # A checker would take any misspelt name for one of these.

        def __getattr__(self, name: str) -> Any:
            again = vars(self).get("_again")
            if name not in self._bulk or again is None:
                raise AttributeError(f"{type(self).__name__} has no attribute '{name}'")
            with _SOLVING:
                if name not in vars(self):
                    whole = again()
                    vars(self).update({bulky: getattr(whole, bulky) for bulky in self._bulk})
            return vars(self)[name]
