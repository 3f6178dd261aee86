"""Bad input, interruptions and broken streams, tried on every command as a user would: as processes.

`python -m tests.bad_inputs --write` tries all of them and writes docs/reference/bad-inputs.md.
"""
