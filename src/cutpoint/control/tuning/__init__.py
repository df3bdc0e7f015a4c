"""Gains for a robot from what is asked of the closed loop."""
