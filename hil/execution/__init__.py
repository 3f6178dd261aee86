"""Carries runs and forecasts out in processes of their own, for a service or for an agent."""
