"""An agent drives benches for a bench service that is elsewhere (docs/decisions/0024).

It carries runs out as the service does, and keeps working when the service is away.
"""

from hil.agent._agent import AgentRequest, work

__all__ = ["AgentRequest", "work"]
