"""What a bench file says, and the bench that is opened from it: buses, devices, channels, limits, lock."""
