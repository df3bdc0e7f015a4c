"""What functions of scalars compute, as graphs: ports, nodes, tracing, exact simplification, derivatives."""
