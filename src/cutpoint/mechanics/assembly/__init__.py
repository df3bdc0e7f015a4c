"""From a robot as its file states it to the system that the recursions take, in its leanest form."""
