"""The derivation by which a check on computing time is withdrawn."""

TIME_IS_NO_VERDICT = (
    "A limit on computing time does not separate a right result from a wrong one: for one and the same result the time "
    "is work over speed, and the speed depends on the machine and on what else it does. The work is counted instead."
)
