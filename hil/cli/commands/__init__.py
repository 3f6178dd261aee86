"""What each command takes, one module a command: light, so that --help and typing mistakes answer at once."""
