"""What a graph becomes outside this process: C99, CUDA C, JAX, SymPy."""
