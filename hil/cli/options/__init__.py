"""The options of each command, one class a command, by topic; light, so that --help answers at once."""
