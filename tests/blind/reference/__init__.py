"""The reference plant: laws and integrators that share no code with the simulated bench."""
