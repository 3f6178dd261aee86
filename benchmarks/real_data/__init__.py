"""Recordings that others made and published, turned into ours; docs/reference/real-data.md says where from.

    python -m benchmarks.real_data --data DIR [NAME ...]

The data themselves are not part of the project: DIR holds one directory a data set, with the files as their
authors publish them.
"""
