"""What lies in frames: layouts of DBC and EDS files, signals, checksums, XCP and A2L."""
