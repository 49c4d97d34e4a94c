"""The tables of psychometric intervals are what the campaign found, and what was promised."""

from __future__ import annotations

import interval_tables


def test_the_page_has_the_rows_that_the_campaign_found() -> None:
    page = interval_tables.PAGE.read_text(encoding="utf-8")
    assert interval_tables.written(page) == page
    assert len(interval_tables.interval_rows()) >= 4
    assert len(interval_tables.power_rows()) >= 4


def test_what_the_campaign_found_is_as_promised() -> None:
    """Intervals that ask again hold every parameter as often as they say; with fewer than the 500
    runs of the requirement, within 4 standard errors."""
    for (name, kind), (runs, of) in interval_tables.coverages().items():
        if kind != "asked again":
            continue
        reach = 0.025 if runs >= 500 else 4 * (0.95 * 0.05 / runs) ** 0.5
        for parameter, (share, _) in of.items():
            assert abs(share - 0.95) <= reach, (name, parameter)
