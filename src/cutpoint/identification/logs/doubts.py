"""Kinds of notes on a log, for those that its readers should see first."""


class Doubt(str):
    """A note on what makes results doubtful."""


class Cause(Doubt):
    """A note on what cannot be right: further doubts may follow from it."""
