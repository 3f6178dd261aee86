"""The loop closed: identify, diagnose, tune and confirm on a bench, in rounds."""
