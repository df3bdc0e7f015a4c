"""Misspelled names of a format, which readers that ignore unknown names would not notice."""

from collections.abc import Collection
from difflib import get_close_matches

from cutpoint.errors import LONGEST_GUESS

ALIKE = 0.84
"""Similarity, at most 1, above which a name is a slip: `dampning` and `bdy` are, `frictionloss` and `geometry` not."""


def meant(name: str, known: Collection[str]) -> str | None:
    """The known name, in small letters, of which this is a misspelling; None if it is known, or similar to none."""
    if name in known or not known:
        return None
    own = name.casefold()[:LONGEST_GUESS]
    near = (right for right in known if sorted(right) == sorted(own) or _is_a_letter_off(own, right))
    return next(near, None) or next(iter(get_close_matches(own, known, 1, cutoff=ALIKE)), None)


def _is_a_letter_off(name: str, right: str) -> bool:
    """Whether one letter is replaced, as in `axes`."""
    return len(name) == len(right) and sum(x != y for x, y in zip(name, right, strict=True)) == 1
