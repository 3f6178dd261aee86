"""More dead time in the torque path than the model has."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="dead_time",
    title="Extra dead time",
    stage=Stage.TORQUE_PATH,
    summary="More dead time in the torque path than the model has.",
    signature="Phase lag that grows in proportion to frequency, on all outputs alike; amplitudes unchanged.",
    shown_by="A chirp or multisine up to 30 Hz.",
    parameters=(Parameter("extra_delay_s", "s", -0.05, 0.5, "added to the model's torque_delay"),),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
)
