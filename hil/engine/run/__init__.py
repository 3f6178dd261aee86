"""A run on an opened bench: pre-flight, arm, carry out, monitor, record, safe state."""
