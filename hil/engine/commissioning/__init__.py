"""Before the first run: doctor, jog, monitor, and the simulated bench as a process."""
