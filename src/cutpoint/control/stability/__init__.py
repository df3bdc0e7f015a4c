"""Closed loops at rest: their poles and margins, as sampled by the control period."""
