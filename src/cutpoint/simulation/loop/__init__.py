"""The closed loop as stages over memory."""
