"""Hardware-in-the-loop bench service for electric axles."""
