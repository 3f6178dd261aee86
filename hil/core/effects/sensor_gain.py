"""A channel reads gain times the truth."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="sensor_gain",
    title="Sensor gain",
    stage=Stage.SENSOR,
    summary="A channel reads gain times the truth.",
    signature="One channel off by the same factor at all frequencies and speeds.",
    shown_by="Any test that moves the channel.",
    parameters=(Parameter("gain", "", -100.0, 100.0, "reading per truth"),),
    text_parameters=("channel",),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
)
