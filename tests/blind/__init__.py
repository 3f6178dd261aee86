"""Blind tests of the diagnosis: a reference plant of its own hides effects, and the answers are sealed.

`python -m tests.blind` runs the full set and writes docs/reference/blind-results.md; `--cases 40` runs a part
of it in the same proportions; `--only backlash --size edge --keep DIR` one effect, keeping what was measured.

The plant (`plant`, `reference`) and the diagnosis are written without knowledge of each other: nothing here
imports the simulated bench or the diagnosis, which is asked as a user would, on the command line.
"""
