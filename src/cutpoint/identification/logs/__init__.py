"""Logs of machines: read, named, brought into units, and looked at with suspicion."""
