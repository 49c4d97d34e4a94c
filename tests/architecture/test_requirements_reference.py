"""The reference of requirements names every key that a file may have, and its defaults truly."""

import dataclasses
import re
import typing
from pathlib import Path
from typing import Any

import pytest

from squeezefilm.core import config
from squeezefilm.core.quantities import format_quantity, unit_of
from squeezefilm.design.search import requirements as wanted
from squeezefilm.design.search import shapes, stock
from squeezefilm.physics.plate.layout import GlueLayer

DOCS = Path(__file__).parents[2] / "docs"
TEXT = (DOCS / "reference" / "requirements.md").read_text(encoding="utf-8")
OWNERS = (
    wanted.Requirements, wanted.Workspace, wanted.AskedTouch, wanted.Source, wanted.Limits,
    wanted.Tolerances, shapes.Strips, shapes.EdgeStrips, shapes.Disc, shapes.Ring, shapes.Gasket,
    stock.StockSheet, stock.CeramicStock, GlueLayer,
)  # fmt: skip


@pytest.mark.parametrize("owner", OWNERS, ids=lambda owner: owner.__name__)
def test_every_key_is_named(owner: Any) -> None:
    named = set(re.findall(r"`([a-z_0-9]+)`", TEXT)) | set(re.findall(r"\[([a-z_.]+)\]", TEXT))
    tables = {one.rpartition(".")[2] for one in named}
    for field in dataclasses.fields(owner):
        assert field.name in named | tables, field.name


def test_tolerances_have_their_defaults() -> None:
    table = TEXT.partition("## How well it is made")[2]
    hints = typing.get_type_hints(wanted.Tolerances, include_extras=True)
    for field in dataclasses.fields(wanted.Tolerances):
        row = re.search(rf"^\| `{field.name}` \|.*\| (.*) \|$", table, re.MULTILINE)
        unit = unit_of(hints[field.name])
        assert row is not None
        assert unit is not None
        assert row[1] == format_quantity(field.default, unit)  # type: ignore[arg-type]


def test_the_file_of_the_how_to_is_one() -> None:
    page = (DOCS / "how-to" / "design.md").read_text(encoding="utf-8")
    found = re.search(r'^```toml title="mine.toml"\n(.*?)^```', page, re.MULTILINE | re.DOTALL)
    assert found is not None
    read = config.load_text(wanted.Requirements, found[1])
    assert read.name == "mine"
    assert [one.shape for one in read.spaces] == ["strips on one face"]
