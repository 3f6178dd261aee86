"""Faults times phases of a run: what the bench, the data, the message and the exit code make of each."""
