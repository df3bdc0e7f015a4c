"""The log of a run: channels with units over time, in memory, in files and as pictures."""
