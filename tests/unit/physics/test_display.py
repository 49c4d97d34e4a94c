"""A display as a file: what is saved is read again, with its sources."""

from pathlib import Path

import pytest

from squeezefilm.core import presets
from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import load_display, save_display


@pytest.mark.parametrize("name", presets.display_names())
def test_a_saved_display_is_read_as_it_was_and_replaces_nothing(name: str, tmp_path: Path) -> None:
    display, path = load_display(name), tmp_path / "mine.toml"
    save_display(display, path)
    assert load_display(path) == display
    assert load_display(path).provenance == display.provenance
    with pytest.raises(InputError, match="exists already"):
        save_display(display, path)
