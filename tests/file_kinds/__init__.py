"""Small files of every kind, and what becomes of each: `python -m tests.file_kinds [--write]`."""
