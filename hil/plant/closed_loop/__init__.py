"""Plant, sensors, drives and the RMCU's control as one compiled loop, sample by sample."""
