"""The gallery: a texture from above and along its middle line, and files that are current."""

from __future__ import annotations

import io
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from PIL import Image

import gallery
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit import style
from squeezefilm.core.kit.style import INK, PAPER


class Wave:
    """Waves of some length along x that grow with y; and what was asked of them."""

    def __init__(self, quantity: str, period: float | None = None) -> None:
        self.quantity, self.spatial_period = quantity, period
        self.asked: list[tuple[float, float]] = []

    def __call__(self, x: Any, y: Any, speed: float, direction: float) -> np.ndarray:
        self.asked.append((speed, direction))
        return np.asarray(1e-6 * np.cos(2 * np.pi * x / 4e-3) + 1e-3 * y)


def drawn(quantity: str, period: float | None = None) -> tuple[Any, Wave]:
    wave = Wave(quantity, period)
    texture: Any = SimpleNamespace(texture=wave, title="Some waves")
    return gallery.picture(texture), wave


@pytest.mark.parametrize(
    ("quantity", "label", "scale", "period", "wide"),
    [
        ("relative_friction", "relative friction µ′/µ", 1.0, None, 50.0),
        ("friction_reduction", "friction taken away µ − µ′", 1.0, 1e-3, 12.0),
        ("amplitude", "vibration amplitude (µm)", 1e6, 5e-3, 50.0),
    ],
)
def test_a_texture_is_seen_from_above_and_along_its_middle(
    quantity: str, label: str, scale: float, period: float | None, wide: float
) -> None:
    figure, wave = drawn(quantity, period)
    assert figure.get_suptitle() == "Some waves"
    small = figure.get_supxlabel().replace("\u00a0", " ")
    assert f"{label} as asked for at 60 mm/s, towards +x" in small
    left, right, bar = figure.axes
    (image,) = left.images
    high = 0.6 * wide
    assert image.get_extent() == pytest.approx([0, wide, 0, high])
    values = image.get_array()
    x, y = np.linspace(0, wide, values.shape[1]), np.linspace(0, high, values.shape[0])
    expected = 1e-6 * np.cos(2 * np.pi * x / 4)[None, :] + 1e-6 * y[:, None]
    assert np.max(np.abs(np.asarray(values) - scale * expected)) < 1e-9 * scale
    assert image.origin == "lower"
    assert (left.get_xlabel(), left.get_ylabel()) == ("x (mm)", "y (mm)")
    assert bar.get_xlabel() == label
    # The line that the other side is along, dashed on white so that it is seen on any ground.
    white, dashed = left.get_lines()
    for line in (white, dashed):
        assert np.asarray(line.get_ydata()) == pytest.approx([high / 2] * 2)
    assert (to_hex(white.get_color()), to_hex(dashed.get_color())) == (PAPER, INK)
    assert white.get_linewidth() > dashed.get_linewidth()
    (curve,) = right.get_lines()
    along = np.asarray(curve.get_xdata(), float)
    assert along[[0, -1]] == pytest.approx([0, wide])
    middle = scale * (1e-6 * np.cos(2 * np.pi * along / 4) + 1e-6 * high / 2)
    assert np.max(np.abs(np.asarray(curve.get_ydata()) - middle)) < 1e-9 * scale
    # Fine enough for the finest of patterns: two hundred points a period.
    assert along.size > 12 * 200
    assert right.get_xlim() == pytest.approx((0, wide))
    assert right.get_ylabel() == label
    assert right.get_xlabel() == "x (mm), along the dashed line"
    assert set(wave.asked) == {(0.06, 0.0)}


NAMES = ("bumps", "waves")


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout with two textures, whose pictures are made of their names."""
    source = tmp_path / "tools/gallery.py"
    textures = tmp_path / "textures"
    textures.mkdir()
    for name in NAMES:
        (textures / f"{name}.toml").write_text(
            f'title = "Some {name}"\n\n\n[texture]\ntype = "{name}"\ntitle = "kept"\n\n'
        )
    monkeypatch.setattr(gallery, "__file__", str(source))
    monkeypatch.setattr(gallery.presets, "texture_names", lambda: NAMES)
    monkeypatch.setattr(gallery.presets, "resolve", lambda name, _: textures / f"{name}.toml")
    monkeypatch.setattr(
        gallery, "load_texture", lambda name: SimpleNamespace(title=f"Some {name}", texture=None)
    )
    monkeypatch.setattr(gallery, "picture", lambda texture: len(texture.title))
    monkeypatch.setattr(
        style, "png", lambda figure, dots_per_inch: painted((4, 4), 10 * figure, dots_per_inch)
    )
    (tmp_path / "docs").mkdir()
    return tmp_path / "docs"


def painted(size: tuple[int, int], level: int, more: int = 0) -> bytes:
    stream = io.BytesIO()
    Image.new("RGB", size, (level, level, more)).save(stream, format="png")
    return stream.getvalue()


@pytest.mark.usefixtures("checkout")
def test_the_page_has_every_texture_with_its_picture_and_its_file() -> None:
    files = gallery.gallery_files()
    assert list(files) == ["gallery/bumps.png", "gallery/waves.png", "gallery.md"]
    # "Some bumps" has ten letters.
    assert files["gallery/bumps.png"] == painted((4, 4), 100, 80)
    page = files["gallery.md"].decode()
    assert page.startswith("# Gallery of textures\n\nThe textures that come with the package")
    for name in NAMES:
        assert (
            f"## Some {name}: `{name}`\n\n"
            f"![Some {name}, from above and along a line](gallery/{name}.png)\n\n"
            f'```toml\n[texture]\ntype = "{name}"\ntitle = "kept"\n```\n' in page
        )
    assert page.index("`bumps`") < page.index("`waves`")
    assert page.endswith("```\n")
    assert not page.endswith("\n\n")


def test_a_gallery_is_written_and_then_it_is_current(
    checkout: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert gallery.main(["--check"]) == 1
    assert capsys.readouterr().out.splitlines() == [
        f"docs/{name} is not current; run: make gallery"
        for name in ("gallery/bumps.png", "gallery/waves.png", "gallery.md")
    ]
    # To check writes nothing.
    assert list(checkout.iterdir()) == []
    assert gallery.main([]) == 0
    assert {str(one.relative_to(checkout)) for one in checkout.rglob("*.*")} == set(
        gallery.gallery_files()
    )
    assert (gallery.main(["--check"]), capsys.readouterr().out) == (0, "")
    # What is no texture any more goes, whatever is no picture stays.
    for name in ("old.png", "waves.txt"):
        (checkout / "gallery" / name).write_bytes(b"x")
    (checkout / "gallery.md").write_bytes(b"old")
    assert gallery.main(["--check"]) == 1
    assert "docs/gallery.md is not current" in capsys.readouterr().out
    assert (checkout / "gallery.md").read_bytes() == b"old"
    assert gallery.main([]) == 0
    assert {one.name for one in (checkout / "gallery").iterdir()} == {
        "bumps.png", "waves.png", "waves.txt",
    }  # fmt: skip
    assert (checkout / "gallery.md").read_bytes() == gallery.gallery_files()["gallery.md"]


def test_outside_a_checkout_there_is_no_gallery(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gallery, "__file__", str(tmp_path / "a/b/gallery.py"))
    with pytest.raises(InputError, match="no docs folder"):
        gallery.main([])


def test_pictures_are_the_same_but_for_another_machines_rounding(tmp_path: Path) -> None:
    """By less than half a level of 256 in the mean over all points and colours."""
    path = tmp_path / "a.png"
    path.write_bytes(painted((4, 4), 100))
    assert gallery._same(path, painted((4, 4), 100))
    assert not gallery._same(path, painted((4, 5), 100))
    # One level in two colours of three are two thirds; in one of three a third.
    assert not gallery._same(path, painted((4, 4), 101))
    assert not gallery._same(path, painted((4, 4), 99))
    assert gallery._same(path, painted((4, 4), 100, 1))
    assert not gallery._same(path, painted((4, 4), 100, 2))
    text = tmp_path / "a.md"
    text.write_bytes(b"one")
    assert gallery._same(text, b"one")
    assert not gallery._same(text, b"two")
