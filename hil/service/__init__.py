"""The bench service: benches as shared instruments with a queue, an API and a page (docs/decisions/0018).

Public modules: `data` (what passes over the API), `serving` (a service until it is stopped), `api` (the
application). Nothing is imported here, so that a client needs none of what only a service does.
"""
