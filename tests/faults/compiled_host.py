"""Compiles, as it is imported, what a host compiles before it plays: what is forked has it."""

from squeezefilm.instruments.session.play.real_time import _compile

_compile()
