"""Put small faults into the source, one at a time, and see which the tests notice.

    python tools/mutants.py --seed 1 --count 60         # some ten minutes; or --rooms study,lab
    python tools/mutants.py --report

A sample is drawn by seed over all kinds of faults in turn. Each mutant is tried in a private copy
of the working tree, never in the checkout, with compiled code cached apart, until a test fails: by
quick tests that ran the line when `make coverage` was run last, or, of a line that nobody saw
running since (compiled code, or a file changed after it), of the nearest files by names and
imports, for `--budget` seconds of processor time together. What fails counts if the source passes
it with nothing but a blank line more. What passes them all survived. `--nightly` asks the slow
tests of those files too. The answers are appended to a file of JSON lines; a run that was cut off
goes on where it stopped. Mutants that change nothing anybody could notice are named in
``tools/equivalent_mutants.toml`` with the reason, and do not count.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import hashlib
import itertools
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from coverage import CoverageData

import import_graph
from mutant_report import print_report
from mutations import Mutant, all_mutants, sample

ROOT = Path(__file__).parents[1]
EQUIVALENT = Path(__file__).with_name("equivalent_mutants.toml")
# What `make test` runs side by side, and what else there is.
MARKS = {
    "quick": "not campaign and not (realtime or slow or nightly)",
    "slow": "not campaign and (realtime or slow or nightly)",
}
_FILES = 12  # of tests that are asked by nearness
_COVERING = 40  # tests that are asked since they ran the line
_COMPILED = 4.0  # budgets of a module that numba compiles anew for each mutant
_CUT_OFF = 2.0  # budgets, after which a test that was begun within one is slow
_FAILED = re.compile(r"^(?:FAILED|ERROR) (.+)$", re.MULTILINE)


@dataclass(frozen=True)
class Answer:
    """What tests said: passed, failed, empty (nothing to run), or slow (cut off), by which of them
    (empty where that is not known, as after a crash), and in how many seconds of processor time."""

    said: str
    test: str
    seconds: float


class Copy:
    """A private copy of the working tree, in which mutants live and tests run."""

    def __init__(self, folder: Path) -> None:
        self.tree, self._cache, self._tried = folder / "tree", folder / "cache", folder / "tried"
        self._seconds = itertools.count(1)
        self._temporary = folder / "tmp"
        for part in (self.tree, self._cache):
            part.mkdir(parents=True, exist_ok=True)
        self.state = self._copy()
        self._take_compiled()

    def _copy(self) -> str:
        """Make the copy equal to the working tree; a digest of what can change an answer."""
        command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        listed = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout
        names = sorted(name for name in listed.decode().split("\0") if (ROOT / name).is_file())
        kept = set(names)
        for path in list(self.tree.rglob("*")):
            name = path.relative_to(self.tree).as_posix()
            if path.is_file() and name not in kept and "__pycache__" not in name:
                path.unlink()
        digest = hashlib.sha256()
        for name in names:
            content = (ROOT / name).read_bytes()
            if name.startswith(("src/", "tests/", "pyproject")):
                digest.update(name.encode() + b"\0" + content)
            target = self.tree / name
            if not target.exists() or target.read_bytes() != content:
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, target)
        return digest.hexdigest()[:12]

    def _take_compiled(self) -> None:
        """Take over what numba has compiled of the checkout: it knows a file by its time."""
        for compiled in (ROOT / "src").rglob("__pycache__/*.nb[ic]"):
            there = self.tree / compiled.parents[1].relative_to(ROOT)
            folder = self._cache / f"{there.name}_{hashlib.sha1(str(there).encode()).hexdigest()}"
            folder.mkdir(exist_ok=True)
            shutil.copy2(compiled, folder / compiled.name)

    @contextlib.contextmanager
    def _changed(self, path: Path, text: bytes) -> Iterator[None]:
        # What is compiled or solved of a changed source is forgotten with it.
        shutil.rmtree(self._tried, ignore_errors=True)
        shutil.copytree(self._cache, self._tried, copy_function=os.link)
        shutil.rmtree(self.tree / "out" / "test-cache", ignore_errors=True)
        source, times = path.read_bytes(), path.stat()
        path.write_bytes(text)
        # A mutant of the size and second of the last one would be run by that one's bytecode.
        later = times.st_mtime_ns + 10**9 * next(self._seconds)
        os.utime(path, ns=(times.st_atime_ns, later))
        try:
            yield
        finally:
            path.write_bytes(source)
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))

    def ask(
        self, tests: Sequence[str], marks: str, budget: float, mutant: Mutant, healthy: bool = False
    ) -> Answer:
        """Run tests, or files of them, until the first failure, or for `budget` seconds of
        processor time; `healthy`: of a source that only has a blank line more in the same file."""
        path = self.tree / "src" / mutant.path
        source = path.read_bytes()
        if b"@compiled(" in source:
            budget *= _COMPILED
        with self._changed(path, source + b"\n" if healthy else mutant.applied(source)):
            return self._asked(tests, marks, budget)

    def _asked(self, tests: Sequence[str], marks: str, budget: float) -> Answer:
        shutil.rmtree(self._temporary, ignore_errors=True)
        self._temporary.mkdir()
        environment = {
            **os.environ,
            "PYTHONPATH": str(self.tree / "src"),
            "PYTHONDONTWRITEBYTECODE": "",
            "NUMBA_CACHE_DIR": str(self._tried),
            "MPLCONFIGDIR": str(self._cache / "matplotlib"),  # its list of fonts takes seconds
            "TMPDIR": str(self._temporary),
            "HOME": str(self._temporary),
        }
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-rfE", "-p", "no:cacheprovider"]
        command += ["-p", "tests.costs", "--within", str(budget), "-m", MARKS[marks], *tests]
        test = ""
        started, limit = processor_time(), round(_CUT_OFF * budget)
        limits = resource.RLIMIT_CPU, (limit, limit)
        with tempfile.TemporaryFile() as output:
            process = subprocess.Popen(
                command,
                cwd=self.tree,
                env=environment,
                stdout=output,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
                preexec_fn=functools.partial(resource.setrlimit, *limits),
            )
            try:
                process.wait(timeout=10 * limit)
            except subprocess.TimeoutExpired:
                return Answer("slow", test, processor_time() - started)
            finally:
                process.kill()
                self._end_processes()
                process.wait()
            if process.returncode == -signal.SIGKILL:
                return Answer("slow", test, processor_time() - started)
            output.seek(0)
            # Of the summary alone: what a test logged may stand before it as ERROR too.
            told = output.read().decode(errors="replace")
            failed = _FAILED.search(told.rpartition("short test summary info")[2])
        said = {0: "passed", 2: "passed", 5: "empty"}.get(process.returncode, "failed")
        if failed is not None:
            said, test = "failed", failed_test(failed[1], tests)
        return Answer(said, test, processor_time() - started)

    def _end_processes(self) -> None:
        """End what the tests started: every process that has our folder for its temporary files."""
        mark = f"TMPDIR={self._temporary}".encode()
        for folder in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                if mark in (folder / "environ").read_bytes().split(b"\0"):
                    os.kill(int(folder.name), signal.SIGKILL)


def processor_time() -> float:
    """Processor time (s) of the processes that ended so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def failed_test(told: str, asked: Sequence[str]) -> str:
    """The test that failed, of what pytest tells in its summary: its name, which may hold blanks,
    and perhaps a dash and a message."""
    by_name = [test for test in asked if told == test or told.startswith(f"{test} - ")]
    return max(by_name, key=len, default=told.partition(" - ")[0])


class Nearness:
    """Which tests could notice a change of a module, nearest first."""

    def __init__(self, tree: Path) -> None:
        self.graph = import_graph.import_graph(tree / "src")
        self.texts: dict[str, str] = {}
        self._after: dict[str, frozenset[str]] = {}
        self._steps: dict[str, dict[str, int]] = {}
        tests = tree / "tests"
        named_by = functools.cache(lambda helper: import_graph.modules_named_by(helper, self.graph))
        for test in import_graph.test_files(tests):
            name = test.relative_to(tree).as_posix()
            self.texts[name] = test.read_text(encoding="utf-8")
            named = set(import_graph.modules_named_by(test, self.graph))
            if "/e2e/" in name:
                named.add("squeezefilm.cli")
            for folder in [parent for parent in test.parents if tests in [parent, *parent.parents]]:
                for helper in folder.glob("*.py"):
                    if helper.stem == "conftest" or f"{helper.stem} import" in self.texts[name]:
                        named |= named_by(helper)
            self._after[name] = import_graph.modules_in_the_name_of(test, tests, self.graph)
            self._steps[name] = import_graph.distances(named, self.graph)

    def own(self, test: str, module: str) -> bool:
        """Whether a file of tests is named after a module."""
        return module in self._after[test]

    def tests(self, module: str) -> list[str]:
        """The files of tests that reach a module: its own first, then by steps of import."""
        ranked = [
            (not self.own(name, module), steps.get(module, 0), len(steps), name)
            for name, steps in self._steps.items()
            if module in steps or self.own(name, module)
        ]
        return [name for *_, name in sorted(ranked)]


class Covering:
    """The tests that ran a line when `make coverage` was run last."""

    def __init__(self, file: Path) -> None:
        self._data = CoverageData(str(file))
        self._from = file.stat().st_mtime if file.exists() else 0.0
        if file.exists():
            self._data.read()

    def tests(self, path: Path, line: int, files: Sequence[str]) -> list[str]:
        """Those of a line of a file that has not changed since, those of the given files first;
        one of each function's variants, and last the others of the first file."""
        if not self._from or path.stat().st_mtime > self._from:
            return []
        contexts = self._data.contexts_by_lineno(str(path)).get(line, [])
        named = sorted({context.partition("|")[0] for context in contexts} - {""})
        rank = {name: number for number, name in enumerate(files)}
        functions = {test.partition("[")[0]: test for test in reversed(named)}
        nearest = sorted(
            functions.values(), key=lambda test: rank.get(test.partition("::")[0], len(rank))
        )
        own = [test for test in named if files and test.startswith(f"{files[0]}::")]
        others = [test for test in own if test not in nearest]
        return nearest[:_COVERING] + others[:_COVERING]


class Report:
    """The file of answers: JSON lines, to which everything is appended at once."""

    def __init__(self, path: Path, run: dict[str, Any]) -> None:
        self._path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        lines = read_lines(path)
        if lines and {key: lines[0].get(key) for key in run} != run:
            sys.exit(f"{path} was begun with {lines[0]}, not with {run}: name another file")
        self.done = {line["id"] for line in lines if line["type"] == "mutant"}
        self.baselines = {
            (line["asked"], line["marks"]): Answer(line["said"], line["test"], line["seconds"])
            for line in lines
            if line["type"] == "baseline"
        }
        if not lines:
            commit = subprocess.run(
                ["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True
            )
            self.write({"type": "run", **run, "commit": commit.stdout.strip()})

    def write(self, line: dict[str, Any]) -> None:
        """Append one line."""
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line, ensure_ascii=False) + "\n")


def read_lines(path: Path) -> list[dict[str, Any]]:
    """The lines of a report; one that was cut off in writing is left out."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return [json.loads(line) for line in lines if line.endswith("}")]


class Trial:
    """Tries mutants in a copy, with so much processor time for each."""

    def __init__(self, copy: Copy, report: Report, arguments: argparse.Namespace) -> None:
        self._copy, self._report = copy, report
        self._nearness = Nearness(copy.tree)
        self._covering = Covering(ROOT / "out" / "coverage")
        self._budgets = {"quick": arguments.budget}
        if arguments.nightly:
            self._budgets["slow"] = arguments.slow_budget

    def _passes(self, tests: Sequence[str], marks: str, mutant: Mutant) -> bool:
        """Whether the source passes tests, asked once for each module that is written anew."""
        asked = " ".join([mutant.path, *tests])
        if (asked, marks) not in self._report.baselines:
            answer = self._copy.ask(tests, marks, self._budgets[marks], mutant, healthy=True)
            self._report.baselines[asked, marks] = answer
            line = {"type": "baseline", "asked": asked, "marks": marks, **asdict(answer)}
            self._report.write(line)
        return self._report.baselines[asked, marks].said == "passed"

    def _notices(self, mutant: Mutant, tests: Sequence[str], marks: str) -> Answer | None:
        """How tests notice a mutant, if they do and the source as it is passes them."""
        answer = self._copy.ask(tests, marks, self._budgets[marks], mutant)
        if answer.said not in ("failed", "slow"):
            return None
        suspect = [answer.test] if answer.test else tests
        return answer if self._passes(suspect, marks, mutant) else None

    def run(self, mutant: Mutant) -> dict[str, Any]:
        """The line of the report for one mutant."""
        started = processor_time()
        line: dict[str, Any] = {"type": "mutant", "id": mutant.id, "at": where(mutant)}
        line |= {"room": mutant.room, "kind": mutant.site.kind, "function": mutant.site.function}
        line |= {"before": mutant.before, "after": mutant.site.after}
        line |= {"noticed": False, "marks": "", "said": "passed", "test": ""}
        files = self._nearness.tests(mutant.module)
        covering = self._covering.tests(ROOT / "src" / mutant.path, mutant.line, files)
        files = files[:_FILES]
        asked = {"quick": covering or files, "slow": files}
        for marks in self._budgets if files else ():
            answer = self._notices(mutant, asked[marks], marks)
            if answer is not None:
                line |= {"noticed": True, "marks": marks, **asdict(answer)}
                break
        return line | {"asked": asked["quick"], "seconds": round(processor_time() - started, 1)}


def where(mutant: Mutant) -> str:
    """The file and line of a mutant, from the root."""
    return f"src/{mutant.path}:{mutant.line}"


def equivalent_mutants() -> dict[str, str]:
    """The mutants that nobody could notice: their identity and the reason."""
    entries = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8")).get("mutant", [])
    return {entry["id"]: entry["reason"] for entry in entries}


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1, help="of the sample")
    parser.add_argument("--count", type=int, default=70, help="mutants in the sample")
    parser.add_argument("--rooms", default="", help="only these, separated by commas")
    parser.add_argument(
        "--budget", type=float, default=16, help="processor time of the tests of a mutant (s)"
    )
    parser.add_argument("--minutes", type=float, default=60, help="after which none is begun")
    parser.add_argument(
        "--slow-budget", type=float, default=900, help="the same of its slow tests (s)"
    )
    parser.add_argument("--nightly", action="store_true", help="ask the slow tests too, last")
    parser.add_argument("--file", type=Path, default=ROOT / "out" / "mutants.jsonl")
    parser.add_argument("--work", type=Path, default=Path(tempfile.gettempdir()) / "sf-mutants")
    parser.add_argument("--list", action="store_true", help="only show the sample")
    parser.add_argument("--report", action="store_true", help="only show what was found")
    return parser.parse_args()


def main() -> None:
    """Try the sample, or show what was found."""
    arguments = _arguments()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # to end the tests with us
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if arguments.report:
        print_report(read_lines(arguments.file), equivalent_mutants())
        return
    rooms = sorted(filter(None, arguments.rooms.split(",")))
    every = all_mutants(ROOT / "src", rooms)
    gone = equivalent_mutants().keys() - {mutant.id for mutant in every}
    if gone and not rooms:
        print(f"{EQUIVALENT.name} names what is no mutant any more: {', '.join(sorted(gone))}")
    drawn = sample(every, arguments.seed)
    chosen: list[Mutant] = []
    while len(chosen) < arguments.count and (mutant := next(drawn, None)):
        if mutant.is_valid((ROOT / "src" / mutant.path).read_bytes()):
            chosen.append(mutant)
    if arguments.list:
        for mutant in chosen:
            print(mutant.id, mutant.site.kind, where(mutant), repr(mutant.site.after))
        return
    copy = Copy(arguments.work.resolve())
    run = {"seed": arguments.seed, "rooms": rooms, "state": copy.state}
    report = Report(
        arguments.file, {**run, "budget": arguments.budget, "nightly": arguments.nightly}
    )
    trial = Trial(copy, report, arguments)
    stop = time.monotonic() + 60 * arguments.minutes
    for number, mutant in enumerate(chosen, 1):
        if mutant.id in report.done:
            continue
        if time.monotonic() > stop:
            print(f"time is up before mutant {number} of {len(chosen)}: run again to go on")
            break
        line = trial.run(mutant)
        report.write(line)
        end = (
            f"noticed by {line['test'] or line['said']}"
            if line["noticed"]
            else f"SURVIVED ({line['said']})"
        )
        print(
            f"{number}/{len(chosen)} {mutant.id} {where(mutant)} {mutant.site.kind}: {end}",
            flush=True,
        )
    print_report(read_lines(arguments.file), equivalent_mutants())


if __name__ == "__main__":
    main()
