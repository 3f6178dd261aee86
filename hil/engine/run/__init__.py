"""A run on an opened bench: pre-flight, arm, execute, monitor, record, safe state."""
