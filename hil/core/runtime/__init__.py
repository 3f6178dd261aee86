"""How code is compiled, timed, put on threads and into processes of its own."""
