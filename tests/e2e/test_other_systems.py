"""What must run where POSIX's modules are not, as on Windows: simulated by taking them away."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path, PureWindowsPath

import pytest

from squeezefilm.core import presets
from squeezefilm.lab.server import is_named

WITHOUT_POSIX = """
import builtins, importlib, os, pkgutil, select, signal, sys

GONE = {"tty", "pty", "termios", "fcntl", "resource", "grp", "pwd", "curses", "readline", "posix"}
find = builtins.__import__

def no_posix(name, globals=None, locals=None, fromlist=(), level=0):
    ours = str((globals or {}).get("__name__", "")).startswith("squeezefilm")
    if ours and name.partition(".")[0] in GONE:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    return find(name, globals, locals, fromlist, level)

builtins.__import__ = no_posix
import asyncio, multiprocessing.popen_spawn_posix, subprocess  # They need what is taken away now.
for owner, names in {
    os: "openpty ttyname fork forkpty killpg setsid getpgid getuid geteuid mkfifo fchmod fchown "
        "sched_setscheduler sched_getscheduler sched_param SCHED_FIFO SCHED_OTHER "
        "sched_setaffinity sched_getaffinity O_NOFOLLOW O_DIRECTORY O_CLOEXEC statvfs "
        "sysconf nice wait4",
    signal: "SIGHUP SIGALRM SIGUSR1 SIGUSR2 setitimer pthread_sigmask sigwait",
    select: "poll",
}.items():
    for name in names.split():
        if hasattr(owner, name):
            delattr(owner, name)

import squeezefilm
"""

IMPORTS = """
# A launcher of the real-time loop is read by it alone.
for one in pkgutil.walk_packages(squeezefilm.__path__, "squeezefilm."):
    if not one.name.endswith("__main__"):
        importlib.import_module(one.name)
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.twin.pty_server import running_twin
try:
    with running_twin("biet2008-plate"):
        raise SystemExit("a twin started")
except InputError as error:
    assert "pseudo-terminal" in str(error)
"""

VERBS = """
from squeezefilm.cli import main
def run(*words):
    sys.argv = ["squeezefilm", *words]
    try:
        main()
    except SystemExit as end:
        assert not end.code, (words, end.code)
"""

ANALYSES = """
run("analyze", "biet2008-stator", "--out", "analysis")
run("render", TEXTURE, "--display", "biet2008-stator", "--out", "rendered")
run("study", "plan", "biet2008-gratings")
"""

LAB = """
import threading, time, urllib.request
from pathlib import Path
from squeezefilm.lab import serve
said, ended = [], []
server_of = serve.server_of
def made(*arguments, **options):
    ended.append(server_of(*arguments, **options))
    return ended[-1]
serve.server_of = made
def visit():
    while not any("token" in one for one in said):
        time.sleep(0.01)
    link = next(one for one in said if "token" in one).split()[-1]
    opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())
    try:
        assert b"squeezefilm" in opener.open(link, timeout=30).read()
        address = link.partition("?")[0]
        assert b"DesignView" in opener.open(address + "static/areas/design.js", timeout=30).read()
        said.append("visited")
    finally:
        ended[0].should_exit = True
visitor = threading.Thread(target=visit)
visitor.start()
serve.serve(Path("lab"), port=8990, browser=False, say=said.append)
visitor.join()
assert "visited" in said
"""


def without_posix(folder: Path, *programs: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", "".join((WITHOUT_POSIX, *programs))],
        cwd=folder, capture_output=True, text=True, timeout=600,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_every_module_is_imported_and_the_lab_runs_without_posix(tmp_path: Path) -> None:
    without_posix(tmp_path, IMPORTS, LAB)


@pytest.mark.nightly
def test_analysis_rendering_and_studies_run_without_posix(tmp_path: Path) -> None:
    without_posix(tmp_path, VERBS, ANALYSES.replace("TEXTURE", repr(presets.texture_names()[0])))


@pytest.mark.parametrize(
    ("real", "name", "same"),
    [
        ("lab.css", "lab.css", True),
        (r"areas\design.js", "areas/design.js", True),
        (r"areas\design.js", r"areas\design.js", False),
        (r"areas\design.js", "areas/design.js/", False),
        (r"areas\design.js", "areas/./design.js", False),
        (r"areas\design.js", "AREAS/design.js", False),
        (r"..\server.py", "../server.py", False),
        (r"D:\other", "D:/other", False),
    ],
)
def test_an_address_names_a_file_on_windows_too(real: str, name: str, same: bool) -> None:
    folder = PureWindowsPath(r"C:\Users\ada\squeezefilm\lab\static")
    if real.startswith(".."):
        found = PureWindowsPath(r"C:\Users\ada\squeezefilm\lab\server.py")
    else:
        found = folder / real
    assert is_named(found, folder, name) is same
