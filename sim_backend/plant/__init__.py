"""The plant: a model file turned into motion by a compiled kernel."""

from sim_backend.plant._replay import LONGEST_STEP_S, Start, replay, simulate, start_of

__all__ = ["LONGEST_STEP_S", "Start", "replay", "simulate", "start_of"]
