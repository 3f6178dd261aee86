"""A hypothesis and its free numbers, fitted to all recordings together."""
