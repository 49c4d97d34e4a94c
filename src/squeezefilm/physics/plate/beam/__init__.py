"""Plates taken as free–free beams: their modes and what a volt makes of them."""
