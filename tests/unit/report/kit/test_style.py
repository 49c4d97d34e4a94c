"""The style of figures: it holds within its context, is set once, and is undone."""

from __future__ import annotations

import os
import subprocess
import sys

import matplotlib
import pytest

from squeezefilm.report.kit import style


def test_the_style_holds_within_another_and_is_undone() -> None:
    before = dict(matplotlib.rcParams.copy())
    with style.rc():
        within = matplotlib.rcParams["font.size"], matplotlib.rcParams["axes.linewidth"]
        with style.rc():
            assert matplotlib.rcParams["font.size"] == within[0]
        # The inner one undoes nothing of the outer one.
        assert (matplotlib.rcParams["font.size"], matplotlib.rcParams["axes.linewidth"]) == within
        assert within == (10.5, 0.8)
    assert dict(matplotlib.rcParams.copy()) == before


@pytest.mark.slow
def test_a_figure_loads_no_user_interface() -> None:
    """pyplot looks for windows and takes a third of a second."""
    code = (
        "import sys\n"
        "from squeezefilm.report.kit import style\n"
        "with style.rc():\n"
        "    figure = style.new_figure('title', 'model', 3.0)\n"
        "    figure.subplots().plot([0, 1], [1, 2])\n"
        "assert '<svg' in style.svg(figure, 'one', 'label')\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ.copy())
