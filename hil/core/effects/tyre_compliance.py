"""The wheel is joined to the vehicle by a compliant tyre/road coupling: a third inertia."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="tyre_compliance",
    title="Tyre compliance",
    stage=Stage.TYRE,
    summary=(
        "The wheel is joined to the vehicle by a compliant tyre/road coupling: a third inertia. "
        "The wheel's inertia is taken out of the vehicle's."
    ),
    signature="An anti-resonance in wheel speed that two inertias cannot have.",
    shown_by="A chirp over 0.05 to 30 Hz with wheel speed recorded.",
    parameters=(
        Parameter("wheel_inertia", "kg m²", 1e-6, 1e4, "wheels and dyno rotors"),
        Parameter("tyre_stiffness", "N m/rad", 1e-3, 1e9, "tyre/road stiffness"),
        Parameter("tyre_damping", "N m s/rad", 0.0, 1e7, "tyre/road damping"),
    ),
    needs=("two_inertia",),
)
