"""What analyses leave behind: files, summaries and figures, for commands and for plans."""
