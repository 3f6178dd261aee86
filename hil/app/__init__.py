"""What the product does: a module for each use case, without a terminal, a page or an API.

Each takes a typed request, reports its progress to a `Feedback`, and gives a typed outcome.
The command line, the service's jobs, the notebook and pytest ask here; what they print or send is theirs.
This package imports nothing by itself: signals have to be answered before the slow imports.
"""
