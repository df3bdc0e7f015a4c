"""Links, rotors and friction from torques and motion."""
