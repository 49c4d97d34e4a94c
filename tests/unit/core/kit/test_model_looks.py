"""Each model is drawn in its own way, everywhere."""

from squeezefilm.core.kit import style
from squeezefilm.core.kit.model_looks import look_of
from squeezefilm.physics.chain.pad_law import MODEL_KINDS


def test_no_two_models_look_alike() -> None:
    # As printed the paper's asymptote is the same line; it stands beside no other.
    models = {*MODEL_KINDS, "solved film"} - {"paper2008-printed"}
    looks = [look_of(model) for model in models]
    assert len({(look.color, look.dashes) for look in looks}) == len(looks)
    assert len({look.name for look in looks}) == len(looks)
    assert all(look.name != model for look, model in zip(looks, models, strict=True))


def test_an_unknown_model_goes_by_its_own_name() -> None:
    assert look_of("another") == (style.INK, "-", "another")
