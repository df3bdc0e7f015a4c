"""A graph in primitives only, in an order that suits a processor: what all emitters have in common."""
