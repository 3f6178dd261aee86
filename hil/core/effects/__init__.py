"""The registry of physical effects: one file an effect, found by itself; also those of other packages.

To add one, write a file beside these (or in a package of your own with an entry point `hil.effects`):
docs/how-to/own-effect.md.
"""

from hil.core.effects._effect import SENSED, Effect, Least, Memory, Parameter, Stage, finite_number, shown
from hil.core.effects._law import Law, Motion
from hil.core.effects._probe import (
    STRETCH,
    Direction,
    Probe,
    Probes,
    Scene,
    fixed,
    reading,
    ripple,
    scaled,
    sized,
)
from hil.core.effects._registry import found

#: Every effect by id, in the order in which they act; a digest of other packages' effects, '' for none.
EFFECTS, STRANGERS = found()

__all__ = [
    "EFFECTS",
    "SENSED",
    "STRANGERS",
    "STRETCH",
    "Direction",
    "Effect",
    "Law",
    "Least",
    "Memory",
    "Motion",
    "Parameter",
    "Probe",
    "Probes",
    "Scene",
    "Stage",
    "finite_number",
    "fixed",
    "reading",
    "ripple",
    "scaled",
    "shown",
    "sized",
]
