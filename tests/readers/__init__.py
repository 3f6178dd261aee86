"""Other people's readers and validators on what this software writes: `python -m tests.readers`."""
