"""What every message of a page holds to: a text longer than its field takes is refused."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError


def require_refused_if_longer(model: Any, field: str, most: int, others: dict[str, Any]) -> None:
    """A message takes `most` characters in a field, and not one more."""
    model(id=1, type="t", **others, **{field: "x" * most})
    with pytest.raises(ValidationError, match=f"at most {most} characters"):
        model(id=1, type="t", **others, **{field: "x" * (most + 1)})
