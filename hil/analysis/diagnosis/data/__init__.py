"""Recordings made ready, what they say of themselves, and how far a simulation is from them."""
