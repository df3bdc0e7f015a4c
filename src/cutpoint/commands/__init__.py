"""One thin command per job, by what they are about."""
