"""The dynamics as passes over bodies, one file a function."""
