"""Simulated participants: the chain's tables, their answers, how many people a study needs."""
