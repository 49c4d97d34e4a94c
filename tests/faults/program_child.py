"""The program in a forked process that has imported what its verbs need."""

from __future__ import annotations

from multiprocessing.connection import Connection

from tests.e2e.program import run

import squeezefilm.cli

# What the verbs import when they are asked.
import squeezefilm.design.friction
import squeezefilm.physics.chain.rendered_texture
import squeezefilm.study.design.plan  # noqa: F401


def program(tells: Connection, words: list[str]) -> None:
    """Run a command line, and tell its exit code and what it wrote to standard error."""
    done = run(*words)
    tells.send((done.returncode, done.stderr))
