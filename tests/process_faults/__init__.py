"""Processes of a run, killed or frozen in each of its phases: docs/reference/process-faults.md."""
