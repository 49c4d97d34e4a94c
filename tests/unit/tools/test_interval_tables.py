"""The tables of people's intervals and of power are what the campaign found."""

from __future__ import annotations

import interval_tables


def test_the_page_has_the_rows_that_the_campaign_found() -> None:
    page = interval_tables.PAGE.read_text(encoding="utf-8")
    assert interval_tables.written(page) == page
    assert len(interval_tables.power_rows()) >= 4
