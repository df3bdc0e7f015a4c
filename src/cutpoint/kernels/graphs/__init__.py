"""Functions of scalars as graphs: ports, nodes, tracing, exact simplification, derivatives."""
