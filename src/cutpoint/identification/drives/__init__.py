"""Drives from measurements: springs, kinematic errors, hysteresis, rotors, motor friction, torque constants."""
