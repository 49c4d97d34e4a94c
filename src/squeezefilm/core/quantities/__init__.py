"""Units in the type, quantity text, and the one check of what public calls take and give."""

from squeezefilm.core.quantities.checks import *  # noqa: F403
from squeezefilm.core.quantities.require import *  # noqa: F403
from squeezefilm.core.quantities.units import *  # noqa: F403
from squeezefilm.core.quantities.vocabulary import *  # noqa: F403
