"""Agents on other machines: their benches, the runs that they upload."""
