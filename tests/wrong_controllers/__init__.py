"""Wrong controllers through the shipped plans: which of them a plan notices, and by what."""
