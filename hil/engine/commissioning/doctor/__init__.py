"""A look at a bench before anybody runs anything on it: who is there, what is wrong, what to do."""

from hil.engine.commissioning.doctor.examination import BusFacts, DeviceFacts, Examination
from hil.engine.commissioning.doctor.examine import DoctorRequest, examine_bench

__all__ = ["BusFacts", "DeviceFacts", "DoctorRequest", "Examination", "examine_bench"]
