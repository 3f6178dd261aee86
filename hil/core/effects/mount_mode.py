"""The e-Axle housing turns on its bushes under the reaction torque."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="mount_mode",
    title="Mount mode",
    stage=Stage.HOUSING,
    summary=(
        "The e-Axle housing turns on its bushes under the reaction torque; "
        "the motor speed is measured against the housing."
    ),
    signature="An extra resonance and anti-resonance in motor speed, much weaker at the wheel.",
    shown_by="A chirp at one amplitude over the whole band.",
    parameters=(
        Parameter("housing_inertia_kg_m2", "kg m²", 1e-6, 1e4, "inertia of the housing about the axle"),
        Parameter("mount_stiffness_nm_rad", "N m/rad", 1e-3, 1e9, "stiffness of the bushes"),
        Parameter("mount_damping_nms_rad", "N m s/rad", 0.0, 1e6, "damping of the bushes"),
    ),
    needs=("two_inertia", "three_inertia"),
)
