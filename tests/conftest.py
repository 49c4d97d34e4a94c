"""What every test needs before NumPy loads: one thread for linear algebra.

Small blocks are many times slower with threaded BLAS, most of all when tests run side by side.
"""

import os

for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")
