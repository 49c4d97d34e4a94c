"""The paper's claims and other published observations, recomputed with computed verdicts."""
