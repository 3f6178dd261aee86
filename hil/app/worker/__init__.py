"""Processes of their own: the one that holds the hardware, a run for a service, a job for a service."""
