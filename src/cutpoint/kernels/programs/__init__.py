"""Stepping programs: stages in loops that go through memory, as one function of machine code or interpreted."""
