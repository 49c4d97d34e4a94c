"""Every texture survives being written and read, and every class of the algebra is met."""

from hypothesis import given
from hypothesis import strategies as st

from squeezefilm.core.config.schema import family
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.pattern import Coordinate, Pattern
from squeezefilm.physics.texture_files.texture_file import (
    TextureFile,
    texture_from_text,
    texture_text,
)

from .texture_strategies import any_textures

titles = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)


@given(any_textures, titles)
def test_writing_and_reading_changes_nothing(texture: Composable, title: str) -> None:
    text = texture_text(TextureFile(texture, title))
    read = texture_from_text(text)
    assert read == TextureFile(texture, title)
    # Signs of zero and every digit too, which equality of floats would let pass.
    assert repr(read) == repr(TextureFile(texture, title))
    assert texture_text(read) == text


def test_the_types_a_file_may_name_are_all_of_the_algebra() -> None:
    def tags(base: type) -> set[str]:
        found = [cls.__dataclass_fields__["type"].default for cls in family(base)]
        assert len(set(found)) == len(found)
        return set(found)

    assert tags(Coordinate) == {"x", "y", "direction", "radius"}
    assert tags(Composable) == {
        "amplitude", "relative_friction", "friction_reduction",
        "sum", "product", "scaled", "masked", "sequence",
    }  # fmt: skip
    assert tags(Pattern) == {
        "constant", "square_wave", "sine_wave", "pulse", "ramp", "band", "bump", "noise",
        "noise_field", "image", "image_file", "speed_gate", "attack", "decay", "periodic",
        "complement", "least", "greatest", "times", "speed_scaled",
    }  # fmt: skip
