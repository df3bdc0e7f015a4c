"""Machine code by LLVM: its IR for one element and for batches, compilation, the cache on disk."""
