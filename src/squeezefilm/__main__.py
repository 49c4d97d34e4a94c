"""`python -m squeezefilm` is `squeezefilm`. Nothing is loaded before Ctrl-C can be met."""

from __future__ import annotations

import os
import signal
from typing import NoReturn


def main() -> None:
    """Run the command line; Ctrl-C while it loads ends it with one line and exit code 130."""
    before = signal.getsignal(signal.SIGINT)
    # A shell that starts a program in the background has it ignore SIGINT, and so it stays.
    if before is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end_at_once)
    from squeezefilm.cli import main as run

    signal.signal(signal.SIGINT, before)
    run()


def _end_at_once(*_: object) -> NoReturn:
    # Raised in the middle of an import, an exception may be swallowed or printed by it.
    os.write(2, b"interrupted; nothing half-written was left\n")
    os._exit(130)


if __name__ == "__main__":
    main()
