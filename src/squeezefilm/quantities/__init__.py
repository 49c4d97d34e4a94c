"""Units in the type, quantity text, and the one check of what public calls take and give."""

from squeezefilm.quantities.bounds import *  # noqa: F403
from squeezefilm.quantities.checks import *  # noqa: F403
from squeezefilm.quantities.require import *  # noqa: F403
from squeezefilm.quantities.typed import *  # noqa: F403
from squeezefilm.quantities.units import *  # noqa: F403
from squeezefilm.quantities.vocabulary import *  # noqa: F403
