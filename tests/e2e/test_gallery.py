"""The gallery in the documentation shows the textures that the package has."""

from pathlib import Path

import pytest

import gallery as texture_gallery


@pytest.mark.slow
def test_the_gallery_is_current(capsys: pytest.CaptureFixture[str]) -> None:
    assert texture_gallery.main(["--check"]) == 0, capsys.readouterr().out


@pytest.mark.slow
def test_a_stale_picture_is_noticed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = texture_gallery.gallery_files()
    other = {**whole, "gallery/bump.png": whole["gallery/noise.png"], "gallery.md": b"old"}
    monkeypatch.setattr(texture_gallery, "gallery_files", lambda: other)
    assert texture_gallery.main(["--check"]) == 1
    assert capsys.readouterr().out.count("is not current") == 2
    assert (Path(__file__).parents[2] / "docs/gallery.md").read_bytes() != b"old"
