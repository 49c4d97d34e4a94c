"""Tasks that count themselves: each writes a line where it begins and one where it ends."""

import os
import time
from collections import Counter
from pathlib import Path


def counted(folder: Path, number: int, seconds: float = 0.0) -> int:
    """The square of a number, after so many seconds."""
    _line(folder / "begun", number)
    time.sleep(seconds)
    _line(folder / "ended", number)
    return number * number


def held(folder: Path, number: int, most: int) -> int:
    """As `counted`, but where so many have ended it waits for a file `go`: whoever is killed in
    the meantime is at one task, and has sent the answers of the others."""
    _line(folder / "begun", number)
    if lines(folder, "ended").total() >= most:
        while not (folder / "go").exists():
            time.sleep(0.01)
    _line(folder / "ended", number)
    return number * number


def deadly(folder: Path, number: int) -> int:
    """As `counted`, but the process that is at 13 dies."""
    _line(folder / "begun", number)
    if number == 13:
        os._exit(1)
    return number * number


def refused(number: int) -> int:
    """Raises of 3."""
    if number == 3:
        raise ZeroDivisionError("by three")
    return number


def whose(number: int, seconds: float = 0.0) -> tuple[int, int]:
    """Which process answered, after so many seconds."""
    time.sleep(seconds)
    return number, os.getpid()


def busy(seconds: float) -> int:
    """Computes for so many seconds of this process's own time; how many rounds it made."""
    rounds, ends = 0, time.process_time() + seconds
    while time.process_time() < ends:
        rounds += sum(range(1000)) > 0
    return rounds


def lines(folder: Path, name: str) -> Counter[int]:
    """How often each number stands in a file; of a process killed while it wrote, what is whole."""
    file = folder / name
    return (
        Counter(int(one) for one in file.read_text().splitlines()) if file.exists() else Counter()
    )


def _line(file: Path, number: int) -> None:
    # One write: lines of several processes do not mix.
    handle = os.open(file, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    os.write(handle, f"{number}\n".encode())
    os.close(handle)
