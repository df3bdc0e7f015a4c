"""What a drive does between motor and link: springs, friction, kinematic error, the motor's limits."""
