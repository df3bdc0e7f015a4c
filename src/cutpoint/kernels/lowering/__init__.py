"""A graph in primitives only, scheduled for a processor: what all emitters have in common."""
