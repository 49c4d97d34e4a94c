"""Names of files that a page may say: no way out of the folder, nothing overwritten by chance."""

from __future__ import annotations

import base64
import io
import zipfile
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.lab.files import existing, fresh, named, zipped


@pytest.mark.parametrize(
    "name", ["a", "7", "Plate-2_b.v1", "x" * 64, "a.csv", "two.toml.bak", "A..b"]
)
def test_letters_digits_dots_dashes_and_underscores_make_a_name(name: str, tmp_path: Path) -> None:
    assert named(tmp_path, name, ".toml") == tmp_path / f"{name}.toml"


def test_the_suffix_may_be_said_once(tmp_path: Path) -> None:
    assert named(tmp_path, "plate.toml", ".toml") == tmp_path / "plate.toml"
    assert named(tmp_path, "plate.toml.toml", ".toml") == tmp_path / "plate.toml.toml"
    assert named(tmp_path, "x" * 64 + ".toml", ".toml").name == "x" * 64 + ".toml"


@pytest.mark.parametrize(
    "name",
    [
        "", ".", "..", ".hidden", "-option", "_under", "a/b", "../a", "/etc/passwd", "a\\b", "a b",
        "a\n", "é", "a:b", "a\0", "x" * 65, "a.", "a..", ".toml", "../a.toml",
    ],
)  # fmt: skip
def test_anything_else_is_no_name(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no name for a file"):
        named(tmp_path, name, ".toml")


def test_a_refusal_quotes_the_name_in_short(tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        named(tmp_path, "/" * 200, ".toml")
    assert str(refused.value) == (
        f"'{'/' * 80}' is no name for a file: letters, digits, '.', '-' and '_', not beginning "
        "with a dot or a dash"
    )


def test_a_link_is_neither_read_nor_written(tmp_path: Path) -> None:
    (tmp_path / "real.toml").write_text("")
    for target in ("real.toml", "nowhere.toml"):
        link = tmp_path / "link.toml"
        link.symlink_to(tmp_path / target)
        for ask in (named, existing, fresh):
            with pytest.raises(InputError, match=r"^link\.toml is a link"):
                ask(tmp_path, "link", ".toml")
        link.unlink()


def test_what_is_read_must_be_there_and_what_is_written_must_not(tmp_path: Path) -> None:
    file = tmp_path / "one.toml"
    assert fresh(tmp_path, "one", ".toml") == file
    with pytest.raises(InputError, match=r"there is no file one\.toml in the lab's folder"):
        existing(tmp_path, "one", ".toml")
    file.write_text("")
    assert existing(tmp_path, "one.toml", ".toml") == file
    with pytest.raises(InputError, match=r"one\.toml exists; choose another name"):
        fresh(tmp_path, "one", ".toml")
    assert fresh(tmp_path, "one", ".toml", replace=True) == file
    assert fresh(tmp_path, "two", ".toml", replace=True) == tmp_path / "two.toml"
    # A folder of that name is no file.
    (tmp_path / "three.toml").mkdir()
    with pytest.raises(InputError, match="there is no file"):
        existing(tmp_path, "three", ".toml")


def test_a_folder_to_take_away_has_its_files_and_none_that_are_hidden_or_elsewhere(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "csv"
    (folder / "data").mkdir(parents=True)
    (folder / "data" / "trials.csv").write_text("a,b\n")
    (folder / ".mark.json").write_text("{}")
    (tmp_path / "secret").write_text("no")
    (folder / "link.csv").symlink_to(tmp_path / "secret")
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(zipped(folder)))) as archive:
        assert archive.namelist() == ["data/trials.csv"]
        assert archive.read("data/trials.csv") == b"a,b\n"
