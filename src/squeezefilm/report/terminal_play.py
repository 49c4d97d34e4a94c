"""What the terminal shows of a device and of a session that plays on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.report.terminal import plain_console

if TYPE_CHECKING:
    from squeezefilm.session.export import TraceExport


def show_export(done: TraceExport) -> None:
    """Print what was exported, and what the trace had lost."""
    console = plain_console()
    console.print(
        f"{done.to}: {done.rows} rows of {len(done.columns)} columns, {done.events} events"
    )
    for sentence in done.damage:
        console.print(f"! {sentence}")
