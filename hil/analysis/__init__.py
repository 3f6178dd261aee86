"""Science: what recordings say about the plant, and what to do about it."""
