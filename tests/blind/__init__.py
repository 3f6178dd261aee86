"""Blind tests of the diagnosis: a reference plant of its own hides effects, and the answers are sealed."""
