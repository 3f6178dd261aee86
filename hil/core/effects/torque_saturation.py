"""The acting torque is clipped."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="torque_saturation",
    title="Torque saturation",
    stage=Stage.TORQUE_PATH,
    summary="The acting torque is clipped.",
    signature="All outputs fall short while the request is large; small amplitudes fit.",
    shown_by="Chirp at two amplitudes, one beyond the suspected limit.",
    parameters=(Parameter("limit_nm", "N m", 1e-6, 1e6, "largest magnitude of the acting torque"),),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
)
