"""What is released says one version, and what CI and pre-commit call exists."""

import email
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

import release
import squeezefilm

ROOT = Path(__file__).parents[3]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def _yaml(name: str) -> Any:
    return yaml.safe_load((ROOT / name).read_text(encoding="utf-8"))


def test_the_version_is_stated_once() -> None:
    source = (ROOT / "src" / "squeezefilm" / "__init__.py").read_text(encoding="utf-8")
    assert release.version_of(source) == squeezefilm.__version__
    assert PROJECT["dynamic"] == ["version"]
    assert "version" not in PROJECT
    assert "version" not in _yaml("CITATION.cff")
    with pytest.raises(ValueError, match="0 times"):
        release.version_of("version = 1")


def test_the_changelog_fits_the_version() -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert release.changelog_complaints(changelog, squeezefilm.__version__) == []
    text = "# Changelog\n\n## Unreleased\n\n## 0.2.0 (2026-01-31)\n"
    assert release.changelog_complaints(text, "0.2.0") == []
    assert release.changelog_complaints(text, "0.3.0.dev0") == []
    assert "0.3.0" in release.changelog_complaints(text, "0.3.0")[0]
    assert "Unreleased" in release.changelog_complaints("## 0.2.0 (2026-01-31)\n", "0.2.0")[0]


def test_metadata_that_differ_are_named() -> None:
    text = (
        "Name: squeezefilm\nVersion: 0.1.0\n"
        f"Summary: {PROJECT['description']}\nLicense-Expression: BSD-3-Clause\n"
        f"Requires-Python: {PROJECT['requires-python']}\n"
        "Description-Content-Type: text/markdown\n\n# squeezefilm\n"
    )
    assert release.metadata_complaints(email.message_from_string(text), PROJECT, "0.1.0") == []
    assert release.metadata_complaints(email.message_from_string(text), PROJECT, "0.2.0") == [
        "Version is '0.1.0', not '0.2.0'"
    ]
    bare = email.message_from_string("Name: squeezefilm\n\nnothing\n")
    assert len(release.metadata_complaints(bare, PROJECT, "0.2.0")) == 6


def test_hooks_are_local_and_call_tools_that_are_installed_for_tests() -> None:
    repos = _yaml(".pre-commit-config.yaml")["repos"]
    assert [repo["repo"] for repo in repos] == ["local"]
    wanted = " ".join(PROJECT["optional-dependencies"]["test"])
    for hook in repos[0]["hooks"]:
        program = hook["entry"].split()[0].removeprefix(".venv/bin/")
        package = {"lint-imports": "import-linter"}.get(program, program)
        assert hook["language"] == "system"
        assert re.search(rf"\b{package}>", wanted), program


def test_the_workflow_runs_what_is_run_by_hand() -> None:
    jobs = _yaml(".github/workflows/ci.yml")["jobs"]
    assert ".ci/run" in [step.get("run") for step in jobs["linux"]["steps"]]
    assert (ROOT / ".ci" / "run").stat().st_mode & 0o111
    assert jobs["elsewhere"]["strategy"]["matrix"]["os"] == ["macos-latest", "windows-latest"]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    stages = re.findall(r"^stage ([a-z ]+)", (ROOT / ".ci" / "run").read_text(), re.MULTILINE)
    targets = " ".join(stages).split()
    assert {"lint", "types", "layers", "test", "docs", "slow"} == set(targets)
    for target in targets:
        assert re.search(rf"^{target}:", makefile, re.MULTILINE)


@pytest.mark.skipif(sys.platform == "win32", reason="a script for bash")
def test_ci_stops_at_the_first_stage_that_fails_and_lists_its_tests(tmp_path: Path) -> None:
    (tmp_path / ".ci").mkdir()
    (tmp_path / "bin").mkdir()
    (tmp_path / "tests" / "faults").mkdir(parents=True)
    shutil.copy(ROOT / ".ci" / "run", tmp_path / ".ci" / "run")
    told = 'echo "$*" >>asked; case "$*" in *unit) echo "FAILED tests/a.py::b - c"; exit 2;; esac'
    for name in ("make", "chromium", "node", "cc", "arm-none-eabi-gcc"):
        program = tmp_path / "bin" / name
        program.write_text(f"#!/bin/sh\n{told if name == 'make' else ''}\n")
        program.chmod(0o755)
    path = f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        [tmp_path / ".ci" / "run"],
        env={**os.environ, "PATH": path}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    end = "ci: make test TESTS=tests/architecture tests/unit failed:\nFAILED tests/a.py::b - c\n"
    assert done.stdout.endswith(end)
    asked = (tmp_path / "asked").read_text().splitlines()
    assert asked == ["lint types layers", "test TESTS=tests/architecture tests/unit"]


@pytest.mark.parametrize("name", ["fault", "wish"])
def test_templates_ask_something(name: str) -> None:
    form = _yaml(f".github/ISSUE_TEMPLATE/{name}.yml")
    assert {"name", "description", "body"} <= form.keys()
    identities = [item["id"] for item in form["body"]]
    assert len(set(identities)) == len(identities) >= 3
