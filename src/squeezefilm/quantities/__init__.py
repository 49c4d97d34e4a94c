"""Units in the type, quantity text, and the one check of what public calls take and give."""

from squeezefilm.quantities.checks import *  # noqa: F403
from squeezefilm.quantities.units import *  # noqa: F403
