"""Which tests `make test PART=film` runs: those of the room and of nothing else."""

from pathlib import Path

import pytest

import part_tests

ROOT = Path(__file__).parents[3]


def test_a_room_has_the_tests_below_it_and_those_of_its_physics_elsewhere() -> None:
    files = part_tests.tests_of("film", ROOT)
    below = {
        str(file.relative_to(ROOT))
        for file in (ROOT / "tests/unit/physics/film").rglob("test_*.py")
    }
    assert below < set(files)
    others = set(files) - below
    assert "tests/verification/test_film_closed_forms.py" in others
    inside = {file for file in others if file.startswith(("tests/unit", "tests/architecture"))}
    assert inside == {"tests/unit/design/test_film.py"}


@pytest.mark.parametrize(
    ("part", "test"),
    [
        ("interrupts", "tests/unit/core/test_interrupts.py"),
        ("planar", "tests/unit/physics/film/planar/test_kernel.py"),
        ("physics/film/planar", "tests/unit/physics/film/planar/test_kernel.py"),
        ("control", "tests/unit/instruments/control/test_plate_loop.py"),
    ],
)
def test_a_module_a_folder_and_a_path_are_parts(part: str, test: str) -> None:
    files = part_tests.tests_of(part, ROOT)
    assert test in files
    assert len(files) < 10


@pytest.mark.parametrize("part", ["nowhere", "", "nowhere/film"])
def test_another_part_is_refused_with_the_rooms(part: str) -> None:
    with pytest.raises(ValueError, match=r"actuators, cli, core, .*validation"):
        part_tests.tests_of(part, ROOT)
