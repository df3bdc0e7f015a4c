"""Spatial algebra, rigid bodies, rotors and joints: what one body does."""
