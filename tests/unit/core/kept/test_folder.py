"""Where what is kept lies."""

from pathlib import Path

import pytest

from squeezefilm.core.kept.store import CACHE_VARIABLE, cache_folder


@pytest.mark.parametrize(
    ("platform", "variable", "inside"),
    [("linux", "XDG_CACHE_HOME", ""), ("win32", "LOCALAPPDATA", ""), ("darwin", "HOME", "Library")],
)
def test_it_is_where_the_system_keeps_caches(
    platform: str, variable: str, inside: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(CACHE_VARIABLE)
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setenv(variable, str(tmp_path))
    found = cache_folder()
    assert found is not None
    assert found.name == "squeezefilm"
    assert found.is_relative_to(tmp_path / inside)


def test_a_user_without_a_home_keeps_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("no home")

    monkeypatch.delenv(CACHE_VARIABLE)
    monkeypatch.setattr(Path, "home", homeless)
    assert cache_folder() is None
