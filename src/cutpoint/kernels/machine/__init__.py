"""Machine code by LLVM: its text for one element and for batches, its making, its cache on disk."""
