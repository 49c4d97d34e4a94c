"""What pages ask of the study area."""

from __future__ import annotations

from pydantic import Field

from squeezefilm.lab.wire import Request


class NamedStudy(Request):
    """A study by the name of its file."""

    study: str = Field(max_length=100)


class PlanStudy(Request):
    """A preset design."""

    design: str = Field(max_length=100)


class CreateStudy(PlanStudy):
    """A new study's file."""

    study: str = Field(max_length=64)
    seed: int = Field(ge=0, le=2**53)


class OfParticipant(NamedStudy):
    """A participant of a study."""

    participant: str = Field(max_length=100)


class DeleteParticipant(OfParticipant):
    """Deleting asks for the pseudonym twice."""

    confirm: str = Field(max_length=100)


class PrepareSitting(OfParticipant):
    """A sitting: what a `SessionConditions` has, and the consent's text."""

    device: str = Field(max_length=100)
    consent: str = Field(min_length=20, max_length=20_000)
    conditions: dict[str, str | float | None] = Field(default_factory=dict, max_length=20)
    acknowledged: bool = False


class OfSitting(Request):
    """A sitting by its id."""

    sitting: str = Field(max_length=100)


class FeelSurface(OfSitting):
    """A surface of the trial with this token to be played, by its place from 0."""

    token: str = Field(max_length=100)
    place: int = Field(ge=0, le=9)


class SurfacesFelt(OfSitting):
    """All surfaces of the trial with this token were felt."""

    token: str = Field(max_length=100)


class Respond(OfSitting):
    """An answer to the trial with this token."""

    token: str = Field(max_length=100)
    choice: str = Field("", max_length=200)
    estimate: float | None = None
    response_time: float | None = Field(None, ge=0.0, le=86400.0)
    started_monotonic: float = Field(0.0, ge=0.0, le=1e12)
    ended_monotonic: float = Field(0.0, ge=0.0, le=1e12)


class RehearseStudy(NamedStudy):
    """How many simulated participants do the study."""

    participants: int = Field(ge=1, le=200)


class ExportStudy(NamedStudy):
    """A study's export."""

    format: str = Field(max_length=20)


class MergeStudy(NamedStudy):
    """Another station's file."""

    other: str = Field(max_length=100)
