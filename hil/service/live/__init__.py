"""What viewers see while a run goes on."""
