"""What passes between service, client and agent, one schema each: requests, outcomes, events."""
