"""A table of this program as another program reads it from Parquet."""

from __future__ import annotations

import io
import json

import pytest

from squeezefilm.core.formats.traces import Table


def table_in_parquet(data: bytes) -> Table:
    """The columns and the metadata in the bytes of a Parquet file."""
    parquet = pytest.importorskip("pyarrow.parquet")
    held = parquet.read_table(io.BytesIO(data))
    columns = {name: held.column(name).to_numpy().astype(float) for name in held.column_names}
    return Table(columns, json.loads(held.schema.metadata[b"squeezefilm"]))
