"""The words of the project: channels, units, models, recordings, errors. Knows nothing above it."""
