"""Plates taken as free–free beams: exact modes and what a volt makes of them."""
