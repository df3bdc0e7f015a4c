"""All control laws on one plant at equal stiffness, each departure from the model on its own."""
