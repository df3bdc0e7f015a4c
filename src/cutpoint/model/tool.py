"""The default frame of tools and payloads."""

from cutpoint.model.mechanism import Mechanism


def tool_frame_of(mechanism: Mechanism) -> str:
    """The last frame whose name has "tool" or "tcp" in it, or the last on the last body."""
    frames, last = mechanism.frames, len(mechanism.bodies) - 1
    named = [frame for frame in frames if "tool" in frame.lower() or "tcp" in frame.lower()]
    return [*(frame for frame, place in frames.items() if place.body == last), *named][-1]
