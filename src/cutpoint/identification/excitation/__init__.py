"""Motions that tell most of a robot."""
