"""Where a value comes from: text beside the value in the TOML file, kept beside it in memory.

A value in TOML is either plain, ``thickness = "2 mm"``, or a table that says where it comes from:
``thickness = { value = "2 mm", source = "paper, section 3.1", evidence = "published" }``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from squeezefilm.errors import ConfigError

EVIDENCE = ("measured", "published", "derived", "assumed")
_KEYS = {"value", "source", "evidence"}


@dataclass(frozen=True)
class Provenance:
    """The source of one value and the kind of evidence behind it: measured, published, derived
    from published values, or assumed."""

    source: str
    evidence: str = "published"


def split_provenance(tree: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Provenance]]:
    """Separate values from their sources: the tree with plain values, and the sources by path
    (``"actuator.thickness"``). Raises `ConfigError` for a malformed source."""
    found: dict[str, Provenance] = {}

    def walk(node: Any, path: str) -> Any:
        if isinstance(node, Mapping):
            if "value" in node and set(node) <= _KEYS:
                if "source" in node or "evidence" in node:
                    found[path] = _provenance(node, path)
                return node["value"]
            return {key: walk(item, f"{path}.{key}" if path else key) for key, item in node.items()}
        if isinstance(node, list):
            return [walk(item, f"{path}.{index}") for index, item in enumerate(node)]
        return node

    plain = walk(tree, "")
    return plain, found


def _provenance(node: Mapping[str, Any], path: str) -> Provenance:
    source, evidence = node.get("source", ""), node.get("evidence", "published")
    if not isinstance(source, str):
        raise ConfigError(f"source = {source!r} is no text; write where it is from", key=path)
    if evidence not in EVIDENCE:
        raise ConfigError(
            f"evidence = {evidence!r} is not known; allowed: {', '.join(EVIDENCE)}", key=path
        )
    return Provenance(source, evidence)
