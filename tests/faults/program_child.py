"""The program in a forked process that has imported what its verbs need."""

from __future__ import annotations

from multiprocessing.connection import Connection

from tests.e2e.program import run

# What the verbs import when they are asked.
import squeezefilm.analysis.friction.command
import squeezefilm.chain.rendered_texture
import squeezefilm.cli
import squeezefilm.study.design.plan  # noqa: F401


def program(tells: Connection, words: list[str]) -> None:
    """Run a command line, and tell its exit code and what it wrote to standard error."""
    done = run(*words)
    tells.send((done.returncode, done.stderr))
