"""One warning about parts of a robot file that a robot cannot represent."""

from collections.abc import Sequence


class NotCarriedOver(UserWarning):
    """Parts of a file have no counterpart here; `things` lists them."""

    def __init__(self, things: Sequence[str], place: str) -> None:
        super().__init__(f"not carried over: {'; '.join(things)} ({place})")
        self.things = tuple(things)
