"""Messages between the command and the process that holds the hardware."""
