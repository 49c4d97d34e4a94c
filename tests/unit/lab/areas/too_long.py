"""What every message of a page holds to: a text longer than its field takes is refused."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from pydantic import ValidationError

if TYPE_CHECKING:
    from .conftest import Talk


def require_refused_if_longer(
    lab: Talk, kind: str, field: str, most: int, others: dict[str, Any]
) -> None:
    """A message takes `most` characters in a field, and not one more."""
    model = lab.model(kind)
    model(id=1, type="t", **others, **{field: "x" * most})
    with pytest.raises(ValidationError, match=f"at most {most} characters"):
        model(id=1, type="t", **others, **{field: "x" * (most + 1)})
