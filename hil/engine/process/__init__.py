"""The process that holds the hardware, its supervisor, and what is left when one is lost."""
