"""First-order lag between requested and acting torque."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="actuator_lag",
    title="Actuator lag",
    stage=Stage.TORQUE_PATH,
    summary="First-order lag between requested and acting torque.",
    signature="Like dead time in phase, and amplitudes fall at high frequency.",
    shown_by="A chirp up to 30 Hz with little noise: the amplitude above 15 Hz tells lag from dead time.",
    parameters=(Parameter("time_constant_s", "s", 0.0, 1.0, "time constant of the lag"),),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
)
