"""The acting torque's slope is clipped."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="torque_rate_limit",
    title="Torque rate limit",
    stage=Stage.TORQUE_PATH,
    summary="The acting torque's slope is clipped.",
    signature="Steps arrive as ramps; large amplitudes at high frequency are small and late.",
    shown_by="Steps, and a chirp at two amplitudes.",
    parameters=(
        Parameter("limit_nm_s", "N m/s", 1e-6, 1e9, "largest magnitude of the acting torque's slope"),
    ),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
)
