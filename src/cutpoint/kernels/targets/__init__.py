"""Export of graphs: C99, CUDA C, JAX, SymPy."""
