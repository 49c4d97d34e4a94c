"""The library of materials: whole, consistent, found by any name, and taken value by value."""

from __future__ import annotations

import pytest

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.config import load_text
from squeezefilm.core.config.load import written_values
from squeezefilm.core.config.provenance import References
from squeezefilm.core.distributions import Uniform
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.presets import materials
from squeezefilm.core.presets.materials import Material
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import RectangularPlate

TEXT = presets.path("biet2008-plate").read_text(encoding="utf-8")
_SUBSTRATE, _CERAMIC = TEXT.index("[actuator.substrate]"), TEXT.index("[actuator.ceramic]")
_PATCHES = TEXT.index("[[actuator.patches]]")


def described(kind: str, table: str) -> str:
    """The preset with one of its parts described otherwise."""
    start, end = {
        "substrate": (_SUBSTRATE, _CERAMIC),
        "ceramic": (_CERAMIC, _PATCHES),
        "glue": (_SUBSTRATE, _SUBSTRATE),
    }[kind]
    return f"{TEXT[:start]}[actuator.{kind}]\n{table}\n\n{TEXT[end:]}"


def plate(text: str) -> RectangularPlate:
    actuator = load_text(Display, text).actuator
    assert isinstance(actuator, RectangularPlate)
    return actuator


@pytest.mark.parametrize("one", materials.materials(), ids=lambda one: one.name)
def test_every_material_builds_a_display_and_gives_a_source_for_each_value(one: Material) -> None:
    own = f'material = "{one.name}"' + ('\nthickness = "20 um"' if one.kind == "glue" else "")
    display = load_text(Display, described(one.kind, own))
    path = f"actuator.{one.kind}."
    found = {k: v for k, v in display.provenance.items() if k.startswith(path)}
    assert {path + name for name, _ in one.leaves()} <= set(found)
    for name, value in one.leaves():
        assert found[path + name].source == value["source"]
        assert isinstance(found[path + name].distribution, Uniform) == ("range" in value)
    assert one.spread
    assert one.title


def test_a_material_is_found_by_each_of_its_names_and_no_other_has_them() -> None:
    for one in materials.materials():
        for word in (one.name, *one.also, one.name.upper(), one.name.replace(" ", "-")):
            assert materials.named(word) is one
    assert materials.named("aluminum 5083") is materials.named("aluminium 5083")


@pytest.mark.parametrize(
    "name", [one.name for one in materials.materials() if one.kind == "ceramic"]
)
def test_what_a_ceramic_states_twice_is_the_same_within_half_a_percent(name: str) -> None:
    ceramic = plate(described("ceramic", f'material = "{name}"')).ceramic
    full = ceramic.constants
    assert full is not None
    s11, s12 = full.compliance_11, full.compliance_12
    assert ceramic.in_plane_stiffness == pytest.approx(s11 / (s11**2 - s12**2), rel=5e-4)
    assert ceramic.in_plane_poisson_ratio == pytest.approx(-s12 / s11, rel=5e-4)
    assert ceramic.shear_modulus == pytest.approx(1 / full.compliance_44, rel=5e-4)
    assert ceramic.charge_coefficient == full.charge_coefficient_31
    assert ceramic.relative_permittivity == full.clamped_permittivity_33
    # Isotropy across the poling, to what the published digits allow.
    assert full.compliance_66 == pytest.approx(2 * (s11 - s12), rel=1e-3)


def test_pzt_4_has_the_stress_coefficients_that_ansys_prints_after_berlincourt() -> None:
    full = plate(described("ceramic", 'material = "PZT-4"')).ceramic.full_constants
    e = full.stress_matrix
    assert (e[2, 0], e[2, 2], e[0, 4]) == pytest.approx((-5.2028, 15.0804, 12.7179), abs=5e-5)


def test_a_name_may_stand_for_the_whole_table_or_beside_values_of_ones_own() -> None:
    named = plate(described("substrate", 'material = "5083"')).substrate
    assert (named.name, named.young_modulus) == ("aluminium 5083", 71e9)
    start = TEXT.index("[actuator.substrate]")
    alone = f'substrate = "aluminium 5083"\n\n{TEXT[_CERAMIC:]}'
    assert plate(TEXT[:start] + alone).substrate == named
    own = described("substrate", 'material = "5083"\nyoung_modulus = "70 GPa"\nname = "mine"')
    mixed = load_text(Display, own)
    assert mixed.actuator.substrate.young_modulus == 70e9  # type: ignore[union-attr]
    assert mixed.provenance["actuator.substrate.young_modulus"].evidence == "unstated"
    assert "MatWeb" in mixed.provenance["actuator.substrate.density"].source
    # One constant of a ceramic in place of the library's, the others stay.
    table = 'material = "PZT-4"\n[actuator.ceramic.constants]\ncompliance_44 = "40e-12 m2/N"'
    full = plate(described("ceramic", table)).ceramic.full_constants
    assert (full.compliance_44, full.compliance_33) == (40e-12, 15.5e-12)


def test_a_material_that_is_only_taken_for_it_makes_its_values_assumed() -> None:
    name = '{ value = "PZT-4", source = "not named", evidence = "assumed" }'
    found = load_text(Display, described("ceramic", f"material = {name}")).provenance
    of_it = [one for path, one in found.items() if path.startswith("actuator.ceramic.")]
    assert {one.evidence for one in of_it} == {"assumed"}
    assert all(one.source.startswith("not named; ") for one in of_it)


def test_a_name_that_is_none_is_refused_with_what_there_is() -> None:
    for table, says in (
        ('material = "aluminium 5803"', "Did you mean 'aluminium 5083'"),
        ('material = "aluminium"', "Several names contain it"),
        ('material = "PZT-4"', "'PZT-4' is a ceramic, and a substrate is wanted here"),
        ("material = 3", "3 is no name of a material"),
    ):
        with pytest.raises(ConfigError, match=says) as caught:
            load_text(Display, described("substrate", table), file="mine.toml")
        assert caught.value.key == "actuator.substrate.material"
        assert caught.value.line == TEXT[:_SUBSTRATE].count("\n") + 2
    with pytest.raises(InputError, match="there is no material 'x'"):
        materials.table("x", "glue")


def test_references_leave_alone_what_names_nothing() -> None:
    none = References(original=lambda _: None, parts={"a.b": lambda _: {}})
    for tree in ({}, {"a": 3}, {"a": {"b": {"c": 1}}}, {"a": {}}):
        assert none.written_out(tree) == (tree, None)


def test_values_are_shown_as_typed_and_materials_with_all_of_theirs() -> None:
    text = described("substrate", 'material = "brass"\ndensity = "8.50 g/cm3"')
    shown = {path: rest for path, *rest in written_values(Display, text)}
    assert shown["actuator", "substrate", "density"][0] == "8.50 g/cm3"
    assert shown["actuator", "substrate", "young_modulus"][0] == "112 GPa"
    assert shown["actuator", "ceramic", "in_plane_poisson_ratio"][0] == "0.2897"
    assert shown["name",] == ["biet2008-plate", None]
    assert si.parse_quantity(shown["actuator", "patches", 1, "x"][0], si.Unit("m")) == 12e-3
