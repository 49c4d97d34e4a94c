"""Compiles, as it is imported, what a host compiles before it plays: what is forked has it."""

from tests.faults.playing_host import own_plan

from squeezefilm.instruments.session.play.real_time import _compile

_compile(own_plan())
