"""Bench files, and the DBC, EDS and model files that they name."""
