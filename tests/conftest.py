"""What every test needs before NumPy loads, and how far properties are explored.

One thread for linear algebra: small blocks are many times slower with threaded BLAS, most of all
when tests run side by side. Properties draw the same few examples every time in `make test`, and
many new ones in `make nightly`, which sets SQUEEZEFILM_EXPLORE and prints its seed.
"""

import os

for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

from hypothesis import settings  # noqa: E402

_EXPLORES = "SQUEEZEFILM_EXPLORE" in os.environ
_HOW = {
    "deadline": None,
    "derandomize": not _EXPLORES,
    "print_blob": _EXPLORES,
    "database": None,
}
settings.register_profile("properties", max_examples=120 if _EXPLORES else 25, **_HOW)
# For properties whose every example is a solve, a process or a session.
settings.register_profile("dear", max_examples=24 if _EXPLORES else 8, **_HOW)
settings.load_profile("properties")
