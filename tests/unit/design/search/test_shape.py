from __future__ import annotations

import pytest
from tests.unit.design.search.made_up import requirements

from squeezefilm.core.errors import InputError
from squeezefilm.design.search.shapes import Strips
from squeezefilm.design.search.stock import OWN, CeramicStock, StockSheet, counts

SHEET, CERAMIC = StockSheet(OWN, (1e-3,)), CeramicStock(OWN, (5e-4,))


def test_a_shape_without_stock_is_refused() -> None:
    with pytest.raises(InputError, match="sheets is empty"):
        Strips((), (CERAMIC,), 5, 9)
    with pytest.raises(InputError, match="ceramics is empty"):
        Strips((SHEET,), (), 5, 9)
    with pytest.raises(InputError, match="names a material twice"):
        Strips((SHEET, SHEET), (CERAMIC,), 5, 9)
    with pytest.raises(InputError, match="there is no material 'unobtainium'"):
        Strips((StockSheet("unobtainium", (1e-3,)),), (CERAMIC,), 5, 9)


def test_counts_are_all_from_least_to_most() -> None:
    found = counts("nodal_lines", 5, 8)
    assert [found.at(share, {}) for share in (0.0, 0.3, 0.6, 1.0)] == [5.0, 6.0, 7.0, 8.0]


def test_the_class_of_cost_is_that_of_the_dearest_part() -> None:
    wanted = requirements()
    shape, space = wanted.shapes[0], wanted.spaces[0]
    cheap = space.at({one.name: 0.0 for one in space.free})
    dear = space.at({one.name: 0.9 for one in space.free})
    assert (shape.cost_class(cheap), shape.cost_class(dear)) == (1, 2)
