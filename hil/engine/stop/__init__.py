"""Requests to stop, emergency stops and their latch."""
