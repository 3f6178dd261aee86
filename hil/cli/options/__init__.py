"""The options of each command, one class a command; light, so that --help answers at once."""
