"""What each command does: it asks a use case of hil.app and prints the outcome."""
