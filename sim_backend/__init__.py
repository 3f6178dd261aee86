"""Stands in for the hardware: plant, RMCU firmware and dynamometers behind the same wire."""
