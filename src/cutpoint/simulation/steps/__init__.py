"""How many integration steps a control period takes."""
