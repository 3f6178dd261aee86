"""From a base model to the fewest effects that close its gap."""
