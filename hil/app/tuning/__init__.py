"""Tuning: a search on the model, a run that confirms it, runs that refine it."""
