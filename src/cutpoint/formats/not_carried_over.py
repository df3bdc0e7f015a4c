"""What a robot file says and a robot has no place for, in one warning."""

from collections.abc import Sequence


class NotCarriedOver(UserWarning):
    """Parts of a file have no counterpart here; `things` lists them."""

    def __init__(self, things: Sequence[str], place: str) -> None:
        super().__init__(f"not carried over: {'; '.join(things)} ({place})")
        self.things = tuple(things)
